# SPDX-License-Identifier: MIT
"""A linear base of a few modes with shapes at points; no mass matrix is needed.

The coordinates of a fit are, mode by mode, the logarithms of frequency and damping
ratio over their nominal values, and the change of each shape component over the
largest component of the mode.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.modal_bench.level_records import Port
from jointbench.analysis.lumped.lumped_model import GROUND


@dataclass(frozen=True, slots=True, eq=False)
class UnitModes:
    """Modes with shapes of unit modal mass.

    Attributes:
        frequency: undamped natural frequency [Hz], shape (n_modes,).
        damping: damping ratio [-], same shape.
        shapes: at the points [1/sqrt(kg)], shape (n_modes, n_points).
    """

    frequency: FloatArray
    damping: FloatArray
    shapes: FloatArray

    @property
    def omega(self) -> FloatArray:
        """Undamped natural frequency [rad/s], shape (n_modes,)."""
        return np.asarray(2.0 * np.pi * self.frequency)


@dataclass(frozen=True, slots=True, eq=False)
class ModalBase:
    """Nominal modes with priors.

    Attributes:
        points: names of the shape columns.
        nominal: the modes.
        sd: prior standard deviation of each coordinate [-], shape (n_base,).
    """

    points: tuple[str, ...]
    nominal: UnitModes
    sd: FloatArray

    def __post_init__(self) -> None:
        """Check the shapes once and make the arrays read-only."""
        modes = self.nominal.frequency.size
        require_shape("shapes", self.nominal.shapes, (modes, len(self.points)))
        require_shape("sd", self.sd, (modes * (2 + len(self.points)),))
        freeze(self, "sd")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return tuple(
            name
            for k in range(1, self.nominal.frequency.size + 1)
            for name in (f"f{k}", f"zeta{k}", *(f"shape{k}@{p}" for p in self.points))
        )

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the values, in the order of the names."""
        one = ("Hz", "-", *("kg^-1/2" for _ in self.points))
        return one * self.nominal.frequency.size

    @property
    def reach(self) -> FloatArray:
        """Largest shape component of each mode [1/sqrt(kg)], shape (n_modes,)."""
        return np.asarray(np.abs(self.nominal.shapes).max(axis=1))

    def modes(self, coordinates: FloatArray) -> UnitModes:
        """Return the modes at coordinates, shape (n_base,)."""
        x = coordinates.reshape(self.nominal.frequency.size, -1)
        return UnitModes(
            self.nominal.frequency * np.exp(x[:, 0]),
            self.nominal.damping * np.exp(x[:, 1]),
            self.nominal.shapes + self.reach[:, None] * x[:, 2:],
        )

    def values(self, coordinates: FloatArray) -> FloatArray:
        """Return the values in the order of the names, shape (n_base,)."""
        modes = self.modes(coordinates)
        return np.concatenate(
            [modes.frequency[:, None], modes.damping[:, None], modes.shapes], axis=1
        ).ravel()

    def value_sd(self, coordinates: FloatArray, sd: FloatArray) -> FloatArray:
        """Return the standard deviation of the values from that of coordinates."""
        modes = self.modes(coordinates)
        wide = np.tile(self.reach[:, None], (1, len(self.points)))
        slope = np.concatenate(
            [modes.frequency[:, None], modes.damping[:, None], wide], axis=1
        )
        return np.asarray(slope.ravel() * sd)


def port_shapes(modes: UnitModes, points: tuple[str, ...], port: Port) -> FloatArray:
    """Return the relative motion across a port in each mode, shape (n_modes,)."""
    first, second = port.between
    motion = modes.shapes[:, points.index(second)]
    if first != GROUND:
        motion = motion - modes.shapes[:, points.index(first)]
    return np.asarray(motion)
