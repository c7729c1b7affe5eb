# SPDX-License-Identifier: MIT
"""What ``jointbench gap`` shows on a terminal, in 80 columns or more."""

import textwrap

from rich.console import Console

from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, Finding
from jointbench.station.report.gap_numbers import percent, short, sure
from jointbench.station.report.gap_partial_section import partial_lines
from jointbench.station.report.gap_sentences import (
    PRIORS,
    SMALL_GAP,
    closest_words,
    headline,
    limit_rows,
    next_step,
    place,
    second_method_words,
    why_lost,
)
from jointbench.station.screen.terminal import console, table
from jointbench.station.screen.value_text import with_sd

_MOST_CANDIDATES = 6
_MOST_SLICES = 3
_SMALL_SHARE = 0.005
_WIDEST = 110
_LABEL = 9
"""Width of the labels at the beginning of lines."""
_OPEN = "Largest effects that these records do not exclude (95 %)"
_OPEN_HEADS = ("effect", "at most", "at the shape")
_VIEW_HEADS = ("view", "largest shares")
_TRIED_HEADS = ("explanation", "delta score", "chi2/dof", "prior dev. [sd]", "reason")


def show_diagnosis(found: Diagnosis, json_target: str | None) -> None:
    """Print verdict, effects, location of the gap, rivals and the next step.

    Args:
        found: the diagnosis.
        json_target: where the JSON goes; ``-`` moves the words to standard error.
    """
    show_on(console(json_target), found)


def show_on(screen: Console, found: Diagnosis) -> None:
    """Print the same on a screen."""
    screen.print(f"verdict: {found.verdict.value}", style="bold")
    _say(screen, "", f"{headline(found)}.")
    _say(screen, "", found.reason)
    if found.effects:
        columns = ("effect", "value ± sd", "unit", "confidence")
        screen.print(
            table("Missing from the model", columns, _effects(found), words={0, 2})
        )
    screen.print()
    _say(screen, "gap", _gap_words(found))
    if found.evidence is not None and found.evidence.where:
        _say(screen, "where", found.evidence.where)
        if found.verdict is Finding.UNKNOWN:
            _say(screen, "looks", *found.evidence.look)
    for label, words in partial_lines(found.partial):
        _say(screen, label, words)
    _say(screen, "limits", _limit_words(found))
    _say(screen, "checked", *filter(None, (second_method_words(found),)))
    if found.curves is not None:
        _say(screen, "curves", *found.curves.words)
    _say(screen, "closest", *filter(None, (closest_words(found),)))
    where = _where(found)
    if where:
        screen.print(table("Location of the gap", _VIEW_HEADS, where, words={0, 1}))
    if found.limits:
        screen.print(table(_OPEN, _OPEN_HEADS, limit_rows(found), words={0, 2}))
    if len(found.candidates) > 1:
        tried = _candidates(found)
        screen.print(table("Explanations tried", _TRIED_HEADS, tried, words={0, 4}))
    if next_step(found):
        screen.print()
        _say(screen, "next", next_step(found))


def _say(screen: Console, label: str, *texts: str) -> None:
    """Print texts as paragraphs with a hanging label."""
    width = min(screen.width, _WIDEST)
    for number, text in enumerate(texts):
        lead = f"{label}:" if label and number == 0 else ""
        start = f"{lead:<{_LABEL}}" if label else "  "
        hang = " " * (_LABEL if label else 2)
        if label and len(texts) > 1:
            start, hang = f"{start}- ", f"{hang}  "
        for line in textwrap.wrap(
            text, width, initial_indent=start, subsequent_indent=hang
        ):
            screen.print(line, markup=False, soft_wrap=True)


def _effects(found: Diagnosis) -> list[tuple[str, str, str, str]]:
    rows = []
    for effect in found.effects:
        name = f"{effect.name.replace('_', ' ')} {place(effect.site)}"
        rows.append((name, "", "", sure(effect.confidence)))
        rows += [
            (f"  {one.name}", with_sd(one.value, one.sd), one.unit, "")
            for one in effect.parameters
        ]
    return rows


def _gap_words(found: Diagnosis) -> str:
    before, after = found.gap_before, found.gap_after
    deviation = max((abs(b) for b, _ in found.prior_deviations.values()), default=0.0)
    if found.verdict not in (Finding.NAMED, Finding.AMBIGUOUS):
        return (
            f"{short(before.value)} on held-out records; largest prior deviation "
            f"{short(deviation)} sd"
        )
    shrink = ""
    if before.value > SMALL_GAP:
        shrink = f" (reduced by {percent(found.shrink)})"
    return (
        f"{short(before.value)} before, {short(after.value)} after, on held-out "
        f"records{shrink}; largest prior deviation {short(deviation)} sd before, "
        f"{short(after.prior_deviation)} sd after"
    )


def _limit_words(found: Diagnosis) -> str:
    largest, limit = found.null_statistic
    words = f"null test {short(largest)} (limit {short(limit)})"
    if limit == 0.0:
        words = "no directed tests were needed"
    if found.evidence is not None:
        limits = found.evidence.limits
        words += (
            f"; final chi2/dof {limits.chi2_per_dof:.4g} (limit "
            f"{limits.chi2_allowed:.4g})"
        )
        if limits.remaining is not None:
            words += (
                f", largest remaining directed test {short(limits.remaining)} (limit "
                f"{short(limits.remaining_allowed)})"
            )
    return words if found.scatter is None else f"{words}; {found.scatter.words}"


def _where(found: Diagnosis) -> list[tuple[str, str]]:
    rows: list[tuple[str, str]] = []
    priors = found.evidence is not None and found.evidence.view == PRIORS
    if found.verdict is Finding.NONE or priors:
        return rows
    for view in found.gap_before.views:
        if view.name == "order" or len(view.share) < 2:
            continue
        ordered = sorted(view.share.items(), key=lambda item: -item[1])[:_MOST_SLICES]
        words = [
            f"{label} {100 * share:.0f} %"
            for label, share in ordered
            if share > _SMALL_SHARE
        ]
        if words:
            rows.append((view.name, ", ".join(words)))
    return rows


def _candidates(found: Diagnosis) -> list[tuple[str, str, str, str, str]]:
    return [
        (
            _short(" + ".join(one.effects)),
            short(one.delta_score),
            f"{one.chi2_per_dof:.4g}",
            short(one.prior_deviation),
            why_lost(one, found),
        )
        for one in found.candidates[:_MOST_CANDIDATES]
    ]


def _short(name: str) -> str:
    return "base model" if name == "none" else name.replace("link:joint", "joint")
