# SPDX-License-Identifier: MIT
"""What is computed of a machine: glued, jointed, at its tool, in time."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.analysis.structures.machine.complex_modes import PoleSet
from jointbench.analysis.structures.machine.shape_shares import (
    EnergyShares,
    MotionShares,
)
from jointbench.analysis.structures.machine.stability_lobes import StabilityLobes

AXES = ("x", "y", "z")


@dataclass(frozen=True, slots=True, eq=False)
class VariantModes:
    """The lowest modes of a machine at one set of joint values.

    Attributes:
        natural_frequency: undamped [Hz], shape (n_modes,).
        damping_ratio: of the complex mode of the same shape [-]; nan where there is
            none that oscillates.
        first_order: damping ratio to first order in the damping [-]; above one it is no
            damping ratio any more, but shows how far beyond critical the mode is.
        overdamped: number of poles that do not oscillate, of all those computed.
        oscillating: frequency |pole| / 2 pi [Hz] and damping ratio [-] of the lowest
            complex modes that oscillate, shape (2, n).
        energy: shares of strain energy.
        motion: shares of kinetic energy.
        shapes: columns, in the coordinates of the machine, shape (r, n_modes).
    """

    natural_frequency: FloatArray
    damping_ratio: FloatArray
    first_order: FloatArray
    overdamped: int
    oscillating: FloatArray
    energy: EnergyShares
    motion: MotionShares
    shapes: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "natural_frequency", "damping_ratio", "first_order")
        freeze(self, "oscillating", "shapes")


# Lines below this share of the median around them are near an antiresonance.
_ANTIRESONANCE = 0.1
_AROUND = 10


@dataclass(frozen=True, slots=True, eq=False)
class ReceptanceBound:
    """Largest error of the direct receptances by the reduction of the bodies.

    Attributes:
        frequency: lines [Hz], shape (n_lines,).
        size: of the receptances x, y, z [m/N], shape (3, n_lines).
        error: bound of their error [m/N], shape (3, n_lines).
    """

    frequency: FloatArray
    size: FloatArray
    error: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "size", "error")

    @property
    def largest(self) -> float:
        """Largest error over size, away from antiresonances [-]."""
        wide = np.pad(self.size, ((0, 0), (_AROUND, _AROUND)), mode="reflect")
        windows = np.lib.stride_tricks.sliding_window_view(wide, 2 * _AROUND + 1, 1)
        away = self.size > _ANTIRESONANCE * np.median(windows, axis=2)
        return float((self.error / self.size)[away].max())


@dataclass(frozen=True, slots=True, eq=False)
class ToolReceptance:
    """The receptance at the tool.

    Attributes:
        frequency: lines [Hz], shape (n_lines,).
        response: [m/N], shape (3, 3, n_lines).
        static: [m/N], shape (3, 3).
        largest: of the direct receptance along x, y, z in the band [m/N], shape (3,).
        at: frequencies of these [Hz], shape (3,).
        interval: 95 % interval of the sizes of the direct receptances [m/N], shape (2,
            3, n_lines); None without uncertainty.
        static_interval: of the direct ones [m/N], shape (2, 3); None without.
        bound: of the error of the direct receptances; None if it is not known.
    """

    frequency: FloatArray
    response: ComplexArray
    static: FloatArray
    largest: FloatArray
    at: FloatArray
    interval: FloatArray | None = None
    static_interval: FloatArray | None = None
    bound: ReceptanceBound | None = None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "response", "static", "largest", "at")
        freeze(self, "interval", "static_interval")


@dataclass(frozen=True, slots=True, eq=False)
class JointCost:
    """What one joint costs at the tool, along x, y and z.

    Attributes:
        name: of the joint.
        static: part of the static compliance that is in its own springs [-], shape
            (3,).
        static_gain: static compliance if this joint were rigid, over the present one
            [-], shape (3,).
        dynamic_gain: the same of the largest receptance in the band [-], shape (3,).
    """

    name: str
    static: FloatArray
    static_gain: FloatArray
    dynamic_gain: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "static", "static_gain", "dynamic_gain")


@dataclass(frozen=True, slots=True, eq=False)
class ToolMotion:
    """The motion of the tool under the loads.

    Attributes:
        time: [s], shape (n,).
        displacement: x, y, z [m], shape (3, n).
    """

    time: FloatArray
    displacement: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "time", "displacement")

    @property
    def largest(self) -> FloatArray:
        """Largest displacement along x, y, z [m], shape (3,)."""
        return np.asarray(np.abs(self.displacement).max(axis=1))

    @property
    def largest_at(self) -> FloatArray:
        """Times of the largest displacements [s], shape (3,)."""
        return np.asarray(self.time[np.abs(self.displacement).argmax(axis=1)])

    @property
    def late(self) -> FloatArray:
        """Largest displacement in the last fifth, x, y, z [m], shape (3,)."""
        begin = 4 * self.time.size // 5
        return np.asarray(np.abs(self.displacement[:, begin:]).max(axis=1))


@dataclass(frozen=True, slots=True, eq=False)
class VariantResult:
    """A machine at one set of joint values.

    Attributes:
        modes: the lowest ones.
        poles: all that were computed.
        tool: receptance at the tool.
        chatter: stability limit; None without a cut.
        motion: under the loads; None without a transient.
    """

    modes: VariantModes
    poles: PoleSet
    tool: ToolReceptance
    chatter: StabilityLobes | None = None
    motion: ToolMotion | None = None


@dataclass(frozen=True, slots=True, eq=False)
class MachineResult:
    """A machine, glued beside jointed.

    Attributes:
        glued: with rigid joints.
        jointed: at the given values.
        pairs: for each mode of the jointed machine the most similar glued one, and
            their MAC, shape (n_modes, 2).
        costs: of each joint at the tool.
        frequency_interval: 95 % of the jointed frequencies [Hz], shape (2, n_modes);
            None without uncertainty.
        limit_interval: 95 % of the stability limit [m]; None without.
        freedoms: before the reduction.
        size: of the reduced machine, and of its few coordinates.
        bound: largest bound of the relative error of a jointed frequency [-].
        turn: from the coordinates of the shapes to those of the machine, shape (n, r).
        speeds: of the bodies that turn, by name [rad/s].
    """

    glued: VariantResult
    jointed: VariantResult
    pairs: FloatArray
    costs: tuple[JointCost, ...]
    frequency_interval: FloatArray | None
    limit_interval: tuple[float, float] | None
    freedoms: int
    size: tuple[int, int]
    bound: float
    turn: FloatArray
    speeds: Mapping[str, float]

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "pairs", "frequency_interval", "turn")
