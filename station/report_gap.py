# SPDX-License-Identifier: MIT
"""The page about a gap: before and after in every view, and what was named."""

from jointbench.acquisition.session import software_version
from jointbench.analysis.gap.records import Diagnosis, Gap
from jointbench.station.figures import PALETTE, Figure, axis, figure
from jointbench.station.output import with_sd
from jointbench.station.report_page import (
    DataTable,
    Plot,
    Report,
    Section,
    Text,
    Tile,
)

MOST_CANDIDATES = 12


def gap_report(found: Diagnosis, *, title: str) -> Report:
    """Arrange a diagnosis as a page."""
    return Report(
        title=f"Gap of {title}: {found.verdict.value}",
        lead=found.reason,
        software=software_version(),
        simulated=False,
        tiles=_tiles(found),
        sections=(
            Section("effects", "What is missing", _effects(found)),
            Section("where", "Where the gap sits", _views(found)),
            Section("candidates", "Explanations tried", (_candidates(found),)),
            Section("base", "The model at the end", (_base(found), _pulls(found))),
        ),
    )


def _tiles(found: Diagnosis) -> tuple[Tile, ...]:
    named = ", ".join(f"{e.name} at {e.site}" for e in found.effects) or "-"
    return (
        Tile("verdict", found.verdict.value),
        Tile("effect", named),
        Tile("gap before", f"{found.gap_before.value:.3g}", "held-out records"),
        Tile("gap after", f"{found.gap_after.value:.3g}", "held-out records"),
        Tile("shrinks by", f"{100 * found.shrink:.1f} %"),
    )


def _effects(found: Diagnosis) -> tuple[Text | DataTable, ...]:
    rows = tuple(
        (
            f"{effect.name} at {effect.site}",
            one.name,
            with_sd(one.value, one.sd),
            one.unit,
            f"{100 * effect.confidence:.0f} %",
        )
        for effect in found.effects
        for one in effect.parameters
    )
    items: list[Text | DataTable] = [Text(found.reason)]
    if rows:
        columns = ("effect", "parameter", "value", "unit", "confidence")
        items.append(
            DataTable("Parameters with one standard deviation.", columns, rows)
        )
    if found.experiment:
        items.append(Text(f"Next: {found.experiment}", "notice"))
    return tuple(items)


def _views(found: Diagnosis) -> tuple[Plot, ...]:
    return tuple(
        Plot(
            f"view-{number}",
            f"By {view.name}: chi2 per sample of the held-out misfit; 1 is noise.",
            _bars(view.name, found.gap_before, found.gap_after),
            280,
        )
        for number, view in enumerate(found.gap_before.views)
    )


def _bars(name: str, before: Gap, after: Gap) -> Figure:
    traces = []
    for gap, words, color in (
        (before, "before", PALETTE[1]),
        (after, "after", PALETTE[2]),
    ):
        views = {view.name: view for view in gap.views}
        if name in views:
            slices = views[name].chi2_per_dof
            traces.append(
                {
                    "type": "bar",
                    "x": list(slices),
                    "y": [float(f"{value:.5g}") for value in slices.values()],
                    "name": words,
                    "marker": {"color": color},
                }
            )
    return figure(traces, axis(name, type="category"), axis("chi2/dof [-]", log=True))


def _candidates(found: Diagnosis) -> DataTable:
    rows = tuple(
        (
            " + ".join(one.effects) or "(base alone)",
            f"{one.behind:.4g}",
            f"{one.chi2_per_dof:.5g}",
            f"{one.pull:.2g}",
        )
        for one in found.candidates[:MOST_CANDIDATES]
    )
    columns = ("explanation", "behind the best", "chi2/dof [-]", "largest pull [sd]")
    return DataTable("Best first; the score is chi2 plus a charge.", columns, rows)


def _base(found: Diagnosis) -> DataTable:
    rows = tuple((e.name, with_sd(e.value, e.sd), e.unit) for e in found.base)
    return DataTable("Base parameters.", ("parameter", "value", "unit"), rows)


def _pulls(found: Diagnosis) -> DataTable:
    rows = tuple(
        (name, f"{before:+.2f}", f"{after:+.2f}")
        for name, (before, after) in found.pulls.items()
    )
    return DataTable(
        "Distance of each parameter from its sheet, in standard deviations.",
        ("parameter", "before", "after"),
        rows,
    )
