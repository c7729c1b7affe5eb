# SPDX-License-Identifier: MIT
"""The second sign: do hard and soft hits give the same FRF around one mode?

No model of the decay enters: a neighbour that was left out, a transient, a wrong noise
level are the same for hard and soft hits. What differs between them depends on level.
"""

from jointbench.acquisition.basics.errors import BadData
from jointbench.signal.frf.linearity import check_linearity
from jointbench.signal.hits.hit_spectra import HitSpectra

# Lines around the mode that are compared, in halves of the half-power width.
_HALF_WIDTHS = 6.0
_LEAST_LINES = 6


def compare_levels(
    spectra: HitSpectra, frequency: float, damping_ratio: float
) -> tuple[float | None, str]:
    """Test whether the FRF around a mode changes with the level of the hits.

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
    band = (frequency - half, frequency + half)
    try:
        return check_linearity(spectra, band).significance, ""
    except BadData:
        return None, (
            "no second sign: it takes three hits at one point on levels that differ "
            "by a factor of 1.2 or more; hit softly and hard in turn"
        )
