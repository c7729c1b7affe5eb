# SPDX-License-Identifier: MIT
"""Closed modes that an uncertain modal table leaves open: frequencies and couplings.

Errors of a table are errors of the modal stiffness of the closed structure. On the
diagonal they are shifts of frequencies; beside it they turn modes into each other,
which matters beyond first order only where their frequencies are close.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class TunedStiffness:
    """Modal stiffness beyond that of the model, by which closed modes are tuned.

    Attributes:
        rows: modal force on the free modes by each, shape (n_tuned, n_modes).
        stiffness: between them [rad^2/s^2], shape (n_tuned, n_tuned).
        ends: the two modes of each coordinate, one for a frequency, shape
            (n_coordinates, 2).
        slope: of their stiffness by each coordinate [rad^2/s^2], shape
            (n_coordinates,).
    """

    rows: FloatArray
    stiffness: FloatArray
    ends: IntArray
    slope: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class TunedModes:
    """Closed modes whose frequencies an uncertain modal table leaves open.

    Their coordinates are the logarithms of their frequencies, then the couplings of
    close ones: the stiffness between two modes over twice the product of their
    frequencies, which shifts two equal ones by as much to either side.

    Attributes:
        rows: modal force on the free modes by each, shape (n_tuned, n_modes).
        omega: nominal natural angular frequencies [rad/s], shape (n_tuned,).
        pairs: modes that are coupled, shape (n_pairs, 2).
        sd: of the coordinates [-], shape (n_tuned + n_pairs,).
    """

    rows: FloatArray
    omega: FloatArray
    pairs: IntArray
    sd: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "rows", "omega", "pairs", "sd")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        alone = (f"frequency of mode {k + 1}" for k in range(self.omega.size))
        both = (f"coupling of modes {i + 1} and {j + 1}" for i, j in self.pairs)
        return (*alone, *both)

    def stiffness_at(self, x: FloatArray) -> TunedStiffness:
        """Return the stiffness by which the modes are tuned.

        Args:
            x: coordinates, shape (n_tuned + n_pairs,).
        """
        count = self.omega.size
        square = np.exp(2.0 * x[:count])
        own = self.omega**2
        stiffness = np.diag(own * (square - 1.0))
        first, second = self.pairs.T
        between = 2.0 * self.omega[first] * self.omega[second]
        stiffness[first, second] = stiffness[second, first] = between * x[count:]
        alone = np.repeat(np.arange(count)[:, None], 2, axis=1)
        ends = np.concatenate([alone, self.pairs])
        slope = np.concatenate([2.0 * own * square, between])
        return TunedStiffness(self.rows, stiffness, ends, slope)

    def coordinates_of(self, stiffness: FloatArray) -> FloatArray:
        """Return the coordinates of a stiffness between the modes [rad^2/s^2].

        Args:
            stiffness: shape (n_tuned, n_tuned); of modes that are no pair, what is
                beside the diagonal is left out.
        """
        square = 1.0 + np.diag(stiffness) / self.omega**2
        first, second = self.pairs.T
        between = 2.0 * self.omega[first] * self.omega[second]
        alone = 0.5 * np.log(np.maximum(square, np.finfo(float).tiny))
        return np.concatenate([alone, stiffness[first, second] / between])
