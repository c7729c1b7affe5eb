# SPDX-License-Identifier: MIT
"""Likelihood of band-limited surfaces, and the parameters that are searched."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.band_limited.block_means import wavenumbers
from jointbench.signal.band_limited.line_sample import LineSample
from jointbench.signal.band_limited.matern_spectrum import BandLimited
from jointbench.signal.band_limited.tip_width import tip_surprise

HURST_RANGE = (0.02, 1.1)
"""Range of H [-]; beyond 1 the surface is smooth, which a fit must be able to say."""
LONGEST_ROLL_OFF = 30.0
"""Longest roll-off over the length [-]: levelled, such a surface has the likelihood of
one that never rolls off."""
_SHORTEST_ROLL_OFF = 4.0
"""Shortest roll-off [samples]."""
_WIDEST_CUT = 0.05
"""Widest short cut over the length [-]."""
IMPOSSIBLE = -1e300
FLOOR = 1e-30
"""Least density, in units of the variance: below it are rounding errors only."""


@dataclass(frozen=True, slots=True, eq=False)
class SpectralLikelihood:
    """Log-likelihood of a sample over (ln level, H, ln roll-off, blur, noise).

    Attributes:
        sample: the heights.
        tolerance: standard deviation of ln density by which each bin of the spectrum
            may differ from the model [-].
        heeds_tip: whether the stated radius of a stylus is a prior of the blur.
    """

    sample: LineSample
    tolerance: float = 0.0
    heeds_tip: bool = True

    @property
    def pivot(self) -> float:
        """Wavenumber of the level [rad/sample]: the geometric middle of the band."""
        top = min(np.pi, self.sample.transfer.highest)
        return float(np.sqrt(top * 2 * np.pi / self.sample.points))

    @property
    def counts(self) -> FloatArray:
        """Ordinates of each bin, fewer where the model is only tolerated [-]."""
        count = self.sample.count
        counts: FloatArray = count / (1 + count * self.tolerance**2)
        return counts

    def model(self, parameters: FloatArray) -> BandLimited:
        """Return the surface of given parameters."""
        level, hurst, roll_off, blur, noise = (float(one) for one in parameters)
        return BandLimited(
            level=float(np.exp(level)),
            pivot=self.pivot,
            hurst=hurst,
            roll_off=float(np.exp(roll_off)),
            blur=max(0.0, blur),
            noise=max(0.0, noise) * self.unit_noise,
        )

    @property
    def unit_noise(self) -> float:
        """Variance of white heights with the least density of the spectrum."""
        return 2 * np.pi * self.sample.floor

    def __call__(self, parameters: FloatArray) -> float:
        """Return the log-likelihood."""
        model, sample = self.model(parameters), self.sample
        density = np.maximum(model.sampled(sample.omega, sample.transfer), FLOOR)
        total = -float(np.sum(self.counts * (np.log(density) + sample.power / density)))
        if sample.blocks is not None:
            seen = model.sampled(wavenumbers(sample.blocks), sample.transfer)
            try:
                total += sample.blocks.log_likelihood(seen)
            except np.linalg.LinAlgError:
                return IMPOSSIBLE
        if self.heeds_tip:
            total -= 0.5 * tip_surprise(model, sample) ** 2
        return total if np.isfinite(total) else IMPOSSIBLE

    def deviance(self, parameters: FloatArray) -> tuple[float, int]:
        """Return the deviance of the spectrum and its number of bins.

        Source:
            Gamma deviance: McCullagh and Nelder, Generalized Linear Models, 2.3.
        """
        sample = self.sample
        density = self.model(parameters).sampled(sample.omega, sample.transfer)
        ratio = sample.power / density
        parts = 2 * self.counts * (ratio - 1 - np.log(ratio))
        return float(parts.sum()), int(parts.size)

    @property
    def bounds(self) -> list[tuple[float, float]]:
        """Lower and upper bounds of the parameters."""
        points = self.sample.points
        level = float(np.log(np.median(self.sample.power)))
        return [
            (level - 40, level + 40),
            HURST_RANGE,
            (np.log(_SHORTEST_ROLL_OFF), float(np.log(LONGEST_ROLL_OFF * points))),
            (0.0, (_WIDEST_CUT * points) ** 2),
            (0.0, 1.5),
        ]
