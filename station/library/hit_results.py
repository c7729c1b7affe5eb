# SPDX-License-Identifier: MIT
"""Hits of a measurement with their verdicts."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.recordings import Hit, Recording, Verdict
from jointbench.station.library.labelled_arrays import Variable, dataset
from jointbench.station.library.measurements import (
    Files,
    Measurement,
    open_measurement,
)
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.pipeline.chain import (
    ChainSettings,
    judge_hits,
)

if TYPE_CHECKING:
    from xarray import Dataset

Source = Measurement | Files


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class JudgedHits(Shown):
    """Hits of a measurement with their verdicts.

    Attributes:
        recordings: those with a hit, each with its judged hits.
    """

    recordings: tuple[Recording, ...]

    @property
    def hits(self) -> tuple[Hit, ...]:
        """All hits in the order recorded."""
        return tuple(hit for one in self.recordings for hit in one.hits)

    @property
    def accepted(self) -> tuple[Hit, ...]:
        """Hits that enter the averages."""
        return tuple(hit for hit in self.hits if hit.verdict is Verdict.OK)

    def to_xarray(self) -> "Dataset":
        """Return time, point, peak force and verdict of each hit.

        Where they were measured, preload with its sd and temperature too.
        """
        pairs = [(one, hit) for one in self.recordings for hit in one.hits]
        time = [r.start_time + h.trigger / r.sample_rate for r, h in pairs]
        words: dict[str, Variable] = {
            "time": (("hit",), time, "s", "time of the trigger"),
            "peak_force": (
                ("hit",),
                [h.peak_force for _, h in pairs],
                "N",
                "peak force",
            ),
            "point": (("hit",), [h.point for _, h in pairs], "", "hit point"),
            "verdict": (("hit",), [h.verdict.value for _, h in pairs], "", "verdict"),
            "recording": (("hit",), [r.name for r, _ in pairs], "", "recording"),
        }
        words |= _measured_beside(pairs)
        number = np.arange(1, len(pairs) + 1)
        return dataset(words, {"hit": (("hit",), number, "1", "number")}, {})

    @property
    def view(self) -> ResultView:
        """One row a hit; a rejected one has its reason."""
        rows = [
            (
                str(number),
                one.name,
                hit.point,
                f"{hit.peak_force:.4g} N",
                hit.verdict.value,
                hit.reason,
            )
            for number, (one, hit) in enumerate(
                ((one, hit) for one in self.recordings for hit in one.hits), 1
            )
        ]
        columns = ("hit", "recording", "point", "peak force", "verdict", "reason")
        title = f"{len(self.accepted)} of {len(self.hits)} hits accepted"
        return ResultView(title, columns, tuple(rows))


def hits(source: Source, *, columns: str | None = None, point: str = "1") -> JudgedHits:
    """Find and judge the hits of a measurement.

    Args:
        source: a measurement, or files as for `jointbench.open`.
        columns: of plain tables, with units.
        point: where the hammer struck, for files that do not say.

    Returns:
        Every hit with its verdict and reason.

    Raises:
        BadData: no hit is found, or a file cannot be read.
    """
    measured = _opened(source, columns, point)
    return JudgedHits(judge_hits(measured.recordings, ChainSettings()))


def _measured_beside(pairs: Sequence[tuple[Recording, Hit]]) -> dict[str, Variable]:
    """Return preload, its sd and temperature of each hit, those that are known."""
    columns = (
        ("preload", [r.preload for r, _ in pairs], "N", "preload of the joint"),
        ("preload_sd", [r.preload_sd for r, _ in pairs], "N", "sd of the preload"),
        ("temperature", [h.temperature for _, h in pairs], "degC", "mean over the hit"),
    )
    measured = any(r.preload_sd is not None for r, _ in pairs)
    return {
        name: (("hit",), [np.nan if v is None else v for v in values], unit, words)
        for name, values, unit, words in columns
        if any(v is not None for v in values) and (name != "preload" or measured)
    }


def require_one_preload(recordings: Sequence[Recording]) -> None:
    """Raise `UsageError` for several preloads: their hits are never averaged."""
    known = list(dict.fromkeys(one.preload for one in recordings))
    if len(known) > 1:
        words = ", ".join("none" if p is None else f"{p:g} N" for p in known)
        raise UsageError(
            f"the recordings have preloads {words}; each has modes of its own: "
            "select one with measurement.at('... N')"
        )


def _opened(source: Source, columns: str | None, point: str) -> Measurement:
    if isinstance(source, Measurement):
        return source
    return open_measurement(source, columns=columns, point=point)
