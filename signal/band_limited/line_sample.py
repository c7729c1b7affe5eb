# SPDX-License-Identifier: MIT
"""Heights as the band-limited fit takes them: long waves and a spectrum."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Areal, Profile, Surface
from jointbench.signal.band_limited.block_means import BlockMeans, block_means
from jointbench.signal.band_limited.known_transfer import (
    KnownTransfer,
    known_transfer,
)
from jointbench.signal.surface.complete_lines import WHOLE_TAPER, complete_lines
from jointbench.signal.surface.levelling import level
from jointbench.signal.surface.line_spectrum import spectrum_of_lines

FEWEST_POINTS = 64
"""Least points of a line for a fit [-]."""
_BLOCKS = 128
"""Blocks of a profile [-]: enough that the spectrum beyond half of them is free of what
the taper leaks from the longest waves."""
_SHORTEST_BLOCK = 4
"""Least samples of a block [-]."""
_FIRST_ORDINATE = 3
"""Lowest ordinate where there are no blocks; levelling changes those below [-]."""
_ROUNDING = 1e-9
"""Root mean square over the range of the heights that is but rounding [-]."""
_CLEAR_OF_FILTER = 1.0
"""Highest wavenumber of the fit over that of a known cut-off [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class LineSample:
    """Lines of one pitch and length, of a profile, of several, or of a map.

    Attributes:
        name: of the surface.
        pitch: [m].
        points: of a line [-].
        lines: how many [-].
        scale: root mean square of the heights [m]; all else is in its units.
        transfer: what the instrument is known to do.
        blocks: long waves of independent profiles; None on a map and with gaps.
        omega: of the bins of the spectrum [rad/sample], shape (n_bins,).
        power: mean density in each bin, same shape.
        count: independent ordinates in each [-], same shape.
        floor: least density of all bins, inside filters as well: noise has no more.
    """

    name: str
    pitch: float
    points: int
    lines: int
    scale: float
    transfer: KnownTransfer
    blocks: BlockMeans | None
    omega: FloatArray
    power: FloatArray
    count: FloatArray
    floor: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "omega", "power", "count")

    @property
    def length(self) -> float:
        """Length of a line [m]."""
        return self.pitch * self.points


def line_sample(surfaces: Sequence[Surface], *, degree: int = 1) -> LineSample:
    """Return the lines of a surface, or of several profiles of one surface.

    Args:
        surfaces: one profile or map, or independent profiles of one pitch; longer
            ones are cut to the shortest.
        degree: of the polynomial that was removed [-].

    Raises:
        UsageError: several maps, profiles of different pitch, lines too short, or no
            roughness.
        SurfaceTooSmall: too few measured points.
    """
    first = surfaces[0]
    lines, taper = _lines_of(surfaces)
    points = lines.shape[1] if lines.size else 0
    if points < FEWEST_POINTS:
        raise UsageError(
            f"surface {first.name!r} has lines of {points} points without a gap, the "
            f"band-limited fit needs {FEWEST_POINTS}; measure a longer line"
        )
    spacing = first.spacing
    pitch = spacing if isinstance(spacing, float) else spacing[1]
    scale = float(np.std(lines))
    if scale <= _ROUNDING * float(np.ptp(first.heights[first.valid])):
        raise UsageError(
            f"surface {first.name!r} is a plane to within rounding: there is no "
            "roughness to fit; measure with a finer height range"
        )
    lines = lines / scale
    related = isinstance(first, Areal)
    transfer = known_transfer(first)
    blocks = None
    if taper == WHOLE_TAPER and not related:
        blocks = block_means(lines, _block_count(points, transfer), degree)
    found = spectrum_of_lines(lines, pitch, taper=taper, related=related)
    omega = 2 * np.pi * pitch * found.frequency
    start = 2 * np.pi * _FIRST_ORDINATE / points
    if blocks is not None:
        start = np.pi / blocks.size
    keep = (omega >= start) & (omega <= _CLEAR_OF_FILTER * transfer.highest)
    return LineSample(
        name=first.name,
        pitch=pitch,
        points=points,
        lines=lines.shape[0],
        scale=scale,
        transfer=transfer,
        blocks=blocks,
        omega=omega[keep],
        power=found.density[keep] / (4 * np.pi * pitch),
        count=found.count[keep],
        floor=_least(found.density) / (4 * np.pi * pitch),
    )


def _lines_of(surfaces: Sequence[Surface]) -> tuple[FloatArray, float]:
    """Return complete lines of one length, and the taper for their spectrum."""
    flat = [level(one) for one in surfaces]
    if len(flat) == 1:
        return complete_lines(
            np.atleast_2d(flat[0].heights), np.atleast_2d(flat[0].valid)
        )
    if not all(isinstance(one, Profile) for one in flat):
        raise UsageError("maps are fitted one by one; pool profiles only")
    if len({round(float(np.log(one.spacing)), 6) for one in surfaces}) > 1:
        raise UsageError("the profiles have different pitches; pool those of one")
    points = min(one.heights.size for one in flat)
    return complete_lines(
        np.array([one.heights[:points] for one in flat]),
        np.array([one.valid[:points] for one in flat]),
    )


def _least(density: FloatArray) -> float:
    """Return the least mean of five neighbouring bins."""
    if density.size < 5:
        return float(density.min())
    return float(np.convolve(density, np.full(5, 0.2), mode="valid").min())


def _block_count(points: int, transfer: KnownTransfer) -> int:
    """Return how many blocks a profile has: none may resolve a known filter."""
    waves = points * transfer.highest / (2 * np.pi)
    return int(max(8, min(_BLOCKS, points // _SHORTEST_BLOCK, 2 * waves)))
