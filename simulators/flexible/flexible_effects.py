# SPDX-License-Identifier: MIT
"""Effects that a campaign on a flexible specimen hides, and their draws."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.flexible.flexible_specimen import BoltedSpecimen
from jointbench.simulators.flexible.joint_values import BoltValues
from jointbench.simulators.flexible.surface_nodes import along_side


@dataclass(frozen=True, slots=True)
class FlexibleEffect:
    """One hidden effect.

    Attributes:
        name: of the effect.
        where: key ``bolt``, ``channel``, ``point``, ``body``, ``axis`` or ``foot``.
        parameters: in SI units.
    """

    name: str
    where: Mapping[str, int | str] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)


_APART = 0.01
"""Spread of bolts across an axis below which they lie on it [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class DrawScales:
    """What the sizes of effects refer to.

    Attributes:
        specimen: as drawn.
        values: true values of the base.
        travel: largest relative motion at each bolt at the highest level [m], shape
            (n_bolts, 3).
        speed: largest relative velocity there [m/s], shape (n_bolts, 3).
        feet_travel: largest normal motion of each foot there [m], shape (n_feet,).
    """

    specimen: BoltedSpecimen
    values: BoltValues
    travel: FloatArray
    speed: FloatArray
    feet_travel: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "travel", "speed", "feet_travel")


Draw = Callable[[DrawScales, np.random.Generator], FlexibleEffect]


def draw_effect_of(
    name: str, scales: DrawScales, rng: np.random.Generator
) -> FlexibleEffect:
    """Draw place and size of an effect.

    Args:
        name: one of `FLEXIBLE_EFFECTS`, `MESHED_EFFECTS` or `FLEXIBLE_OUTSIDE`.
        scales: of the specimen.
        rng: source of the draws.
    """
    drawn = _EVERY[require_flexible(name)](scales, rng)
    return FlexibleEffect(name, drawn.where, drawn.parameters)


def require_flexible(name: str) -> str:
    """Return a name of an effect.

    Raises:
        UsageError: there is no such effect.
    """
    if name not in _EVERY:
        known = ", ".join(_EVERY)
        raise UsageError(f"effect {name!r} is unknown; there are {known}")
    return name


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _sign(rng: np.random.Generator) -> float:
    return float(rng.choice((-1.0, 1.0)))


def _effect(where: Mapping[str, int | str], **parameters: float) -> FlexibleEffect:
    return FlexibleEffect("", where, parameters)


def _bolt(s: DrawScales, rng: np.random.Generator) -> dict[str, int | str]:
    return {"bolt": int(rng.integers(len(s.specimen.bolts)))}


def _channel(s: DrawScales, rng: np.random.Generator) -> dict[str, int | str]:
    return {"channel": str(rng.choice([each.name for each in s.specimen.sensors]))}


def _point(s: DrawScales, rng: np.random.Generator) -> dict[str, int | str]:
    return {"point": str(rng.choice([each.name for each in s.specimen.points]))}


def _place(s: DrawScales, rng: np.random.Generator) -> dict[str, int | str]:
    return _point(s, rng) if rng.random() < 0.5 else _channel(s, rng)


def _lightest(s: DrawScales) -> float:
    return min(body.block.mass for body in s.specimen.bodies)


def _rocking(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    """Return a tilt of the joint as compliant as its bolts, to within a factor."""
    where = _tilt_axis(s, rng)
    arm = rocking_arms(s.specimen, str(where["axis"]))
    bolts = float(np.sum(arm**2 * s.values.stiffness[:, 2]))
    return _effect(where, compliance=_log(rng, 0.15, 1.0) / bolts)


def rocking_arms(specimen: BoltedSpecimen, axis: str) -> FloatArray:
    """Return the normal motion of the bolts in a unit tilt about x or y [m]."""
    bolts = np.array(specimen.bolts)
    column = 1 if axis == "x" else 0
    return np.asarray(bolts[:, column] - bolts[:, column].mean())


def _tilt_axis(s: DrawScales, rng: np.random.Generator) -> dict[str, int | str]:
    """Return an axis that the bolts do not lie on."""
    drawn = str(rng.choice(("x", "y")))
    if np.ptp(rocking_arms(s.specimen, drawn)) < _APART:
        drawn = "y" if drawn == "x" else "x"
    return {"axis": drawn}


def _micro_slip(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    """Return friction at all bolts that yields from the smallest motion on."""
    travel = float(np.median(s.travel[:, :2].max(axis=1)))
    ways = (
        {"yield_exponent": _log(rng, 0.5, 2.0)},
        {"contact_exponent": _log(rng, 1.5, 4.0)},
    )
    return _effect(
        {"bolt": "all"},
        share=float(rng.uniform(0.35, 0.8)),
        slip=travel * _log(rng, 0.3, 2.0),
        torque_exponent=float(rng.choice((0.0, 1.0))),
        **ways[int(rng.integers(len(ways)))],
    )


def _macro_slip(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    """Return friction at a bolt, or at each, that slips at the upper levels."""
    where = _bolt(s, rng)
    travel = float(s.travel[int(where["bolt"]), :2].max())
    if rng.random() < 0.4:
        where, travel = {"bolt": "all"}, float(np.median(s.travel[:, :2].max(axis=1)))
    ways = (
        {"yield_exponent": _log(rng, 3.0, 12.0)},
        {"contact_exponent": _log(rng, 1.03, 1.3)},
        {
            "bouc_wen_exponent": _log(rng, 1.5, 6.0),
            "unloading": float(rng.uniform(0.5, 0.8)),
        },
    )
    return _effect(
        where,
        share=float(rng.uniform(0.4, 0.85)),
        slip=travel * _log(rng, 0.05, 0.4),
        torque_exponent=float(rng.choice((0.0, 1.0))),
        **ways[int(rng.integers(len(ways)))],
    )


def _clearance(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    where = _bolt(s, rng)
    bolt = int(where["bolt"])
    return _effect(
        where,
        k=float(s.values.stiffness[bolt, 2]) * _log(rng, 0.5, 4.0),
        g=float(s.travel[bolt, 2]) * _log(rng, 0.03, 0.4),
    )


def _power(power: int, low: float, high: float) -> Draw:
    """Return a stiffness k r^power that is a share of the spring at the travel."""

    def draw(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
        where = _bolt(s, rng)
        bolt = int(where["bolt"])
        unit = float(s.values.stiffness[bolt, 2] / s.travel[bolt, 2] ** (power - 1))
        return _effect(where, **{f"k{power}": unit * _sign(rng) * _log(rng, low, high)})

    return draw


def _hardening(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    """Return a cubic spring, hardening: a softening one would turn over."""
    drawn = _power(3, 0.3, 3.0)(s, rng)
    return _effect(drawn.where, k3=abs(drawn.parameters["k3"]))


def _square_damping(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    where = _bolt(s, rng)
    bolt = int(where["bolt"])
    unit = float(s.values.damping[bolt, 2] / s.speed[bolt, 2])
    return _effect(where, c2=unit * _log(rng, 1.0, 8.0))


def _oscillator(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    # A bracket moves in one direction, a sensor on wax in all of them.
    moves = str(rng.choice(("normal", "all")))
    return _effect(
        _place(s, rng) | {"direction": moves},
        m=_lightest(s) * _log(rng, 0.005, 0.04),
        frequency=_log(rng, 150.0, 2500.0),
        damping_ratio=_log(rng, 0.005, 0.04),
    )


def _body(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    """Return a modulus beyond its prior; softer or stiffer."""
    body = int(rng.integers(2))
    factor = 1 + _sign(rng) * float(rng.uniform(0.12, 0.25))
    return _effect({"body": s.specimen.bodies[body].name}, factor=factor)


def _thickness(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    """Return a thickness beyond what a drawing allows for."""
    body = int(rng.integers(2))
    factor = 1 + _sign(rng) * float(rng.uniform(0.05, 0.12))
    return _effect({"body": s.specimen.bodies[body].name}, factor=factor)


def _spring(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    """Return a spring to the ground that alone lifts a body to 60 to 250 Hz."""
    mass = sum(body.block.mass for body in s.specimen.bodies)
    omega = 2 * np.pi * _log(rng, 60.0, 250.0)
    return _effect(_place(s, rng), k=mass * omega**2)


def _support(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    foot = int(rng.integers(len(s.specimen.feet)))
    return _effect({"foot": foot}, factor=_log(rng, 20.0, 200.0))


def _rattler(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    travel = float(np.median(s.travel[:, 2]))
    return _effect(
        _place(s, rng),
        m=_lightest(s) * _log(rng, 0.01, 0.04),
        g=travel * _log(rng, 0.3, 2.0),
    )


def _foot_stop(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    """Return a foot that meets a hard stop."""
    foot = int(rng.integers(len(s.specimen.feet)))
    return _effect(
        {"foot": foot},
        k=s.values.feet_stiffness * _log(rng, 30.0, 300.0),
        g=float(s.feet_travel[foot]) * _log(rng, 0.05, 0.4),
    )


def _factor(low: float, high: float, key: str, place: Draw | None = None) -> Draw:
    """Return a draw of one log-uniform parameter."""

    def draw(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
        where = place(s, rng).where if place else {"bolt": "all"}
        return _effect(where, **{key: _log(rng, low, high)})

    return draw


def _at(chosen: Callable[..., dict[str, int | str]]) -> Draw:
    return lambda s, rng: _effect(chosen(s, rng))


def _gain(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    return _effect(_channel(s, rng), g=_sign(rng) * _log(rng, 0.05, 0.4))


def _cable(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    return _effect(
        _channel(s, rng),
        frequency=_log(rng, 3000.0, 9000.0),
        damping_ratio=_log(rng, 0.02, 0.2),
    )


def _shifted(
    low: float, high: float, place: Callable[..., dict[str, int | str]]
) -> Draw:
    """Return an offset along the side of a body that does not leave it [m]."""

    def draw(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
        where = place(s, rng)
        every = (*s.specimen.points, *s.specimen.sensors)
        spot = next(each for each in every if each.name in where.values())
        body = s.specimen.bodies[spot.body]
        while True:
            size, turn = _log(rng, low, high), rng.uniform(0, 2 * np.pi)
            u, v = size * float(np.cos(turn)), size * float(np.sin(turn))
            if body.holds(along_side(body, spot, u, v)):
                return _effect(where, u=u, v=v)

    return draw


def _patch(s: DrawScales, rng: np.random.Generator) -> FlexibleEffect:
    return _effect(_tilt_axis(s, rng), slope=_sign(rng) * float(rng.uniform(0.25, 0.6)))


_CATALOGUE: Mapping[str, Draw] = MappingProxyType(
    {
        "joint_compliance_normal": _at(lambda *_: {"bolt": "all"}),
        "joint_compliance_tangential": _at(lambda *_: {"bolt": "all"}),
        "joint_compliance_rocking": _rocking,
        "loose_bolt": _factor(0.03, 0.4, "factor", _at(_bolt)),
        "microslip": _micro_slip,
        "macroslip": _macro_slip,
        "clearance": _clearance,
        "cubic": _hardening,
        "quadratic": _power(2, 0.05, 0.2),
        "preload_stiffness": _factor(0.25, 0.7, "n"),
        "preload_damping": lambda s, rng: _effect(
            {"bolt": "all"}, n=_sign(rng) * _log(rng, 0.5, 1.2)
        ),
        "contact_patch": _patch,
        "damping_law": _square_damping,
        "added_mass": lambda s, rng: _effect(
            _place(s, rng), m=_lightest(s) * _log(rng, 0.01, 0.08)
        ),
        "added_stiffness": _spring,
        "hidden_mode": _oscillator,
        "modulus": _body,
        "support": _support,
        "gain_error": _gain,
        "delay": _factor(8e-6, 8e-5, "tau", _at(_channel)),
        "polarity": _at(_channel),
        "cable_resonance": _cable,
        "cross_axis": _factor(0.05, 0.2, "share", _at(_channel)),
        "wrong_position": _shifted(0.015, 0.05, _channel),
        "wrong_direction": _factor(0.15, 0.6, "angle", _at(_channel)),
        "wrong_hit_point": _shifted(0.01, 0.03, _point),
    }
)
_OUTSIDE: Mapping[str, Draw] = MappingProxyType(
    {
        "rattling_mass": _rattler,
        "thermal_drift": lambda s, rng: _effect(
            {"bolt": "all"}, rise=_sign(rng) * float(rng.uniform(0.15, 0.4))
        ),
        "soft_clipping": lambda s, rng: _effect(
            _channel(s, rng), share=_log(rng, 0.3, 1.0)
        ),
        "foot_stop": _foot_stop,
    }
)
_MESHED: Mapping[str, Draw] = MappingProxyType({"thickness": _thickness})
_EVERY: Mapping[str, Draw] = MappingProxyType({**_CATALOGUE, **_MESHED, **_OUTSIDE})
FLEXIBLE_EFFECTS = tuple(_CATALOGUE)
"""Effects that hits can show and a catalogue can name."""
FLEXIBLE_OUTSIDE = tuple(_OUTSIDE)
"""Effects that no catalogue has."""
