# SPDX-License-Identifier: MIT
"""Spectrum of a map in bins of wavelength and direction, as its fit takes it."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Areal
from jointbench.signal.band_limited.known_transfer import (
    KnownTransfer,
    known_transfer,
)
from jointbench.signal.surface.complete_patch import complete_patch
from jointbench.signal.surface.line_spectrum import fade

FEWEST_SIDE = 48
"""Least points of each side of a map that is fitted in two dimensions [-]."""
TAPER = 0.25
"""Share that is tapered at each end of both sides [-]: heights of H = 0.9 leak less
than their own spectrum, at 1.8 times the variance of untapered ordinates."""
FIRST_ORDINATE = 4
"""Lowest ordinate; levelling and the taper change those below."""
_BIN_RATIO = 1.18
"""Ratio of the wavelengths at the edges of a bin of long waves [-]."""
_WIDEST = float(np.pi / 40)
"""Widest bin of short waves [rad/sample]: a blur falls off steeply within them."""
_SECTOR_POINTS, _SECTORS = 12, (24, 72)
"""Points of the shorter side for each sector of directions, and their limits [-]: a lay
is narrow on large maps only where they resolve it."""
_ROWS = 64
"""Rows of the spectrum that are binned at a time [-]."""
_ROUNDING = 1e-9
"""Root mean square over the range of the heights that is but rounding [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class MapSample:
    """Binned spectrum of a map; lengths are in units of the pitch along its rows.

    Attributes:
        name: of the surface.
        pitch: along the rows [m].
        stretch: pitch along the columns over that along the rows [-].
        shape: points of the part without gaps (rows, columns).
        scale: root mean square of the heights [m]; all else is in its units.
        transfer: what the instrument is known to do.
        along: mean wavenumber along the rows in each bin [rad/sample], shape (n,).
        down: the same down the columns, same shape.
        power: mean two-sided density over both wavenumbers in each bin, same shape.
        count: independent ordinates in each [-], same shape.
        floor: least density over directions of all wavelengths; noise has no more.
    """

    name: str
    pitch: float
    stretch: float
    shape: tuple[int, int]
    scale: float
    transfer: KnownTransfer
    along: FloatArray
    down: FloatArray
    power: FloatArray
    count: FloatArray
    floor: float

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        for name in ("down", "power", "count"):
            require_shape(name, getattr(self, name), self.along.shape)
        freeze(self, "along", "down", "power", "count")

    def merged(self, sectors: int) -> "MapSample":
        """Return the sample in few sectors.

        Args:
            sectors: even, fewer than those of the sample.
        """
        radius = _ring(np.square(self.along) + np.square(self.down))
        turn = np.arctan2(self.down, self.along) / np.pi + 0.5
        ring = np.floor(radius - radius.min()).astype(np.int64)
        sector = np.minimum((turn * sectors).astype(np.int64), sectors - 1)
        label = ring * sectors + sector
        total = np.asarray(np.bincount(label, self.count), dtype=np.float64)
        full = total > 0
        along, down, power = (
            np.bincount(label, self.count * part)[full] / total[full]
            for part in (self.along, self.down, self.power)
        )
        return replace(self, along=along, down=down, power=power, count=total[full])

    @property
    def lowest(self) -> tuple[float, float]:
        """Wavenumbers of one wave along the rows and down the columns [rad/sample]."""
        rows, columns = self.shape
        return 2 * np.pi / columns, 2 * np.pi / (rows * self.stretch)

    @property
    def length(self) -> float:
        """Shorter side [samples of the rows]."""
        rows, columns = self.shape
        return float(min(columns, rows * self.stretch))


def map_sample(areal: Areal, *, degree: int = 1) -> MapSample | None:
    """Return the binned spectrum of the largest part of a map without gaps.

    Args:
        areal: the map; a plane is left out of it.
        degree: of the form that was removed [-]; each above 1 takes one ordinate.

    Returns:
        The spectrum, or None where that part is too small.

    Raises:
        UsageError: the map is a plane to within rounding.
    """
    patch = complete_patch(areal.heights, areal.valid)
    if min(patch.shape) < FEWEST_SIDE:
        return None
    heights = _without_plane(patch)
    scale = float(np.sqrt(np.mean(np.square(heights))))
    if scale <= _ROUNDING * float(np.ptp(patch)):
        raise UsageError(
            f"surface {areal.name!r} is a plane to within rounding: there is no "
            "roughness to fit; measure with a finer height range"
        )
    windows = [fade(n, TAPER) for n in heights.shape]
    heights *= (windows[0] / scale)[:, None]
    heights *= windows[1]
    waves = scipy.fft.rfft(heights, axis=1)
    del heights
    waves = scipy.fft.fft(waves, axis=0, overwrite_x=True)
    squares = [float(np.sum(w**2)) for w in windows]
    stretch = areal.spacing[0] / areal.spacing[1]
    first = FIRST_ORDINATE + max(0, degree - 1)
    along, down, power, count, floor = _binned(waves, patch.shape, stretch, first)
    # The taper correlates neighbouring ordinates.
    independent = np.prod(
        [s**2 / (w.size * np.sum(w**4)) for s, w in zip(squares, windows, strict=True)]
    )
    unit = stretch / (4 * np.pi**2 * squares[0] * squares[1])
    transfer = known_transfer(areal)
    inside = np.hypot(along, down) <= transfer.highest
    if transfer.short is None:
        inside[:] = True
    return MapSample(
        name=areal.name,
        pitch=areal.spacing[1],
        stretch=stretch,
        shape=(patch.shape[0], patch.shape[1]),
        scale=scale,
        transfer=transfer,
        along=along[inside],
        down=down[inside],
        power=unit * power[inside],
        count=np.maximum(1.0, count * independent)[inside],
        floor=unit * floor,
    )


def sectors_of(shape: tuple[int, ...]) -> int:
    """Return the number of directions in which the spectrum of a map is binned."""
    return int(np.clip(min(shape) // _SECTOR_POINTS, *_SECTORS))


def _without_plane(patch: FloatArray) -> FloatArray:
    """Return a copy of complete heights without their least-squares plane."""
    rows, columns = (np.linspace(-1, 1, n) for n in patch.shape)
    heights = patch - patch.mean()
    down = float(rows @ heights.sum(axis=1)) / (rows @ rows * columns.size)
    across = float(columns @ heights.sum(axis=0)) / (columns @ columns * rows.size)
    heights = np.asarray(heights - (down * rows)[:, None], dtype=np.float64)
    heights -= across * columns
    return heights


def _binned(
    waves: ComplexArray, shape: tuple[int, ...], stretch: float, first: int
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, float]:
    """Return mean wavenumbers, mean power and number of ordinates of each bin.

    The last number is the least mean over directions of five neighbouring wavelengths.
    """
    rows, columns = shape
    across = np.arange(1, (columns - 1) // 2 + 1)
    index = np.arange(rows)
    index = np.where(index > rows // 2, index - rows, index)
    right = 2 * np.pi * across / columns
    up = 2 * np.pi * index / (rows * stretch)
    sectors = sectors_of(shape)
    smallest = float(_ring(np.array(min(right[0], up[1]) ** 2)))
    largest = float(_ring(np.array(right[-1] ** 2 + up.max() ** 2)))
    rings = 2 + int(largest - smallest)
    sums = np.zeros((4, rings * sectors))
    for start in range(0, rows, _ROWS):
        part = slice(start, min(start + _ROWS, rows))
        block = waves[part, 1 : across.size + 1]
        power = np.square(block.real) + np.square(block.imag)
        high = np.abs(index[part])
        # The highest ordinate of an even number of rows is real.
        used = np.maximum(high[:, None], across) >= first
        used &= (2 * high < rows)[:, None]
        x, y = np.broadcast_arrays(right, up[part, None])
        ring = _ring(x**2 + y**2) - smallest
        turn = (np.arctan2(y, x) / np.pi + 0.5) * sectors
        label = ring.astype(np.int64) * sectors
        label += np.minimum(turn.astype(np.int64), sectors - 1)
        chosen: IntArray = label[used]
        for k, values in enumerate((None, power, x, y)):
            weights = None if values is None else values[used]
            sums[k] += np.bincount(chosen, weights, minlength=sums.shape[1])
    return _means(sums, sectors)


_RING = float(np.log(_BIN_RATIO))


def _ring(square: FloatArray) -> FloatArray:
    """Return the ring of a squared wavenumber, as a continuous number.

    Rings are equal in the logarithm up to their largest width, and equal beyond.
    """
    edge = _WIDEST / _RING
    radius = np.sqrt(square)
    low = np.log(np.minimum(radius, edge) / edge) / _RING
    return np.asarray(low + np.maximum(radius - edge, 0) / _WIDEST, dtype=np.float64)


def _means(
    sums: FloatArray, sectors: int
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, float]:
    """Return the means of the bins that have ordinates, and the least of all rings."""
    full = sums[0] > 0
    count, power, x, y = sums[:, full]
    totals = sums[:2].reshape(2, -1, sectors).sum(axis=2)
    mean = (totals[1] / np.maximum(totals[0], 1))[totals[0] > 0]
    least = mean if mean.size < 5 else np.convolve(mean, np.full(5, 0.2), mode="valid")
    return x / count, y / count, power / count, count, float(least.min())
