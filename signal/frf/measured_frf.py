# SPDX-License-Identifier: MIT
"""An FRF and whether it depends on the level of the hits, from one look at the hits."""

from collections.abc import Sequence
from dataclasses import dataclass

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.frf.estimators import Estimator
from jointbench.signal.frf.frf import Frf, frf_of_sums, sum_recordings
from jointbench.signal.frf.linearity import Linearity, linearity_of_sums
from jointbench.signal.frf.spectral_sums import SpectralSums
from jointbench.signal.hits.windows import HammerWindow


@dataclass(frozen=True, slots=True, eq=False)
class LevelCheck:
    """What the forces of the accepted hits say beside the FRF.

    Attributes:
        frequency: of the lines [Hz], shape (n_lines,).
        force_power: mean of |F|^2 over the hits [N^2 s^2], same shape.
        linearity: whether the FRF depends on the level, None where it was not checked.
        unchecked: why linearity was not checked, or empty.
    """

    frequency: FloatArray
    force_power: FloatArray
    linearity: Linearity | None
    unchecked: str = ""

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "force_power")

    @property
    def words(self) -> str:
        """Return the result as one sentence."""
        if self.linearity is None:
            return f"not checked: {self.unchecked}"
        return self.linearity.words


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredFrf:
    """An FRF with the test of its linearity.

    Attributes:
        frf: average over the accepted hits.
        levels: of these hits.
    """

    frf: Frf
    levels: LevelCheck


def measure_frf(
    recordings: Sequence[Recording],
    *,
    window: HammerWindow | None = None,
    estimator: Estimator = Estimator.H1,
) -> MeasuredFrf:
    """Estimate the FRF and test whether it depends on level; see `estimate_frf`.

    The responses are read and transformed once for both.

    Args:
        recordings: force and responses, all at one sample rate.
        window: for all hits, or None to choose it.
        estimator: H1, H2 or Hv.
    """
    summed = sum_recordings(recordings, window, levels=True)
    levels = _level_check(summed.sums)
    for pair in summed.sums.pairs:
        pair.slope = None
    return MeasuredFrf(frf_of_sums(summed, estimator), levels)


def check_levels(recordings: Sequence[Recording]) -> LevelCheck:
    """Test whether the FRF of recordings depends on the level of their hits.

    Args:
        recordings: with judged hits.
    """
    return _level_check(sum_recordings(recordings, None, levels=True).sums)


def _level_check(sums: SpectralSums) -> LevelCheck:
    try:
        linearity, unchecked = linearity_of_sums(sums), ""
    except BadData as error:
        linearity, unchecked = None, str(error)
    return LevelCheck(sums.frequency, sums.power, linearity, unchecked)
