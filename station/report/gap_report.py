# SPDX-License-Identifier: MIT
"""The report about a gap: the finding, its location, and the rejected rivals."""

from jointbench.acquisition.records.session import software_version
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, Finding, Gap
from jointbench.analysis.gap.model.evidence_records import GapEvidence
from jointbench.analysis.gap.model.scatter_found import hit_words
from jointbench.station.report.findings.interval_words import value_and_interval
from jointbench.station.report.gap_bars import view_grid
from jointbench.station.report.gap_figures import (
    record_estimate_figure,
    residual_spectrum,
    response_function,
)
from jointbench.station.report.gap_law_figures import law_plots
from jointbench.station.report.gap_numbers import percent, short, sure
from jointbench.station.report.gap_partial_section import partial_section
from jointbench.station.report.gap_policy_section import policy_section
from jointbench.station.report.gap_sentences import (
    SMALL_GAP,
    closest_words,
    effect_words,
    headline,
    limit_rows,
    next_step,
    place,
    second_method_words,
    why_lost,
)
from jointbench.station.report.gap_summary_figure import summary_figure
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    Plot,
    Report,
    Section,
    Text,
    Tile,
)
from jointbench.station.screen.value_text import with_sd

MOST_CANDIDATES = 12
MOST_SLICES = 3
SMALL_SHARE = 0.05
UNDRAWN = ("frequency", "order")
"""Views with too many slices for bars."""
SUMMARY_HEIGHT = 640
SAVE_HINT = "Save as SVG writes it for a talk."


def gap_report(found: Diagnosis, *, title: str, simulated: bool = False) -> Report:
    """Arrange a diagnosis as a report.

    Args:
        found: the diagnosis.
        title: of the campaign.
        simulated: whether a session was.
    """
    sections = [
        Section("picture", "Evidence", _picture(found)),
        Section("effects", "Conclusion", _effects(found)),
        partial_section(found.partial),
        Section("laws", "Force laws and amplitude", law_plots(found.evidence)),
        Section("where", "Location of the gap", _where(found)),
        Section("candidates", "Explanations tried", _candidates(found)),
        Section("limits", "Tests, noise and repeatability", _limits(found)),
        Section("base", "Final model", (_base(found), _deviations(found))),
        policy_section(found.policy),
    ]
    return Report(
        title=headline(found),
        lead=_lead(found, title),
        software=f"{software_version()}: gap",
        simulated=simulated,
        tiles=(*_tiles(found), *_effect_tiles(found)),
        sections=tuple(section for section in sections if section.items),
        findings=_findings(found),
    )


def _findings(found: Diagnosis) -> tuple[str, ...]:
    """Return verdict, its reason and the next step; the title has the effect."""
    words = [f"Verdict: {found.verdict.value}; {found.reason}."]
    if next_step(found):
        words.append(f"Next step: {next_step(found)}.")
    return tuple(words)


def _effect_tiles(found: Diagnosis) -> tuple[Tile, ...]:
    """Return the parameters of what is missing, with 95 % intervals."""
    return tuple(
        Tile(
            f"{one.name} of {effect.name.replace('_', ' ')}",
            *value_and_interval(one.value, one.sd, one.unit, prefix=False),
        )
        for effect in found.effects
        for one in effect.parameters
    )


def _lead(found: Diagnosis, title: str) -> str:
    text = f"Campaign {title}."
    if found.evidence is not None and found.evidence.where:
        where = found.evidence.where
        shown = found.verdict in (Finding.NAMED, Finding.AMBIGUOUS)
        text += f" Without the effect, {where}." if shown else f" Base model: {where}."
    return text


def _tiles(found: Diagnosis) -> tuple[Tile, ...]:
    tiles = [Tile("verdict", found.verdict.value, _sure(found))]
    before, after = found.gap_before, found.gap_after
    note = "held out; 0 is noise"
    tiles.append(Tile("gap before", short(before.value), note))
    if _after(found) is not None:
        tiles.append(Tile("gap after", short(after.value), note))
        if before.value > SMALL_GAP:
            tiles.append(Tile("reduced by", percent(found.shrink)))
    largest = max((abs(b) for b, _ in found.prior_deviations.values()), default=0.0)
    deviation = f"{short(largest)} sd"
    if _after(found) is not None:
        deviation = f"{short(largest)} → {short(after.prior_deviation)} sd"
    note = f"acceptable up to {short(found.acceptable_deviation)} sd"
    tiles.append(Tile("largest prior deviation", deviation, note))
    return tuple(tiles)


def _sure(found: Diagnosis) -> str:
    if not found.effects:
        return ""
    if found.verdict is Finding.AMBIGUOUS:
        return f"{len(found.explanations)} explanations fit equally well"
    return f"confidence {sure(max(e.confidence for e in found.effects))}"


def _tried(found: Diagnosis) -> str:
    """Return the legend of the model with the effects; empty for the base model."""
    if found.evidence is None or not found.evidence.tried:
        return ""
    words = effect_words(found.evidence.tried)
    refused = found.verdict in (Finding.UNKNOWN, Finding.MOSTLY)
    return f"best fit: {words} (rejected)" if refused else f"with {words}"


def _picture(found: Diagnosis) -> tuple[Item, ...]:
    evidence = found.evidence
    if evidence is None:
        return ()
    figure = summary_figure(
        evidence,
        found.gap_before,
        _after(found),
        title=headline(found),
        tried=_tried(found),
        prior_deviations=found.prior_deviations,
    )
    return (Plot("hero", _summary_caption(found, evidence), figure, SUMMARY_HEIGHT),)


def _after(found: Diagnosis) -> Gap | None:
    """Return the gap with the effects; None where no effect is shown."""
    shown = found.verdict in (Finding.NAMED, Finding.AMBIGUOUS)
    return found.gap_after if shown else None


def _summary_caption(found: Diagnosis, evidence: GapEvidence) -> str:
    curves = evidence.curves
    text = (
        f"Record {curves.record}, {curves.condition}: channel {curves.channel}, which "
        f"holds {100 * curves.share:.0f} % of the residual. "
    )
    if not evidence.where:
        text = f"Record {curves.record}, {curves.condition}: channel {curves.channel}. "
    if evidence.tried:
        text += "Below: residual before and after, and the final residual magnified. "
    return text + "The scatter of repeated hits is removed. " + SAVE_HINT


def _effects(found: Diagnosis) -> tuple[Item, ...]:
    rows = tuple(
        (
            f"{effect.name.replace('_', ' ')} {place(effect.site)}",
            one.name,
            with_sd(one.value, one.sd),
            _interval(one.value, one.sd),
            one.unit,
            sure(effect.confidence),
        )
        for effect in found.effects
        for one in effect.parameters
    )
    items: list[Item] = [Text(f"{found.verdict.value.capitalize()}: {found.reason}.")]
    if rows:
        columns = ("effect", "parameter", "value ± sd", "95 %", "unit", "confidence")
        items.append(DataTable("Missing from the model.", columns, rows))
    if found.verdict is Finding.UNKNOWN and found.evidence is not None:
        items.append(Text("Signature of the residual:"))
        items += [Text(f"– {line}.") for line in found.evidence.look]
    if next_step(found):
        items.append(Text(f"Next step: {next_step(found)}.", "notice"))
    return tuple(items)


def _interval(value: float, sd: float) -> str:
    return f"{value - 1.96 * sd:.4g} to {value + 1.96 * sd:.4g}"


def _where(found: Diagnosis) -> tuple[Item, ...]:
    items: list[Item] = []
    evidence, tried = found.evidence, _tried(found)
    if evidence is not None and evidence.where:
        items.append(Text(f"{evidence.where[:1].upper()}{evidence.where[1:]}."))
        if found.verdict is not Finding.UNKNOWN:
            items += [Text(f"– {line}.") for line in evidence.look]
    items.append(_where_table(found))
    if evidence is not None:
        items += _spectra(evidence, tried)
    names = [
        view.name
        for view in found.gap_before.views
        if view.name not in UNDRAWN and len(view.chi2_per_dof) > 1
    ]
    if names:
        caption = "Every view: chi2 per sample of each slice; 1 is noise."
        grid = view_grid(names, found.gap_before, _after(found))
        items.append(Plot("views", caption, grid, 60 + 270 * -(-len(names) // 2)))
    return tuple(items)


def _spectra(evidence: GapEvidence, tried: str) -> list[Item]:
    items: list[Item] = [
        Plot(
            "spectrum",
            "By frequency: rms residual of all records over the noise; 1 is noise.",
            residual_spectrum(evidence.spectra, tried=tried),
            340,
        ),
        Plot(
            "response",
            f"Frequency response, {evidence.spectra.condition}.",
            response_function(evidence.spectra, tried=tried),
            340,
        ),
    ]
    if evidence.record_estimates is not None:
        against = "preload" if evidence.view == "preload" else "level"
        items.append(
            Plot(
                "wishes",
                "Stiffness and damping of the joint estimated from each record "
                "separately, relative to the model; 0 for a correct model.",
                record_estimate_figure(
                    evidence.record_estimates,
                    against=against,
                    tried=tried,
                    unit=evidence.force_unit,
                ),
                320,
            )
        )
    return items


def _where_table(found: Diagnosis) -> DataTable:
    gap = _after(found)
    after = {view.name: view for view in gap.views} if gap is not None else {}
    rows = []
    for view in found.gap_before.views:
        ordered = sorted(view.share.items(), key=lambda item: -item[1])[:MOST_SLICES]
        for label, share in ordered:
            if share >= SMALL_SHARE:
                left = [after[view.name].chi2_per_dof[label]] if after else []
                values = [view.chi2_per_dof[label], *left]
                cells = (short(value) for value in values)
                rows.append((view.name, label, f"{100 * share:.0f} %", *cells))
    columns = ("view", "slice", "share", "chi2/dof before", "chi2/dof after")
    shown = columns if after else columns[:-1]
    return DataTable("The largest slices of each view.", shown, tuple(rows))


def _candidates(found: Diagnosis) -> tuple[Item, ...]:
    rows = tuple(
        (
            "base model" if one.effects == ("none",) else " + ".join(one.effects),
            short(one.delta_score),
            f"{one.chi2_per_dof:.5g}",
            short(one.prior_deviation),
            why_lost(one, found),
        )
        for one in found.candidates[:MOST_CANDIDATES]
    )
    policy = found.policy
    columns = (
        "explanation",
        "delta score",
        "chi2/dof",
        "prior deviation [sd]",
        "reason",
    )
    caption = (
        "Best first. The score is chi2 plus the penalty of the priors plus "
        f"{policy.parameter_charge:g} for each parameter; a rival is excluded at a "
        f"delta score of {policy.rival_score:g} "
        f"({policy.rival_score_one_site:g} where one site has two effects)."
    )
    items: list[Item] = [DataTable(caption, columns, rows)]
    if found.evidence is not None and found.verdict is not Finding.NONE:
        items.append(_tests(found.evidence))
    return tuple(items)


def _tests(evidence: GapEvidence) -> DataTable:
    rows = tuple(
        (test.label, short(test.drop), f"{100 * test.share:.0f} %")
        for test in evidence.tests
    )
    columns = ("single effect", "predicted drop of chi2", "share of the residual")
    return DataTable("Directed tests before any fit, to first order.", columns, rows)


def _limits(found: Diagnosis) -> tuple[Item, ...]:
    largest, limit = found.null_statistic
    noise = found.noise
    force_unit = found.evidence.force_unit if found.evidence is not None else "N"
    rows = [
        (
            "null test of the base",
            short(largest),
            short(limit),
            "largest drop of chi2 that one effect predicts; noise exceeds the limit "
            "once in 200 campaigns; the search starts at 1.3 times the limit",
        )
    ]
    if found.evidence is not None:
        limits = found.evidence.limits
        rows.append(
            (
                "final chi2/dof",
                f"{limits.chi2_per_dof:.5g}",
                f"{limits.chi2_allowed:.5g}",
                "noise plus a small allowance for the error of the model",
            )
        )
        if limits.remaining is not None:
            rows.append(
                (
                    "remaining directed test",
                    f"{limits.remaining:.4g}",
                    f"{limits.remaining_allowed:.4g}",
                    "predicted drop of chi2 by one more effect, the one nearest its "
                    "limit",
                )
            )
    table = DataTable(
        "Tests and their limits.", ("test", "value", "limit", "detail"), tuple(rows)
    )
    of_force = noise["force_sigma_N"]
    force_words = f", {of_force:.3g} {force_unit} of the force" if of_force else ""
    floor = (
        f"Noise floor: {noise['sigma_min']:.3g} to {noise['sigma_max']:.3g} in the "
        f"unit of the response{force_words}. {_repeatability(found)}"
    )
    items: list[Item] = [Text(floor), table]
    if words := second_method_words(found):
        items.append(Text(f"{words[:1].upper()}{words[1:]}."))
    if words := closest_words(found):
        items.append(Text(f"Before the acceptance criteria, {words}."))
    if rows_left := limit_rows(found):
        caption = "Largest effects that these records do not exclude (95 %)."
        heads = ("effect", "at most", "at the shape")
        items.append(DataTable(caption, heads, rows_left))
    return tuple(items)


def _repeatability(found: Diagnosis) -> str:
    """Return how far hits scatter, by direction, and the hits that deviate."""
    if found.scatter is None:
        return ""
    words = f"Repeatability: {found.scatter.words}; a smaller effect is not detected."
    if found.scatter.hits:
        listed = ", ".join(hit_words(hit) for hit in found.scatter.hits)
        words += f" Hits that deviate from the others: {listed}."
    return words


def _base(found: Diagnosis) -> DataTable:
    rows = tuple((e.name, with_sd(e.value, e.sd), e.unit) for e in found.base)
    return DataTable("Base parameters.", ("parameter", "value", "unit"), rows)


def _deviations(found: Diagnosis) -> DataTable:
    rows = tuple(
        (name, f"{before:+.2f}", f"{after:+.2f}")
        for name, (before, after) in found.prior_deviations.items()
    )
    return DataTable(
        "Prior deviation: distance of each parameter from its nominal value [sd].",
        ("parameter", "before", "after"),
        rows,
    )
