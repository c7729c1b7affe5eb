# SPDX-License-Identifier: MIT
"""The verdict words of a surface fit as summaries of the names that were found."""

from collections.abc import Sequence

from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.signal.fractal.verdict_records import SurfaceVerdict

OF_INSTRUMENT = frozenset(
    {"tip", "blur", "noise", "quantisation", "outliers", "missing_points"}
)
"""Effects of the instrument or of its file; all others are the surface's own."""
_NO_LAW = frozenset({"plateau", "second_process"})


def summary_word(finding: Finding, names: Sequence[str]) -> SurfaceVerdict:
    """Return the verdict word that sums up the names of a diagnosis.

    Args:
        finding: verdict of the engine.
        names: effects of the best explanation.
    """
    if finding is Finding.UNKNOWN or _NO_LAW & set(names):
        return SurfaceVerdict.NONE
    if finding is Finding.NONE:
        return SurfaceVerdict.FRACTAL
    if set(names) <= OF_INSTRUMENT:
        return SurfaceVerdict.INSTRUMENT
    return SurfaceVerdict.BAND
