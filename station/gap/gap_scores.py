# SPDX-License-Identifier: MIT
"""Prediction error on parts of a record outside the fit, on screen and in reports."""

from collections.abc import Sequence

from jointbench.analysis.gap.model.stretch_score import StretchScore
from jointbench.station.screen.page_parts import DataTable, Section
from jointbench.station.screen.value_text import engineering

UNPREFIXED = frozenset({"V", "m", "m/s", "m/s^2", "N"})
"""Units that take an SI prefix; all others are written unchanged."""


def score_table(scores: Sequence[StretchScore], unit: str) -> DataTable:
    """Return rms of output and error, before and after, in the output's unit."""
    rows = tuple(
        (
            score.name,
            _amount(score.rms, unit),
            f"{_amount(score.before, unit)} ({_share(score.before, score.rms)})",
            f"{_amount(score.after, unit)} ({_share(score.after, score.rms)})",
            f"{100 * score.shrink:.1f} %",
        )
        for score in scores
    )
    return DataTable(
        "Prediction error on parts of the record outside the fit (rms, % of output)",
        ("part", "output", "before", "after", "reduced by"),
        rows,
    )


def score_section(scores: Sequence[StretchScore], unit: str) -> Section:
    """Return the scores as a section of a report."""
    return Section("scores", "Prediction outside the fit", (score_table(scores, unit),))


def scores_json(scores: Sequence[StretchScore], unit: str) -> list[dict[str, object]]:
    """Return the scores as JSON objects."""
    return [
        {
            "name": score.name,
            "unit": unit,
            "rms_output": score.rms,
            "rms_before": score.before,
            "rms_after": score.after,
            "shrink": score.shrink,
        }
        for score in scores
    ]


def _amount(value: float, unit: str) -> str:
    return engineering(value, unit) if unit in UNPREFIXED else f"{value:.4g} {unit}"


def _share(value: float, whole: float) -> str:
    return f"{100 * value / whole:.3g} %" if whole > 0 else "-"
