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
    FloatArray,
    IntArray,
    freeze,
    squared_size,
)
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.basics.tail_probabilities import f_above
from jointbench.signal.frf.excited_band import excited_band
from jointbench.signal.frf.pair_sums import PairSums
from jointbench.signal.frf.spectral_sums import (
    HitAdder,
    LevelLines,
    SpectralSums,
)
from jointbench.signal.hits.hit_pairs import pair_up
from jointbench.signal.hits.hit_spectra import ForcesOfHits

_LEAST_HITS = 3
# Hits whose levels differ by less than this factor cannot show a dependence.
_LEAST_SPAN = 1.2
_CHANCE = 0.01
# The scatter of a few hits is itself noisy; it is averaged over this many lines.
_SMOOTH_LINES = 41
# As many lines show no correlation.
_FEW_LINES = 2


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
    lines = LevelLines.between(spectra.frequency, band or excited_band(spectra))
    pairs = pair_up(spectra)[2]
    _require_comparable(_levels(spectra, lines), [pair.hits for pair in pairs])
    part, count = lines.part, lines.past - lines.first
    adder = HitAdder.of(count, LevelLines(0, count))
    hits = zip(spectra.force, spectra.labels, spectra.points, strict=True)
    for number, (force, labels, point) in enumerate(hits):
        rows = (row[part] for row in spectra.responses(number))
        adder.add(force[part], rows, labels, point)
    sums = [(adder.of_pair(spectra, pair), pair.hits) for pair in pairs]
    impulse = np.array(adder.level)
    return _linearity(spectra.frequency[part], impulse, sums, slice(None))


def linearity_of_sums(sums: SpectralSums) -> Linearity:
    """Test what `sum_hits` gathered over the excited band; see `check_linearity`.

    Args:
        sums: with the regression on level.

    Raises:
        BadData: as `check_linearity`.
    """
    assert sums.level_lines is not None
    part = sums.level_lines.part
    pairs = list(zip(sums.pairs, sums.hits, strict=True))
    return _linearity(sums.frequency[part], sums.level, pairs, part)


def _linearity(
    frequency: FloatArray,
    impulse: FloatArray,
    sums: Sequence[tuple[PairSums, IntArray]],
    part: slice,
) -> Linearity:
    """Pool the regressions of the pairs that have enough hits at different levels.

    Args:
        frequency: of the lines of the regressions [Hz].
        impulse: level of each hit [N s].
        sums: of each pair, and its hits.
        part: lines of H1 that are those of the regressions.
    """
    _require_comparable(impulse, [hits for _, hits in sums])
    used = [(one, hits) for one, hits in sums if _is_comparable(impulse[hits])]
    fits = [_fit(one, part) for one, _ in used]
    slope_power = np.sum([f.slope_power for f in fits], axis=0)
    noise_power = np.sum([f.noise_power for f in fits], axis=0)
    level = np.sum([f.level for f in fits], axis=0)
    f_value, significance = _test(fits)
    struck = np.unique(np.concatenate([hits for _, hits in used]))
    excess = float(np.sum(slope_power - noise_power) / np.sum(level))
    return Linearity(
        change=np.sqrt(slope_power / level),
        frequency=frequency,
        change_per_doubling=float(np.sqrt(max(0.0, excess))),
        f_value=f_value,
        significance=significance,
        levels=(float(impulse[struck].min()), float(impulse[struck].max())),
        hits=int(struck.size),
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
    impulse = _levels(spectra, LevelLines.between(spectra.frequency, band))
    hits = [pair.hits for pair in pair_up(spectra)[2]]
    _require_comparable(impulse, hits)
    used = [impulse[own] for own in hits if _is_comparable(impulse[own])]
    return float(min(map(np.min, used))), float(max(map(np.max, used)))


def _require_comparable(impulse: FloatArray, hits: Sequence[IntArray]) -> None:
    """Raise `BadData` where no pair has enough hits at different levels."""
    if not any(_is_comparable(impulse[own]) for own in hits):
        raise BadData(
            f"linearity needs {_LEAST_HITS} accepted hits at one point whose levels "
            f"differ by a factor of {_LEAST_SPAN} or more; none of {len(hits)} pairs "
            "of output and input has them: alternate soft and hard hits"
        )


def _is_comparable(levels: FloatArray) -> bool:
    apart = levels.max() >= _LEAST_SPAN * levels.min()
    return bool(apart and levels.size >= _LEAST_HITS)


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


def _fit(sums: PairSums, part: slice) -> _Fit:
    """Return the regression of a pair; `part` of the lines of H1 are its lines."""
    slope = sums.slope
    assert slope is not None
    return _Fit(
        slope_power=squared_size(slope.slope),
        noise_power=slope.scatter / (sums.hits - 2) / slope.total,
        level=squared_size(sums.h1[part]),
        hits=sums.hits,
        correlation=_correlation_length(slope.shared, slope.scatter),
    )


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


def _correlation_length(shared: float, scatter: FloatArray) -> float:
    """Return how many neighbouring lines carry one independent error, 1 or more.

    Args:
        shared: sum over neighbouring lines of the product of their residuals.
        scatter: sum of the squared residuals of each line.
    """
    power = float(scatter.sum())
    if power == 0.0 or scatter.size <= _FEW_LINES:
        return 1.0
    share = min(max(shared / power, 0.0), 0.99)
    return (1.0 + share) / (1.0 - share)


def _levels(spectra: ForcesOfHits, lines: LevelLines) -> FloatArray:
    """Return the rms force spectrum of each hit [N s]."""
    return np.array([lines.level(force) for force in spectra.force])
