# SPDX-License-Identifier: MIT
"""The report's section on hits: rejected ones with reasons, accepted ones folded."""

from collections.abc import Sequence

from jointbench.acquisition.records.recordings import Hit, Recording, Verdict
from jointbench.station.report.figures.hit_figures import (
    pulse_figures,
    response_figures,
)
from jointbench.station.report.figures.small_multiples import small_multiples
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    ItemGroup,
    Section,
    Text,
)

REJECTED = frozenset(v.value for v in Verdict if v is not Verdict.OK)
_COLUMNS = ("hit", "time [s]", "point", "peak [N]", "verdict")


def hits_section(recordings: Sequence[Recording]) -> Section:
    """Return the section: rejected hits, pulses, one response, accepted hits."""
    verdicts = [hit.verdict for one in recordings for hit in one.hits]
    good = sum(verdict is Verdict.OK for verdict in verdicts)
    bad = len(verdicts) - good
    words = (
        f"{good} of {len(verdicts)} hits were accepted. Rejected hits are never "
        "averaged; they stay in the session and can be assessed again."
    )
    items: list[Item] = [Text(words)]
    if bad:
        caption = f"{bad} rejected hits, each with its reason."
        items.append(_table(caption, recordings, accepted=False))
    title = (
        "Force of the hits, aligned at the trigger: accepted ones over each other, "
        "each rejected one alone."
    )
    items += small_multiples(title, pulse_figures(recordings), "rejected hits")
    if verdicts:
        said, plots = response_figures(recordings)
        items += small_multiples(said, plots, "channels")
    if good:
        table = _table("Accepted hits.", recordings, accepted=True)
        items.append(ItemGroup(f"{good} accepted hits", (table,)))
    return Section("hits", "Hits", tuple(items))


def _table(
    caption: str, recordings: Sequence[Recording], *, accepted: bool
) -> DataTable:
    """Return accepted hits, or rejected ones with reasons; temperatures if measured."""
    warm = any(hit.temperature is not None for r in recordings for hit in r.hits)
    heads = (
        *_COLUMNS,
        *(("temperature [°C]",) if warm else ()),
        *(() if accepted else ("reason",)),
    )
    rows = tuple(
        (
            f"{recording.name} / {number}",
            f"{recording.start_time + hit.trigger / recording.sample_rate:.3f}",
            hit.point,
            f"{hit.peak_force:.4g}",
            hit.verdict.value,
            *((_degrees(hit),) if warm else ()),
            *(() if accepted else (hit.reason,)),
        )
        for recording in recordings
        for number, hit in enumerate(recording.hits, 1)
        if (hit.verdict is Verdict.OK) is accepted
    )
    return DataTable(caption, heads, rows, frozenset() if accepted else REJECTED)


def _degrees(hit: Hit) -> str:
    return "-" if hit.temperature is None else f"{hit.temperature:.1f}"
