# SPDX-License-Identifier: MIT
"""Ends of intervals where the likelihood has fallen by a ratio test's limit.

Few waves are as long as the roll-off, so that the root mean square of the heights and
the roll-off have skewed likelihoods: draws end too early. A likelihood ratio has its
level for any scale of a parameter, and whichever of a roll-off or none is more likely.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.band_limited.band_records import Interval95
from jointbench.signal.band_limited.matern_spectrum import BandLimited
from jointbench.signal.band_limited.roughness_moments import spectral_moments
from jointbench.signal.band_limited.scoring_search import Maximum, maximise
from jointbench.signal.band_limited.spectral_likelihood import SpectralLikelihood
from jointbench.signal.fractal.verdict_records import NORMAL_97_5

_LEVEL, _ROLL_OFF = 0, 2
"""Places of the parameters that are held."""
_ROUNDS = 4
"""Most searches for an end [-]."""
_NEAR = 0.03
"""Signed root of the ratio within which an end is found [-]."""
_LEAST_WIDTH = 1e-3
"""Least first step in ln [-]."""
_FARTHEST = 3.0
"""Most by which a step is stretched [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class _OfHeight(SpectralLikelihood):
    """The same with ln of the mean square height of some waves in place of ln level.

    Attributes:
        ends: lowest and highest wavenumber of these waves [rad/sample].
    """

    ends: tuple[float, float] = (0.0, np.pi)

    def model(self, parameters: FloatArray) -> BandLimited:
        """Return the surface of given parameters."""
        bare = SpectralLikelihood.model(self, np.concatenate([[0.0], parameters[1:]]))
        total = float(spectral_moments([bare], *self.ends)[0, 0])
        return replace(bare, level=float(np.exp(parameters[0])) / total)


def height_ends(
    likelihood: SpectralLikelihood,
    top: Maximum,
    waves: tuple[float, float],
    drawn: Interval95,
) -> Interval95:
    """Return the interval of a root mean square height by draws and by the ratio.

    Args:
        likelihood: of the fit.
        top: the most likely model with a roll-off.
        waves: shortest and longest wavelength, in any unit of length that `drawn` does
            not depend on: here samples.
        drawn: value and interval by draws, in any unit of height.

    Returns:
        The value with the wider of both intervals on each side.

    Source:
        Likelihood ratios: Wilks, Ann. Math. Stat. 9 (1938) 60.
    """
    ends = (2 * np.pi / waves[1], 2 * np.pi / waves[0])
    model = likelihood.model(top.parameters)
    start = top.parameters.copy()
    start[_LEVEL] = np.log(spectral_moments([model], *ends)[0, 0])
    other = _OfHeight(
        likelihood.sample, likelihood.tolerance, likelihood.heeds_tip, ends
    )
    # The square of the height has twice the logarithm.
    reach = 2 * np.log([drawn.low / drawn.value, drawn.high / drawn.value])
    low, high = _ends(other, top, start, _LEVEL, reach) / 2
    return _wider(drawn, low, high)


def roll_off_ends(
    likelihood: SpectralLikelihood, top: Maximum, drawn: Interval95
) -> Interval95:
    """Return the interval of the roll-off by draws and by the ratio, as for heights.

    Args:
        likelihood: of the fit.
        top: the most likely model with a roll-off.
        drawn: value and interval by draws, in any unit of length.
    """
    reach = np.log([drawn.low / drawn.value, drawn.high / drawn.value])
    low, high = _ends(likelihood, top, top.parameters, _ROLL_OFF, reach)
    return _wider(drawn, low, high)


def _wider(drawn: Interval95, low: float, high: float) -> Interval95:
    return Interval95(
        drawn.value,
        min(drawn.low, drawn.value * float(np.exp(low))),
        max(drawn.high, drawn.value * float(np.exp(high))),
    )


def _ends(
    likelihood: SpectralLikelihood,
    top: Maximum,
    start: FloatArray,
    place: int,
    reach: FloatArray,
) -> FloatArray:
    """Return how far one parameter is from its value at both ends, shape (2,)."""
    free = np.diag(top.information) > 0
    free[place] = False
    bounds = likelihood.bounds[place]
    found = np.zeros(2)
    for side, sign in enumerate((-1.0, 1.0)):
        width = max(abs(float(reach[side])), _LEAST_WIDTH)
        limit = abs(bounds[side] - float(start[place]))
        at = start.copy()
        for _ in range(_ROUNDS):
            width = min(width, limit)
            at[place] = start[place] + sign * width
            here = maximise(likelihood, at, free)
            root = float(np.sqrt(max(0.0, 2 * (top.value - here.value))))
            at = here.parameters.copy()
            if abs(root - NORMAL_97_5) < _NEAR or (width == limit and root < 1.9):
                break
            # The root is nearly straight in the parameter.
            width *= min(_FARTHEST, NORMAL_97_5 / max(root, 0.1))
        found[side] = sign * width
    return found
