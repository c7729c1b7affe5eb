# SPDX-License-Identifier: MIT
"""The second sign: do hard and soft hits give the same FRF around one mode?

No model of the decay enters: a neighbour that was left out, a transient, a wrong noise
level are the same for hard and soft hits. What differs between them depends on level.
"""

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.basics.tail_probabilities import f_above
from jointbench.signal.frf.linearity import check_linearity
from jointbench.signal.hits.hit_spectra import HitSpectra

# Lines around the mode that are compared, in halves of the half-power width.
_HALF_WIDTHS = 6.0
_LEAST_LINES = 6
# Levels closer than this factor are one level: aim and pulse differ as much.
_LEAST_FACTOR = 1.5


def compare_levels(
    spectra: HitSpectra, frequency: float, damping_ratio: float
) -> tuple[float | None, str]:
    """Test whether the FRF around a mode changes with the level of the hits.

    The scatter of aim is one error for all lines around a mode. So slope and scatter
    are pooled over the lines, and the scatter has the degrees of freedom of the hits
    alone: three hits can hardly show anything.

    Args:
        spectra: of all accepted hits.
        frequency: of the mode [Hz].
        damping_ratio: of the mode [-].

    Returns:
        The chance that a linear structure shows as much, and an empty text; or None
        and why it could not be asked.
    """
    step = float(spectra.frequency[1] - spectra.frequency[0])
    half = max(_HALF_WIDTHS * damping_ratio * frequency, _LEAST_LINES * step)
    try:
        found = check_linearity(spectra, (frequency - half, frequency + half))
    except BadData:
        return None, _why_not("")
    factor = found.levels[1] / found.levels[0]
    if factor < _LEAST_FACTOR:
        return None, _why_not(f", here by {factor:.2g}")
    freedom = max(2.0 * (found.hits - 2 * len(set(spectra.points))), 1.0)
    return f_above(found.f_value, 2.0, freedom), ""


def _why_not(here: str) -> str:
    return (
        "no second sign: it takes three hits or more at one point on levels that "
        f"differ by a factor of {_LEAST_FACTOR:g}{here}; hit softly and hard in turn"
    )
