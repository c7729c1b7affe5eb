# SPDX-License-Identifier: MIT
"""Measured stiffness and damping of a joint over its preload, as plain records."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.array_checks import require_finite, require_shape
from jointbench.acquisition.basics.arrays import (
    BoolArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.acquisition.basics.errors import BadData


class ContactQuantity(StrEnum):
    """What is measured of a joint: the key of a file."""

    NORMAL = "kn"
    TANGENTIAL = "kt"
    TANGENTIAL_2 = "kt2"
    ROCKING = "kr"
    NORMAL_DAMPING = "cn"
    TANGENTIAL_DAMPING = "ct"


QUANTITIES = tuple(ContactQuantity)
STIFFNESSES = QUANTITIES[:4]
UNITS = ("N/m", "N/m", "N/m", "N m/rad", "N s/m", "N s/m")


@dataclass(frozen=True, slots=True, eq=False)
class JointStates:
    """States of a joint in the order in which they were set.

    Attributes:
        torque: on each bolt [N m]; NaN where only the preload is known, (n_states,).
        preload: measured by washer or elongation [N]; NaN where it is not.
        preload_sd: relative standard deviation of a measured preload [-].
        assembly: number of the assembly, from 0.
        falling: whether the joint came from a higher preload of the same assembly.
        time: since tightening [s]; NaN where it is not known.
        shear: amplitude of the tangential force during the measurement [N], or NaN.
        frequency: of the vibration that gives the damping [Hz], or NaN.
        setting: number of the setting of the preload that a state belongs to, from 0
            without gaps; None where the preload is set for every state.
    """

    torque: FloatArray
    preload: FloatArray
    preload_sd: FloatArray
    assembly: IntArray
    falling: BoolArray
    time: FloatArray
    shear: FloatArray
    frequency: FloatArray
    setting: IntArray | None = None

    def __post_init__(self) -> None:
        """Check shapes and the presence of a torque or preload in each state."""
        n = len(self.torque)
        for name in ("preload", "preload_sd", "assembly", "falling", "time", "shear"):
            require_shape(name, getattr(self, name), (n,))
        require_shape("frequency", self.frequency, (n,))
        if self.setting is not None:
            require_shape("setting", self.setting, (n,))
            freeze(self, "setting")
        lost = np.flatnonzero(np.isnan(self.torque) & np.isnan(self.preload))
        if lost.size:
            raise BadData(
                f"state {lost[0] + 1} has neither a torque nor a preload; give one, "
                "e.g. torque = '20 N m'"
            )
        for name in ("torque", "preload"):
            if np.any(getattr(self, name) <= 0):
                raise BadData(f"a {name} is not positive; leave unloaded states out")
        freeze(self, "torque", "preload", "preload_sd", "assembly", "falling")
        freeze(self, "time", "shear", "frequency")

    @property
    def settings(self) -> IntArray:
        """Number of the setting of the preload of each state, shape (n_states,)."""
        if self.setting is None:
            return np.arange(len(self.torque))
        return self.setting

    @property
    def several_forces(self) -> bool:
        """Whether tangential forces of different size act in one setting."""
        known = np.isfinite(self.shear)
        pairs = np.column_stack([self.settings, self.shear])[known]
        return len(np.unique(pairs, axis=0)) > len(np.unique(pairs[:, 0]))

    @property
    def by_torque(self) -> BoolArray:
        """States whose preload follows from the torque, shape (n_states,)."""
        return np.isnan(self.preload)

    @property
    def level(self) -> FloatArray:
        """Torque [N m], or preload [N] where no torque is known, shape (n_states,)."""
        return np.where(np.isnan(self.torque), self.preload, self.torque)


@dataclass(frozen=True, slots=True, eq=False)
class JointRows:
    """Measured values of the states.

    Attributes:
        state: index of the state of each value, shape (n_rows,).
        quantity: index into `QUANTITIES`, same shape.
        value: natural logarithm of the value in SI units, same shape.
        covariance: of the logarithms, shape (n_rows, n_rows).
        bound: True where the value is only known to be larger, at 95 %, (n_rows,).
    """

    state: IntArray
    quantity: IntArray
    value: FloatArray
    covariance: FloatArray
    bound: BoolArray

    def __post_init__(self) -> None:
        """Check shapes, numbers and that the covariance is positive definite."""
        n = len(self.state)
        require_shape("quantity", self.quantity, (n,))
        require_shape("value", self.value, (n,))
        require_shape("bound", self.bound, (n,))
        require_shape("covariance", self.covariance, (n, n))
        require_finite("value", self.value)
        require_finite("covariance", self.covariance)
        smallest = np.linalg.eigvalsh(self.covariance)[0] if n else 1.0
        if not smallest > 0:
            raise BadData(
                "the covariance of the joint values is not positive definite; check "
                "that no sd is 0 and no correlation reaches 1"
            )
        freeze(self, "state", "quantity", "value", "covariance", "bound")

    def chosen(self, keep: BoolArray) -> "JointRows":
        """Return some of the rows; `keep` has shape (n_rows,)."""
        return JointRows(
            self.state[keep],
            self.quantity[keep],
            self.value[keep],
            self.covariance[np.ix_(keep, keep)],
            self.bound[keep],
        )


@dataclass(frozen=True, slots=True)
class JointFacts:
    """What is known of a bolted joint beside its measured values.

    Attributes:
        bolts: number.
        diameter: nominal, of the bolts [m].
        nut_factor: K in P = n T/(K d) [-].
        nut_factor_sd: relative sd of its mean [-].
        torque_scatter: relative sd of the preload from one tightening to the next [-].
        reassembly: relative sd of the stiffness from one assembly to the next [-].
        area: apparent area of the contact surface [m^2].
        modulus: composite modulus E* [Pa].
        poisson: Poisson ratio of the bodies [-].
        rocking_radius: radius of gyration of the contact surface about the rocking
            axis [m]; used with rocking stiffness only.
        bolt_radius: that of the pressure cones [m].
        cone_radius: radius of one pressure cone at the contact surface [m], or None.
        bolt_stiffness: of all bolts along their axes, in parallel with the contact
            [N/m]; None where their length is not stated.
    """

    bolts: int
    diameter: float
    nut_factor: float
    nut_factor_sd: float
    torque_scatter: float
    reassembly: float
    area: float
    modulus: float
    poisson: float
    rocking_radius: float | None = None
    bolt_radius: float | None = None
    cone_radius: float | None = None
    bolt_stiffness: float | None = None

    def __post_init__(self) -> None:
        """Check that every number is possible."""
        for name in ("bolts", "diameter", "nut_factor", "area", "modulus"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise BadData(f"{name} is {value:g}; it must be positive, in SI units")


@dataclass(frozen=True, slots=True, eq=False)
class JointData:
    """Everything that was measured of a joint, with what is known of it."""

    name: str
    facts: JointFacts
    states: JointStates
    rows: JointRows

    def measures(self, *quantities: ContactQuantity) -> bool:
        """Return whether one of the quantities was measured."""
        wanted = [QUANTITIES.index(q) for q in quantities]
        return bool(np.isin(self.rows.quantity, wanted).any())

    @property
    def nominal_log_preload(self) -> FloatArray:
        """Ln of the preload by measurement or nominal nut factor [ln N]."""
        f = self.facts
        by_torque = f.bolts * self.states.torque / (f.nut_factor * f.diameter)
        measured = np.where(self.states.by_torque, by_torque, self.states.preload)
        return np.asarray(np.log(measured))

    @property
    def log_overload(self) -> FloatArray:
        """Ln of the highest earlier preload of the assembly over that of a state.

        Zero where the state is the highest so far; shape (n_states,).
        """
        log_p, found = self.nominal_log_preload, np.zeros(len(self.states.torque))
        for j in np.unique(self.states.assembly):
            own = np.flatnonzero(self.states.assembly == j)
            highest = np.maximum.accumulate(log_p[own])
            # A state said to fall did so even if scatter of the torque hides it.
            found[own] = np.where(
                self.states.falling[own], np.maximum(highest - log_p[own], 0.0), 0.0
            )
        return found
