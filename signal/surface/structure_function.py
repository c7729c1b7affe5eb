# SPDX-License-Identifier: MIT
"""Estimate the structure function: the mean squared height difference over the lag."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from jointbench.acquisition.basics.array_checks import (
    require_ascending,
    require_finite,
    require_shape,
)
from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, IntArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.provenance import Provenance, step
from jointbench.acquisition.records.surfaces import Profile, Surface
from jointbench.signal.surface.binned_spectrum import BinnedSpectrum, spectrum_of
from jointbench.signal.surface.levelling import SurfaceTooSmall, level
from jointbench.signal.surface.quantisation_step import height_step
from jointbench.signal.surface.texture_direction import stretch_across

_LAG_COUNT = 55
"""Default number of logarithmic lags before equal integers are merged [-]."""
_LARGEST_LAG_SHARE = 1 / 3
"""Largest default lag as a share of the length of a profile [-]."""
_MOST_BLOCKS = 16
"""Strips of neighbouring rows whose scatter checks the stated uncertainty [-]."""

Direction = Literal["x", "y"]
_Removal = Literal["line", "mean"]


@dataclass(frozen=True, slots=True, eq=False)
class Sampling:
    """Sampling of one contact surface, for the covariance of S.

    Attributes:
        points: points of one profile.
        profiles: parallel profiles averaged.
        spacing: distance of neighbours along the profiles [m].
        row_distance: distance of neighbouring profiles, scaled by the lay so that
            heights vary across it as along the profiles [m]; infinite for unrelated,
            separately levelled profiles.
        share: share of S from this contact surface [-].
        pairs: pairs of measured points at each lag, shape (n_lags,).
        blocks: S of strips of neighbouring profiles [m^2], shape (n_blocks, n_lags);
            no rows if not calculated.
    """

    points: int
    profiles: int
    spacing: float
    row_distance: float
    share: float
    pairs: FloatArray
    blocks: FloatArray

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_shape("blocks", self.blocks, (None, self.pairs.size))
        freeze(self, "pairs", "blocks")


@dataclass(frozen=True, slots=True, eq=False)
class StructureFunction:
    """S(lag) = mean of (z(x + lag) - z(x))^2 over all measured pairs.

    Attributes:
        name: of the surface.
        lag: [m], shape (n_lags,), ascending.
        value: S [m^2], same shape.
        kurtosis: fourth moment of the differences over S squared, same shape [-];
            3 where the heights are Gaussian.
        samplings: sampling of each contributing contact surface.
        quantum: quantisation step of the heights [m]; 0 for none.
        provenance: origin and processing steps.
        spectrum: of profiles without gaps; None if not calculated.
    """

    name: str
    lag: FloatArray
    value: FloatArray
    kurtosis: FloatArray
    samplings: tuple[Sampling, ...]
    quantum: float = 0.0
    provenance: Provenance = field(default=())
    spectrum: BinnedSpectrum | None = None

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_ascending("lag", self.lag)
        for name in ("value", "kurtosis"):
            require_shape(name, getattr(self, name), self.lag.shape)
            require_finite(name, getattr(self, name))
        freeze(self, "lag", "value", "kurtosis")

    @property
    def pairs(self) -> FloatArray:
        """Measured pairs at each lag, of the contact surface with the fewest."""
        pairs: FloatArray = np.min(
            [sampling.pairs for sampling in self.samplings], axis=0
        )
        return pairs

    @property
    def spacing(self) -> float:
        """Distance of neighbouring points, of the coarsest contact surface [m]."""
        return max(sampling.spacing for sampling in self.samplings)

    @property
    def points(self) -> int:
        """Points of one profile, of the contact surface with the fewest."""
        return min(sampling.points for sampling in self.samplings)

    @property
    def profiles(self) -> int:
        """Parallel profiles, of the contact surface with the fewest."""
        return min(sampling.profiles for sampling in self.samplings)

    @property
    def separate(self) -> bool:
        """Whether every profile was levelled separately, not as part of a map."""
        return all(f.profiles == 1 or np.isinf(f.row_distance) for f in self.samplings)

    def only(self, keep: BoolArray) -> "StructureFunction":
        """Return the structure function at the lags marked in `keep`."""
        samplings = tuple(
            replace(
                sampling, pairs=sampling.pairs[keep], blocks=sampling.blocks[:, keep]
            )
            for sampling in self.samplings
        )
        return replace(
            self,
            lag=self.lag[keep],
            value=self.value[keep],
            kurtosis=self.kurtosis[keep],
            samplings=samplings,
        )


def structure_function(
    surface: Surface,
    *,
    lags: Sequence[int] | None = None,
    direction: Direction = "x",
    remove: _Removal = "line",
) -> StructureFunction:
    """Estimate the structure function of a surface by direct sums.

    The mean line or plane is removed first by default. Sums over pairs are exact (a
    Fourier transform loses digits by cancellation) and skip missing points.

    Args:
        surface: a profile, or a map as parallel profiles.
        lags: lags in samples; by default about 45 from 1 to a third of the length,
            at even steps of their logarithm.
        direction: of the profiles of a map: ``"x"`` along its rows, ``"y"`` along its
            columns. A profile has the direction ``"x"`` only.
        remove: ``"line"``, or ``"mean"`` for heights without tilt.

    Returns:
        The structure function at the lags with at least one measured pair.

    Raises:
        SurfaceTooSmall: too few measured points, or no pair at any lag.
        UsageError: a lag below 1 or beyond the profile, or a profile along ``"y"``.
    """
    levelled = level(surface) if remove == "line" else surface
    heights, valid, spacing, across = _as_rows(levelled, direction)
    wanted = _lags(heights.shape[1], lags)
    sums, fourths, pairs = _row_sums(heights, valid, wanted)
    keep = pairs.sum(axis=0) > 0
    if not keep.any():
        raise SurfaceTooSmall(
            f"surface {surface.name!r} has no two measured points at any lag; "
            "it is too full of gaps, measure it again"
        )
    sums, fourths, pairs = (array[:, keep] for array in (sums, fourths, pairs))
    lag = np.asarray(wanted[keep] * spacing, dtype=np.float64)
    value = sums.sum(axis=0) / pairs.sum(axis=0)
    safe = np.where(value > 0, value, 1.0)
    sampling = Sampling(
        points=heights.shape[1],
        profiles=heights.shape[0],
        spacing=spacing,
        row_distance=across * stretch_across(heights, valid, lag, value, across),
        share=1.0,
        pairs=pairs.sum(axis=0),
        blocks=_blocks(sums, pairs),
    )
    return StructureFunction(
        name=surface.name,
        lag=lag,
        value=value,
        kurtosis=fourths.sum(axis=0) / pairs.sum(axis=0) / safe**2,
        samplings=(sampling,),
        quantum=height_step(surface.heights[surface.valid]),
        provenance=(
            *levelled.provenance,
            step("structure_function", direction=direction, lags=int(lag.size)),
        ),
        spectrum=spectrum_of(levelled),
    )


def combine(a: StructureFunction, b: StructureFunction) -> StructureFunction:
    """Add the structure functions of two independent contact surfaces of a joint.

    Where the lags differ, `b` is interpolated at the lags of `a` (straight in the
    logarithms) over the range that both share.

    Args:
        a: of one contact surface.
        b: of the other contact surface.

    Returns:
        S_e = S_a + S_b with both samplings, so that its covariance is the sum of
        both.

    Raises:
        UsageError: the two share no lag, or one of them is flat (S = 0).

    Source:
        S1 eq. (11): S_e = S_a + S_b for independent surfaces.
    """
    keep = (a.lag >= b.lag[0] * (1 - 1e-9)) & (a.lag <= b.lag[-1] * (1 + 1e-9))
    if not keep.any() or min(a.value.min(), b.value.min()) <= 0:
        raise UsageError(
            f"surfaces {a.name!r} and {b.name!r} share no lag with roughness on both; "
            "give two rough surfaces measured over the same range of lags"
        )
    a = a.only(keep)
    b = _at(b, a.lag)
    value = a.value + b.value
    part = a.value / value
    share = float(np.median(part))
    return StructureFunction(
        name=f"{a.name} + {b.name}",
        lag=a.lag,
        value=value,
        # Fourth moments of a sum of independent differences with S_a and S_b.
        kurtosis=3 + (a.kurtosis - 3) * part**2 + (b.kurtosis - 3) * (1 - part) ** 2,
        samplings=(*_shared(a, share), *_shared(b, 1 - share)),
        quantum=max(a.quantum, b.quantum),
        provenance=(
            *a.provenance,
            *b.provenance,
            step("combine", first=a.name, second=b.name, share_first=share),
        ),
        spectrum=None,
    )


def _shared(one: StructureFunction, share: float) -> tuple[Sampling, ...]:
    """Return the samplings of one side with their share of the sum, without strips."""
    none = np.empty((0, one.lag.size))
    return tuple(
        replace(sampling, share=sampling.share * share, blocks=none)
        for sampling in one.samplings
    )


def _at(one: StructureFunction, lag: FloatArray) -> StructureFunction:
    """Return `one` at other lags, straight between its own in the logarithms."""
    known, asked = np.log(one.lag), np.log(lag)
    samplings = tuple(
        replace(
            sampling,
            pairs=np.interp(asked, known, sampling.pairs),
            blocks=np.empty((0, lag.size)),
        )
        for sampling in one.samplings
    )
    return replace(
        one,
        lag=lag,
        value=np.exp(np.interp(asked, known, np.log(one.value))),
        kurtosis=np.interp(asked, known, one.kurtosis),
        samplings=samplings,
    )


def _as_rows(
    surface: Surface, direction: Direction
) -> tuple[FloatArray, BoolArray, float, float]:
    """Return heights and mask as rows, their spacing and the rows' distance [m]."""
    if isinstance(surface, Profile):
        if direction != "x":
            raise UsageError(
                f"surface {surface.name!r} is a profile, it has no direction "
                f"{direction!r}; use direction 'x'"
            )
        return surface.heights[None, :], surface.valid[None, :], surface.spacing, 0.0
    across, along = surface.spacing
    if direction == "x":
        return surface.heights, surface.valid, along, across
    rows = np.ascontiguousarray(surface.heights.T)
    return rows, np.ascontiguousarray(surface.valid.T), across, along


def _lags(points: int, lags: Sequence[int] | None) -> IntArray:
    """Return the lags to take [samples]."""
    if lags is None:
        longest = max(1, min(points - 1, int(points * _LARGEST_LAG_SHARE)))
        even = np.geomspace(1, longest, _LAG_COUNT)
        return np.unique(np.rint(even).astype(np.int64))
    wanted = np.unique(np.asarray(lags, dtype=np.int64))
    if wanted.size == 0 or wanted[0] < 1 or wanted[-1] >= points:
        raise UsageError(
            f"lags {list(lags)[:5]} must be whole samples from 1 to {points - 1}"
        )
    return wanted


def _row_sums(
    heights: FloatArray, valid: BoolArray, lags: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return sums of squares, of fourth powers and pairs, each (n_rows, n_lags)."""
    rows, points = heights.shape
    complete = bool(valid.all())
    known = valid.astype(np.float64)
    sums, fourths, pairs = np.empty((3, rows, lags.size))
    for k, lag in enumerate(lags):
        difference = heights[:, lag:] - heights[:, :-lag]
        if complete:
            pairs[:, k] = points - lag
        else:
            both = known[:, lag:] * known[:, :-lag]
            difference *= both
            pairs[:, k] = both.sum(axis=1)
        np.square(difference, out=difference)
        sums[:, k] = difference.sum(axis=1)
        fourths[:, k] = np.einsum("ij,ij->i", difference, difference)
    return sums, fourths, pairs


def _blocks(sums: FloatArray, pairs: FloatArray) -> FloatArray:
    """Return S of up to `_MOST_BLOCKS` strips of rows; none if a strip lacks pairs."""
    count = min(_MOST_BLOCKS, sums.shape[0] // 4)
    if count < _MOST_BLOCKS // 2:
        return np.empty((0, sums.shape[1]))
    starts = np.linspace(0, sums.shape[0], count, endpoint=False).astype(np.int64)
    total = np.add.reduceat(pairs, starts, axis=0)
    if not total.all():
        return np.empty((0, sums.shape[1]))
    strips: FloatArray = np.add.reduceat(sums, starts, axis=0) / total
    return strips
