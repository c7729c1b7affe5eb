# SPDX-License-Identifier: MIT
"""Parameters of bolted bodies: base coordinates with priors, and the state they give.

Directions at the bolts are held as compliances, so that a rigid direction is exactly
zero and an effect that makes it compliant starts from zero with a finite slope.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.structure_bench.jointed_bodies import (
    DIRECTIONS,
    NORMAL,
    JointedBodies,
    NominalBench,
)
from jointbench.analysis.gap.structure_bench.port_laws import PortLaws


@dataclass(frozen=True, slots=True)
class Attached:
    """Something attached at a place.

    Attributes:
        place: index of the place.
        mass: [kg].
        frequency: of the oscillator [Hz]; None for a rigid mass.
        damping: ratio of the oscillator [-].
    """

    place: int
    mass: float
    frequency: float | None = None
    damping: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class JointState:
    """Values of all parameters of the model.

    Attributes:
        modulus: factor on the modulus of each body [-].
        mass: factor on the mass of each body [-].
        loss: damping ratio of the free modes [-].
        compliance: of a bolt along x, y, z [m/N]; 0 if rigid, shape (3,).
        damping: of a bolt along x, y, z [N s/m], shape (3,).
        bolt: factor on stiffness and damping of each bolt [-], shape (n_bolts,).
        foot: stiffness [N/m] and damping [N s/m] of each foot.
        exponent: power of stiffness and damping of the bolts in their torque [-].
        attached: masses and oscillators.
        gain: relative gain of each channel less 1 [-], shape (n_channels,).
        delay: of each channel [s], shape (n_channels,).
        laws: nonlinear laws at the bolts, or None.
    """

    modulus: FloatArray
    mass: FloatArray
    loss: float
    compliance: FloatArray
    damping: FloatArray
    bolt: FloatArray
    foot: tuple[float, float]
    gain: FloatArray
    delay: FloatArray
    exponent: float = 0.0
    attached: tuple[Attached, ...] = ()
    laws: PortLaws | None = None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "modulus", "mass", "compliance", "damping", "bolt")
        freeze(self, "gain", "delay")


@dataclass(frozen=True, slots=True, eq=False)
class BaseLayout:
    """Order of the base coordinates; each is the log of a value over its nominal one.

    Attributes:
        names: of the coordinates.
        sd: of their priors [-], shape (n_base,).
        units: of the values.
        compliant: directions with a stiffness coordinate, in its order.
        contrasts: log factors of the bolts over the bolt coordinates,
            shape (n_bolts, n_bolts - 1).
    """

    names: tuple[str, ...]
    sd: FloatArray
    units: tuple[str, ...]
    compliant: tuple[int, ...]
    contrasts: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "sd", "contrasts")

    def at(self, name: str) -> int:
        """Return the index of a coordinate."""
        return self.names.index(name)


TANGENTIAL_DAMPING, NORMAL_DAMPING = "bolt damping tangential", "bolt damping normal"
LOSS, FOOT, FOOT_DAMPING = "damping ratio", "foot stiffness", "foot damping"


def stiffness_name(direction: int) -> str:
    """Return the name of the stiffness coordinate of a direction."""
    return f"bolt stiffness {DIRECTIONS[direction]}"


def modulus_name(body: str) -> str:
    """Return the name of the modulus coordinate of a body."""
    return f"modulus {body}"


def mass_name(body: str) -> str:
    """Return the name of the mass coordinate of a body."""
    return f"mass {body}"


def bolt_name(number: int) -> str:
    """Return the name of a coordinate of differences between bolts."""
    return f"bolt contrast {number}"


def base_layout(bodies: JointedBodies, nominal: NominalBench) -> BaseLayout:
    """Return the base coordinates with their priors.

    The scatter from bolt to bolt enters as contrasts, orthogonal to the mean: a factor
    common to all bolts is a scale of their stiffness and damping.
    """
    count = bodies.bolts.shape[0]
    compliant = tuple(d for d in range(3) if not bodies.rigid[d])
    common = float(np.hypot(nominal.stiffness_sd, nominal.bolt_sd / np.sqrt(count)))
    rows: list[tuple[str, float, str]] = []
    rows += [(modulus_name(b), nominal.modulus_sd, "-") for b in bodies.bodies]
    rows += [(mass_name(b), nominal.mass_sd, "-") for b in bodies.bodies]
    rows.append((LOSS, nominal.loss[1], "-"))
    rows += [(stiffness_name(d), common, "N/m") for d in compliant]
    rows.append((TANGENTIAL_DAMPING, nominal.damping_sd, "N s/m"))
    rows.append((NORMAL_DAMPING, nominal.damping_sd, "N s/m"))
    rows.append((FOOT, nominal.foot_sd[0], "N/m"))
    rows.append((FOOT_DAMPING, nominal.foot_sd[1], "N s/m"))
    rows += [(bolt_name(k + 1), nominal.bolt_sd, "-") for k in range(count - 1)]
    names, sd, units = zip(*rows, strict=True)
    return BaseLayout(names, np.array(sd), units, compliant, _contrasts(count))


def _contrasts(count: int) -> FloatArray:
    """Return orthonormal contrasts (Helmert), shape (count, count - 1)."""
    columns = np.zeros((count, count - 1))
    for k in range(1, count):
        columns[:k, k - 1] = 1.0
        columns[k, k - 1] = -k
    return np.asarray(columns / np.linalg.norm(columns, axis=0))


def state_of(
    bodies: JointedBodies, nominal: NominalBench, layout: BaseLayout, base: FloatArray
) -> JointState:
    """Return the state at base coordinates, without any effect."""
    factor = dict(zip(layout.names, np.exp(base), strict=True))
    compliance = np.zeros(3)
    for d in layout.compliant:
        compliance[d] = 1.0 / (nominal.stiffness[d] * factor[stiffness_name(d)])
    across = factor[TANGENTIAL_DAMPING]
    damping = nominal.damping * np.array([across, across, factor[NORMAL_DAMPING]])
    channels = len(bodies.channels)
    contrast = base[layout.sd.size - layout.contrasts.shape[1] :]
    return JointState(
        modulus=np.array([factor[modulus_name(b)] for b in bodies.bodies]),
        mass=np.array([factor[mass_name(b)] for b in bodies.bodies]),
        loss=nominal.loss[0] * factor[LOSS],
        compliance=compliance,
        damping=damping,
        bolt=np.exp(layout.contrasts @ contrast),
        foot=(nominal.foot[0] * factor[FOOT], nominal.foot[1] * factor[FOOT_DAMPING]),
        gain=np.zeros(channels),
        delay=np.zeros(channels),
    )


def nominal_values(
    bodies: JointedBodies, nominal: NominalBench, layout: BaseLayout
) -> FloatArray:
    """Return the value of each coordinate at 0, in its unit."""
    known = {
        LOSS: nominal.loss[0],
        TANGENTIAL_DAMPING: float(nominal.damping[0]),
        NORMAL_DAMPING: float(nominal.damping[NORMAL]),
        FOOT: nominal.foot[0],
        FOOT_DAMPING: nominal.foot[1],
    }
    known |= {stiffness_name(d): float(nominal.stiffness[d]) for d in layout.compliant}
    return np.array([known.get(name, 1.0) for name in layout.names])
