# SPDX-License-Identifier: MIT
"""A vendor file through SurfaceTopography and through surfalize, compared.

Both are optional. Their readers were written independently, often from files alone: a
factor in which they differ is an error of one of them.
"""

import importlib.util
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.units import to_si
from jointbench.acquisition.file_access.quoting import shown
from jointbench.acquisition.formats.heights.vendor_binaries import (
    MOST_BYTES,
    open_vendor,
)

SAME = 1e-4
"""Relative difference below which pitches and heights are equal [-]."""
_ALIKE = 0.999
"""Correlation above which two maps are the same in one orientation [-]."""
_MICROMETRE = 1e-6
_MOST_SHIFT = 64
"""Points by which a reader may begin too early or too late in a file."""
_TURNS: dict[str, Callable[[FloatArray], FloatArray]] = {
    "upright": lambda z: z,
    "upside down": lambda z: z[::-1],
    "mirrored": lambda z: z[:, ::-1],
    "turned by half a turn": lambda z: z[::-1, ::-1],
    "with rows and columns exchanged": lambda z: z.T,
}


@dataclass(frozen=True, slots=True)
class ReaderComparison:
    """What two readers make of one file.

    Attributes:
        file: its name.
        compared: whether both read it.
        reason: why it is not compared, ``""`` otherwise.
        pitch: of SurfaceTopography over that of surfalize, rows and columns [-].
        height: factor of the heights, likewise [-]; None where they are not alike.
        missing: missing points of each.
        disagreements: one sentence each.
    """

    file: str
    compared: bool
    reason: str = ""
    pitch: tuple[float, float] = (1.0, 1.0)
    height: float | None = 1.0
    missing: tuple[int, int] = (0, 0)
    disagreements: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class _Read:
    """A map as one reader gives it: NaN where missing, SI units."""

    heights: FloatArray
    pitch: tuple[float, float]
    unit_stated: bool = True


def compare_readers(path: Path) -> ReaderComparison:
    """Compare pitch, heights and missing points of a vendor file.

    Constant offsets of the heights do not count.

    Args:
        path: a file that SurfaceTopography and surfalize may read.

    Returns:
        The comparison; where one of them does not read the file, the reason.
    """
    if path.stat().st_size > MOST_BYTES:
        return ReaderComparison(path.name, False, "the file is larger than any map")
    for package in ("SurfaceTopography", "surfalize"):
        if importlib.util.find_spec(package) is None:
            why = f"{package} is not installed: pip install 'jointbench[readers]'"
            return ReaderComparison(path.name, False, why)
    found = []
    for name, read in (("SurfaceTopography", _first), ("surfalize", _second)):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found.append(read(path))
        except Exception as error:  # noqa: BLE001  foreign readers raise anything
            why = shown(str(error).strip() or type(error).__name__)
            return ReaderComparison(path.name, False, f"not read by {name}: {why}")
    return _compared(path.name, *found)


def _first(path: Path) -> _Read:
    """Read with SurfaceTopography, whose first index is x."""
    topography, _ = open_vendor(path)
    unit = topography.unit
    scale = 1.0 if unit is None else to_si(str(unit).replace("Å", "angstrom"), "length")
    heights = np.ma.filled(np.ma.asarray(topography.heights(), float), np.nan) * scale
    if heights.ndim != 2:
        raise ValueError("it is a profile, surfalize reads maps only")
    sizes = [float(one) * scale for one in topography.physical_sizes]
    columns, rows = heights.shape
    return _Read(heights.T, (sizes[1] / rows, sizes[0] / columns), unit is not None)


def _second(path: Path) -> _Read:
    """Read with surfalize, which counts in micrometres."""
    import surfalize

    surface: Any = surfalize.Surface.load(str(path))
    heights = np.asarray(surface.data, dtype=np.float64) * _MICROMETRE
    steps = (float(surface.step_y), float(surface.step_x))
    return _Read(heights, (steps[0] * _MICROMETRE, steps[1] * _MICROMETRE))


def _compared(file: str, one: _Read, other: _Read) -> ReaderComparison:
    """Return the comparison of two maps."""
    said = []
    pitch = (one.pitch[0] / other.pitch[0], one.pitch[1] / other.pitch[1])
    missing = (int(np.isnan(one.heights).sum()), int(np.isnan(other.heights).sum()))
    if not one.unit_stated:
        said.append("SurfaceTopography finds no unit, surfalize assumes one")
    for factor, word in zip(pitch, ("rows", "columns"), strict=True):
        if abs(factor - 1) > SAME:
            said.append(
                f"pitch of {word}: SurfaceTopography has {factor:.6g} times that of "
                "surfalize"
            )
    if missing[0] != missing[1]:
        said.append(
            f"missing points: SurfaceTopography {missing[0]}, surfalize {missing[1]}"
        )
    turn, height, rest = _height_factor(one.heights, other.heights)
    shift = _shift(one.heights, other.heights) if height is None else 0
    if shift:
        height = 1.0
        said.append(
            f"heights: surfalize has them shifted by {shift} points along the file"
        )
    elif height is None:
        said.append("the heights are not alike in any orientation")
    else:
        if turn != "upright":
            said.append(f"orientation: surfalize has the map {turn}")
        if abs(height - 1) > SAME:
            said.append(
                f"heights: SurfaceTopography has {height:.6g} times those of surfalize"
            )
        if rest > SAME:
            said.append(
                f"heights differ by {100 * rest:.2g} % of their rms beyond that"
            )
    return ReaderComparison(file, True, "", pitch, height, missing, tuple(said))


def _shift(one: FloatArray, other: FloatArray) -> int:
    """Return by how many points of the file equal heights are shifted; 0 for none."""
    first, second = one.ravel(), other.ravel()
    if first.size != second.size:
        return 0
    for points in range(1, min(_MOST_SHIFT, first.size - 1) + 1):
        for sign, near, far in ((1, first, second), (-1, second, first)):
            same = np.isclose(near[:-points], far[points:], rtol=SAME, atol=0.0)
            if np.mean(same) > _ALIKE:
                return sign * points
    return 0


def _height_factor(
    one: FloatArray, other: FloatArray
) -> tuple[str, float | None, float]:
    """Return orientation, factor and remaining difference over the rms [-]."""
    for word, turn in _TURNS.items():
        turned = turn(other)
        if turned.shape != one.shape:
            continue
        known = np.isfinite(one) & np.isfinite(turned)
        if np.count_nonzero(known) < 2:
            continue
        first = one[known] - one[known].mean()
        second = turned[known] - turned[known].mean()
        size = float(np.sqrt((first @ first) * (second @ second)))
        if not size or float(first @ second) < _ALIKE * size:
            continue
        factor = float(first @ second) / float(second @ second)
        rest = first - factor * second
        return word, factor, float(np.sqrt((rest @ rest) / (first @ first)))
    return "", None, 0.0
