# SPDX-License-Identifier: MIT
"""State of the model of bolted bodies: the values of all its parameters.

Directions at the bolts are held as compliances, so that a rigid direction is exactly
zero and an effect that makes it compliant starts from zero with a finite slope.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.structure_response.base_layout import (
    BaseLayout,
    BaseName,
    loss_name,
    mass_name,
    modulus_name,
    stiffness_name,
)
from jointbench.analysis.gap.structure_response.jointed_bodies import (
    NORMAL,
    HitPoint,
    JointedBodies,
    NominalBench,
)
from jointbench.analysis.gap.structure_response.port_laws import PortLaws
from jointbench.analysis.gap.structure_response.tuned_modes import TunedStiffness


@dataclass(frozen=True, slots=True)
class Attached:
    """Something attached at a place.

    Attributes:
        place: index of the place.
        mass: [kg].
        frequency: of the oscillator [Hz]; None for a rigid mass.
        damping: ratio of the oscillator [-].
        stiffness: of a spring to the ground [N/m].
        normal: True if it moves along the direction of its hit or sensor only.
    """

    place: int
    mass: float
    frequency: float | None = None
    damping: float = 0.0
    stiffness: float = 0.0
    normal: bool = False

    def rows(self, bodies: JointedBodies) -> FloatArray:
        """Return the motion of its place, shape (n_directions, n_modes)."""
        place = bodies.places[self.place]
        return place.normal if self.normal else place.rows


@dataclass(frozen=True, slots=True)
class CableResonance:
    """Low pass of second order in the signal of a channel.

    Attributes:
        channel: index of the channel.
        period: over 2 pi [s]; 0 is no low pass.
        damping: ratio [-].
    """

    channel: int
    period: float
    damping: float


@dataclass(frozen=True, slots=True, eq=False)
class JointState:
    """Values of all parameters of the model.

    Attributes:
        modulus: factor on the modulus of each body [-].
        mass: factor on the mass of each body [-].
        loss: damping ratio of the free modes of each body [-].
        compliance: of a bolt along x, y, z [m/N]; 0 if rigid, shape (3,).
        damping: of a bolt along x, y, z [N s/m], shape (3,).
        bolt: factor on stiffness and damping of each bolt [-], shape (n_bolts,).
        foot: stiffness [N/m] and damping [N s/m] of each foot.
        exponent: power of stiffness and damping of the bolts in their torque [-].
        damping_exponent: further power of their damping in the torque [-].
        foot_factor: on the stiffness of each foot [-], shape (n_feet,).
        rocking: compliance of the joint that couples the normal directions of the
            bolts [m/N], shape (n_bolts, n_bolts); None for none.
        sensors: motion along each sensor, shape (n_channels, n_modes); None for that
            of the bodies.
        points: hammer points; None for those of the bodies.
        cables: resonances in the signals of channels.
        tuned: closed modes at other frequencies than the model gives; None for none.
        attached: masses and oscillators.
        gain: relative gain of each channel less 1 [-], shape (n_channels,).
        lag: of each channel [s], shape (n_channels,).
        laws: nonlinear laws at the bolts.
        bodies: in the place of those of the campaign; None for these.
    """

    modulus: FloatArray
    mass: FloatArray
    loss: FloatArray
    compliance: FloatArray
    damping: FloatArray
    bolt: FloatArray
    foot: tuple[float, float]
    gain: FloatArray
    lag: FloatArray
    foot_factor: FloatArray
    exponent: float = 0.0
    damping_exponent: float = 0.0
    rocking: FloatArray | None = None
    sensors: FloatArray | None = None
    points: tuple[HitPoint, ...] | None = None
    cables: tuple[CableResonance, ...] = ()
    attached: tuple[Attached, ...] = ()
    laws: tuple[PortLaws, ...] = ()
    bodies: JointedBodies | None = None
    tuned: TunedStiffness | None = None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "modulus", "mass", "loss", "compliance", "damping", "bolt")
        freeze(self, "gain", "lag", "foot_factor")

    def omega(self, bodies: JointedBodies) -> FloatArray:
        """Return the natural angular frequencies of the free modes [rad/s]."""
        root = np.sqrt(self.modulus)[bodies.body]
        return np.asarray(bodies.omega * root)

    def bodies_of(self, bodies: JointedBodies) -> JointedBodies:
        """Return the bodies as they are in this state."""
        return bodies if self.bodies is None else self.bodies

    def sensors_of(self, bodies: JointedBodies) -> FloatArray:
        """Return the motion along each sensor, shape (n_channels, n_modes)."""
        return bodies.sensors if self.sensors is None else self.sensors

    def points_of(self, bodies: JointedBodies) -> tuple[HitPoint, ...]:
        """Return the hammer points where hits aim."""
        return bodies.points if self.points is None else self.points

    def at_torque(self, ratio: float) -> "JointState":
        """Return the state with the damping of a torque.

        Args:
            ratio: torque over the reference one [-].
        """
        if self.damping_exponent == 0.0:
            return self
        return replace(self, damping=self.damping * ratio**self.damping_exponent)


def state_of(
    bodies: JointedBodies, nominal: NominalBench, layout: BaseLayout, base: FloatArray
) -> JointState:
    """Return the state at base coordinates, without any effect."""
    factor = dict(zip(layout.names, np.exp(base), strict=True))
    compliance = np.zeros(3)
    for d in layout.compliant:
        compliance[d] = 1.0 / (nominal.stiffness[d] * factor[stiffness_name(d)])
    across = factor[BaseName.TANGENTIAL_DAMPING]
    along = factor[BaseName.NORMAL_DAMPING]
    foot = factor[BaseName.FOOT], factor[BaseName.FOOT_DAMPING]
    channels = len(bodies.channels)
    tuned = None
    if layout.tuned is not None:
        own = [layout.at(name) for name in layout.tuned.names]
        tuned = layout.tuned.stiffness_at(base[own])
    contrast = base[layout.sd.size - layout.contrasts.shape[1] :]
    return JointState(
        modulus=np.array([factor[modulus_name(b)] for b in bodies.bodies]),
        mass=np.array([factor[mass_name(b)] for b in bodies.bodies]),
        loss=nominal.loss[0] * np.array([factor[loss_name(b)] for b in bodies.bodies]),
        compliance=compliance,
        damping=nominal.damping * np.array([across, across, along]),
        bolt=np.exp(layout.contrasts @ contrast),
        foot=(nominal.foot[0] * foot[0], nominal.foot[1] * foot[1]),
        gain=np.zeros(channels),
        lag=np.zeros(channels),
        foot_factor=np.ones(len(bodies.feet)),
        tuned=tuned,
    )


def base_values(
    bodies: JointedBodies, nominal: NominalBench, layout: BaseLayout, base: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the value of each coordinate in its unit, and its slope, (n_base,)."""
    known: dict[str, float] = {
        BaseName.TANGENTIAL_DAMPING: float(nominal.damping[0]),
        BaseName.NORMAL_DAMPING: float(nominal.damping[NORMAL]),
        BaseName.FOOT: nominal.foot[0],
        BaseName.FOOT_DAMPING: nominal.foot[1],
    }
    known |= {loss_name(b): nominal.loss[0] for b in bodies.bodies}
    known |= {stiffness_name(d): float(nominal.stiffness[d]) for d in layout.compliant}
    values = np.array([known.get(name, 1.0) for name in layout.names]) * np.exp(base)
    slopes = values.copy()
    values[layout.couplings], slopes[layout.couplings] = base[layout.couplings], 1.0
    return values, slopes
