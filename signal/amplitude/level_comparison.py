# SPDX-License-Identifier: MIT
"""The second sign: do hard and soft hits give the same FRF around one mode?

No model of the decay enters: a neighbour that was left out, a transient, a wrong noise
level are the same for hard and soft hits. What differs between them depends on level.
"""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.basics.tail_probabilities import f_above
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.frf.linearity import check_linearity, level_range
from jointbench.signal.hits.hit_spectra import (
    ForcesOfHits,
    hit_forces,
    plan_spectra,
)
from jointbench.signal.hits.windows import choose_window, join_windows
from jointbench.signal.modal.modal_model import ModalModel

# Lines around the mode that are compared, in halves of the half-power width.
_HALF_WIDTHS = 6.0
_LEAST_LINES = 6
# Levels closer than this factor are one level: aim and pulse differ as much.
_LEAST_FACTOR = 1.5
# Spectral values around all modes that are kept (0.4 GB); above, hits are transformed
# again for each mode.
_MOST_VALUES = 25_000_000


def spectra_near_modes(
    recordings: Sequence[Recording], model: ModalModel
) -> ForcesOfHits:
    """Transform hits for `compare_levels` of the modes of a model.

    Args:
        recordings: with accepted hits.
        model: of the modes.

    Returns:
        The forces at the lines around the modes, and the responses where the levels of
        the hits differ enough for a comparison.
    """
    window = join_windows([choose_window(r) for r in recordings])
    plan = plan_spectra(recordings)
    pairs = zip(model.natural_frequency, model.damping_ratio, strict=True)
    bands = [_band(plan.frequency, float(f), float(z)) for f, z in pairs]
    near = np.zeros(plan.frequency.size, bool)
    for low, high in bands:
        near |= (plan.frequency >= low) & (plan.frequency <= high)
    forces = hit_forces(plan, window, near)
    apart = any(_factor(forces, band) >= _LEAST_FACTOR for band in bands)
    size = len(forces.points) * len(forces.labels[0]) * forces.frequency.size
    return forces.whole() if apart and size <= _MOST_VALUES else forces


def _band(
    lines: FloatArray, frequency: float, damping_ratio: float
) -> tuple[float, float]:
    """Return the band around a mode in which hits are compared [Hz]."""
    step = float(np.diff(lines).min())
    half = max(_HALF_WIDTHS * damping_ratio * frequency, _LEAST_LINES * step)
    return frequency - half, frequency + half


def _factor(spectra: ForcesOfHits, band: tuple[float, float]) -> float:
    """Return by how much the levels of the hits of a pair differ; 0 for too few."""
    try:
        low, high = level_range(spectra, band)
    except BadData:
        return 0.0
    return high / low


def compare_levels(
    spectra: ForcesOfHits, frequency: float, damping_ratio: float
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
    band = _band(spectra.frequency, frequency, damping_ratio)
    factor = _factor(spectra, band)
    if factor == 0.0:
        return None, _why_not("")
    if factor < _LEAST_FACTOR:
        return None, _why_not(f", here by {factor:.2g}")
    found = check_linearity(spectra, band)
    freedom = max(2.0 * (found.hits - 2 * len(set(spectra.points))), 1.0)
    return f_above(found.f_value, 2.0, freedom), ""


def _why_not(here: str) -> str:
    return (
        "no second sign: it takes three hits or more at one point on levels that "
        f"differ by a factor of {_LEAST_FACTOR:g}{here}; hit softly and hard in turn"
    )
