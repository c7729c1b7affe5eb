# SPDX-License-Identifier: MIT
"""Test of linearity: whether the FRF depends on the force level.

The FRF of every hit is regressed on the level of that hit, line by line: H(f) = mean(f)
+ slope(f) log2(level). The slope of a linear structure is noise alone, so an F test is
made on the slopes of all lines together.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    freeze,
)
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.basics.tail_probabilities import f_above
from jointbench.signal.frf.frf import excited_band
from jointbench.signal.hits.hit_pairs import Pair, pair_up
from jointbench.signal.hits.hit_spectra import ForcesOfHits

_LEAST_HITS = 3
# Hits whose levels differ by less than this factor cannot show a dependence.
_LEAST_SPAN = 1.2
_CHANCE = 0.01
# The scatter of a few hits is itself noisy; it is averaged over this many lines.
_SMOOTH_LINES = 41
_BLOCK_LINES = 512


@dataclass(frozen=True, slots=True, eq=False)
class Linearity:
    """How the FRF changes with the level of the hits.

    Attributes:
        change: of the FRF for a doubling of the force, rms over pairs, as a share of
            the rms of the FRF on that line [-], shape (n_lines,).
        frequency: [Hz], of the excited band, shape (n_lines,).
        change_per_doubling: the same over the whole band, less the part of noise [-].
        f_value: power of the slopes over that expected from the scatter of the hits
            [-].
        significance: probability of a value this large for a linear structure [-].
        levels: lowest and highest rms force spectrum in the band [N s].
        hits: number of hits.
    """

    change: FloatArray
    frequency: FloatArray
    change_per_doubling: float
    f_value: float
    significance: float
    levels: tuple[float, float]
    hits: int

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "change", "frequency")

    @property
    def nonlinear(self) -> bool:
        """True if the probability for a linear structure is below 1 %."""
        return self.significance < _CHANCE

    @property
    def words(self) -> str:
        """Return the result as one sentence."""
        low, high = self.levels
        span = f"from {low:.3g} to {high:.3g} N s ({self.hits} hits)"
        share = 100.0 * self.change_per_doubling
        if self.nonlinear:
            return (
                f"not linear {span}: the FRF changes by {share:.2g} % for a doubling "
                f"of the force (F {self.f_value:.3g}, p {self.significance:.1g})"
            )
        return (
            f"no dependence on level {span}: a doubling of the force changes the FRF "
            f"by {share:.2g} %, and noise does as much or more in "
            f"{100.0 * self.significance:.2g} % of cases"
        )


def check_linearity(
    spectra: ForcesOfHits, band: tuple[float, float] | None = None
) -> Linearity:
    """Test whether the FRF depends on the level of the hits.

    Args:
        spectra: of accepted hits, at least three at one point, at different levels.
        band: lowest and highest frequency of the test [Hz]; None for the excited band.

    Returns:
        The change with level and its significance. A drift in time that follows the
        level looks the same: alternate soft and hard hits.

    Raises:
        BadData: fewer than three hits at every point, or all at one level.

    Source:
        Seber and Lee, Linear Regression Analysis (2003), sec. 4.3 (F test); ISO
        7626-5:2019 requires the check.
    """
    low, high = band or excited_band(spectra)
    inside = (spectra.frequency >= low) & (spectra.frequency <= high)
    impulse = _levels(spectra, inside)
    groups = _comparable(spectra, impulse)
    fits = [_regress(spectra, pair, impulse[pair.hits], inside) for pair in groups]
    slope_power = np.sum([f.slope_power for f in fits], axis=0)
    noise_power = np.sum([f.noise_power for f in fits], axis=0)
    level = np.sum([f.level for f in fits], axis=0)
    f_value, significance = _test(fits)
    used = np.concatenate([impulse[p.hits] for p in groups])
    excess = float(np.sum(slope_power - noise_power) / np.sum(level))
    return Linearity(
        change=np.sqrt(slope_power / level),
        frequency=spectra.frequency[inside],
        change_per_doubling=float(np.sqrt(max(0.0, excess))),
        f_value=f_value,
        significance=significance,
        levels=(float(used.min()), float(used.max())),
        hits=int(np.unique(np.concatenate([p.hits for p in groups])).size),
    )


def level_range(
    spectra: ForcesOfHits, band: tuple[float, float]
) -> tuple[float, float]:
    """Return lowest and highest level of the hits that a test would use [N s].

    Args:
        spectra: of accepted hits; no response is asked for.
        band: lowest and highest frequency [Hz].

    Raises:
        BadData: as `check_linearity`.
    """
    inside = (spectra.frequency >= band[0]) & (spectra.frequency <= band[1])
    impulse = _levels(spectra, inside)
    used = np.concatenate([impulse[p.hits] for p in _comparable(spectra, impulse)])
    return float(used.min()), float(used.max())


def _comparable(spectra: ForcesOfHits, impulse: FloatArray) -> list[Pair]:
    """Return the pairs with enough hits at different levels."""
    outputs, inputs, pairs = pair_up(spectra)
    groups = [
        p for p in pairs if _spread(impulse[p.hits]) and p.hits.size >= _LEAST_HITS
    ]
    if not groups:
        raise BadData(
            f"linearity needs {_LEAST_HITS} accepted hits at one point whose levels "
            f"differ by a factor of {_LEAST_SPAN} or more; none of {len(outputs)} x "
            f"{len(inputs)} pairs has them: alternate soft and hard hits"
        )
    return groups


@dataclass(frozen=True, slots=True, eq=False)
class _Fit:
    """The regression of one pair, line by line.

    Attributes:
        slope_power: power of the slope |slope|^2, shape (n_lines,).
        noise_power: that expected from noise alone, shape (n_lines,).
        level: |mean FRF|^2, shape (n_lines,).
        hits: number of hits.
        correlation: neighbouring lines that carry one independent error, 1 or more.
    """

    slope_power: FloatArray
    noise_power: FloatArray
    level: FloatArray
    hits: int
    correlation: float


def _regress(
    spectra: ForcesOfHits, pair: Pair, impulse: FloatArray, inside: BoolArray
) -> _Fit:
    """Regress the hits of a pair, some lines at a time: they fit into the cache."""
    response = spectra.responses(pair, inside)
    lines = np.flatnonzero(inside)
    slope_power, noise_power, level_power = np.empty((3, lines.size))
    level = np.log2(impulse)[:, None]
    last: ComplexArray | None = None
    shared = power = 0.0
    for first in range(0, lines.size, _BLOCK_LINES):
        here = slice(first, first + _BLOCK_LINES)
        force = spectra.force[pair.hits[:, None], lines[here]]
        frf, weight = response[:, here] / force, _power(force)
        # Weighted by |F|^2: the noise of a hit's FRF is response noise over force.
        total = weight.sum(axis=0)
        centred = level - (weight * level).sum(axis=0) / total
        mean = (weight * frf).sum(axis=0) / total
        lever = (weight * centred**2).sum(axis=0)
        slope = (weight * centred * frf).sum(axis=0) / lever
        residual = (frf - mean - centred * slope) * np.sqrt(weight)
        left = _power(residual).sum(axis=0)
        slope_power[here], level_power[here] = _power(slope), _power(mean)
        noise_power[here] = left / (pair.hits.size - 2) / lever
        power += float(left.sum())
        joined = residual if last is None else np.hstack((last, residual))
        shared += float(np.vdot(joined[:, :-1], joined[:, 1:]).real)
        last = residual[:, -1:]
    length = _correlation_length(shared, power) if lines.size > 2 else 1.0
    return _Fit(slope_power, noise_power, level_power, pair.hits.size, length)


def _test(fits: Sequence[_Fit]) -> tuple[float, float]:
    """Return F and its p-value, pooled; neighbouring lines may share one error."""
    numerator = sum(float(np.sum(f.slope_power / _pooled(f))) for f in fits)
    lines = sum(f.level.size for f in fits)
    length = max(f.correlation for f in fits)
    freedom = 2.0 * lines / length
    hits = sum(f.level.size * (f.hits - 2) for f in fits)
    f_value = numerator / lines
    return f_value, f_above(f_value, freedom, 2.0 * hits / length)


def _pooled(fit: _Fit) -> FloatArray:
    """Return the variance of the slopes, smoothed over lines."""
    smooth = uniform_filter1d(fit.noise_power, _SMOOTH_LINES, mode="nearest")
    return np.asarray(np.where(smooth > 0.0, smooth, np.inf))


def _power(values: ComplexArray) -> FloatArray:
    return np.asarray(values.real**2 + values.imag**2)


def _correlation_length(shared: float, power: float) -> float:
    """Return how many neighbouring lines carry one independent error, 1 or more.

    Args:
        shared: sum over neighbouring lines of the product of their residuals.
        power: sum of the squared residuals.
    """
    if power == 0.0:
        return 1.0
    share = min(max(shared / power, 0.0), 0.99)
    return (1.0 + share) / (1.0 - share)


def _levels(spectra: ForcesOfHits, inside: BoolArray) -> FloatArray:
    """Return the rms force spectrum of each hit over the band [N s]."""
    return np.asarray(np.sqrt(np.mean(np.abs(spectra.force[:, inside]) ** 2, axis=1)))


def _spread(levels: FloatArray) -> bool:
    return bool(levels.max() >= _LEAST_SPAN * levels.min())
