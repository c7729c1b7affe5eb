# SPDX-License-Identifier: MIT
"""Lines of heights without gaps, as a spectrum needs them."""

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.records.surfaces import Surface

WHOLE_TAPER, RUN_TAPER = 0.1, 0.5
"""Share that is tapered at each end: of a complete line, and of a run between gaps,
whose low ordinates count [-]."""
FEWEST_POINTS = 64
"""Least points of a run for a spectrum."""
FILLED_GAP, FILLED_SHARE = 3, 0.02
"""Points of a gap, and share of a line, up to which heights are interpolated: the error
is then below a hundredth of S at one sample."""


def complete_lines(heights: FloatArray, valid: BoolArray) -> tuple[FloatArray, float]:
    """Return lines of one length without gaps, and the share to taper.

    Args:
        heights: [m], shape (n_lines, n_points).
        valid: False where a point is missing, same shape.

    Returns:
        Lines [m], shape (n, points): all, with small gaps interpolated, or pieces of
        the runs between gaps; none where every run is shorter than 64 points.
    """
    small = [filled_line(z, v) for z, v in zip(heights, valid, strict=True)]
    whole = [line for line in small if line is not None]
    if 2 * len(whole) >= len(small):
        return np.array(whole), WHOLE_TAPER
    runs = [
        z[start:stop]
        for z, v in zip(heights, valid, strict=True)
        for start, stop in _runs(v)
        if stop - start >= FEWEST_POINTS
    ]
    if not runs:
        return np.empty((0, 0)), RUN_TAPER
    # A long piece has the low ordinates, many pieces have the points.
    lengths = sorted({run.size for run in runs})
    used = [n * sum(run.size // n for run in runs) for n in lengths]
    length = max(
        n for n, points in zip(lengths, used, strict=True) if 2 * points >= max(used)
    )
    pieces = [
        run[k * length : (k + 1) * length]
        for run in runs
        for k in range(run.size // length)
    ]
    return np.array(pieces), RUN_TAPER


def missing_words(surface: Surface) -> str:
    """Return how many heights are missing, and what a spectrum does; empty for none.

    Args:
        surface: a profile or a map.
    """
    lost = int(np.count_nonzero(~surface.valid))
    if not lost:
        return ""
    heights, valid = np.atleast_2d(surface.heights), np.atleast_2d(surface.valid)
    count = len(valid)
    lines = zip(heights, valid, strict=True)
    cut = sum(filled_line(z, v) is None for z, v in lines)
    if not cut:
        how = "the gaps are short and interpolated"
    elif 2 * cut <= count:
        how = f"{cut} of {count} lines have long gaps and are left out of the spectrum"
    else:
        how = "the parts between long gaps are used"
    return f"{lost} of {surface.valid.size} heights are missing; {how}"


def filled_line(heights: FloatArray, valid: BoolArray) -> FloatArray | None:
    """Return a line with its small gaps interpolated, None where they are large."""
    if valid.all():
        return heights
    gaps = _runs(~valid)
    widest = max(stop - start for start, stop in gaps)
    if widest > FILLED_GAP or np.count_nonzero(~valid) > FILLED_SHARE * valid.size:
        return None
    place = np.arange(heights.size)
    return np.interp(place, place[valid], heights[valid])


def _runs(marked: BoolArray) -> list[tuple[int, int]]:
    """Return starts and ends of the runs of marked points."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], marked.astype(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
