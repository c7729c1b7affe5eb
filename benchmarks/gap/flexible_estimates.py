# SPDX-License-Identifier: MIT
"""Estimates on flexible bodies beside their true values, and loops of bolts."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from jointbench.analysis.gap.structure_response.port_laws import spread_sliders
from jointbench.simulators.flexible.friction_and_stops import (
    BoltLaw,
    PortLawKind,
    forces_along,
)
from jointbench.simulators.flexible.hidden_in_joint import friction_numbers

Json = dict[str, Any]
_OWN_NAMES = {
    ("gain_error", "g"): "gain",
    ("hidden_mode", "frequency"): "f",
    ("hidden_mode", "damping_ratio"): "zeta",
}
"""Names of parameters that the engine reports in other words than the truth."""
_UNSIGNED = {"share", "angle"}
"""A turned sensor has a size and an azimuth, and either may carry the sign."""
_POWERS = {"cubic": "k3", "quadratic": "k2", "damping_law": "c2"}
"""Coefficients of laws without a further parameter."""
_AMPLITUDES = (0.3, 0.6, 1.0)
"""Of a loop, over the largest slip displacement or over the reach of a law."""
_REACH = {"microslip": 2.0, "macroslip": 10.0}
"""Amplitude of the widest loop of friction, over the true slip displacement."""
_TURNS, _POINTS = 4, 400
"""Cycles after which a loop is closed, and points of a cycle."""


def effect_pairs(run: Json) -> Iterator[tuple[str, float, float, float]]:
    """Yield each parameter of a right effect: name, estimate, sd and true value."""
    for effect in run["found"]["effects"]:
        true = run["truth"]["effects"].get(effect["name"], {})
        found = effect["parameters"]
        for key, value in true.items():
            own = _OWN_NAMES.get((effect["name"], key), key)
            if own not in found:
                continue
            one = found[own]
            near, far = float(one["value"]), float(value)
            if effect["name"] in {"cross_axis", "wrong_direction"} and own in _UNSIGNED:
                near, far = abs(near), abs(far)
            yield f"{effect['name']} {own}", near, float(one["sd"]), far


def base_pairs(run: Json) -> Iterator[tuple[str, float, float, float]]:
    """Yield each base parameter: name, estimate, sd and true value.

    Masses are left out: the bodies were weighed, and the estimate is the prior.
    """
    true = true_base(run["truth"]["physical"])
    for name, one in (run["found"]["base"] or {}).items():
        if name in true:
            yield name, float(one["value"]), float(one["sd"]), true[name]


def true_base(physical: Mapping[str, Any]) -> dict[str, float]:
    """Return the true values of the base parameters by their names."""
    stiffness = np.log(np.array(physical["bolt_stiffness"], dtype=float))
    damping = np.exp(np.log(np.array(physical["bolt_damping"])).mean(axis=0))
    found = {
        "modulus bottom": float(physical["E0"]),
        "modulus top": float(physical["E1"]),
        "damping ratio bottom": float(physical["zeta0"]),
        "damping ratio top": float(physical["zeta1"]),
        "bolt damping tangential": float(damping[0]),
        "bolt damping normal": float(damping[2]),
        "foot stiffness": float(physical["kf"]),
        "foot damping": float(physical["cf"]),
    }
    for axis, name in enumerate("xyz"):
        if np.all(np.isfinite(stiffness[:, axis])):
            found[f"bolt stiffness {name}"] = float(np.exp(stiffness[:, axis].mean()))
    bolts = stiffness[:, 2] - stiffness[:, 2].mean()
    for k in range(1, len(bolts)):
        column = np.zeros(len(bolts))
        column[:k], column[k] = 1.0, -k
        value = float(column @ bolts / np.linalg.norm(column))
        found[f"bolt contrast {k}"] = float(np.exp(value))
    return found


def loop_error(run: Json) -> float | None:
    """Return the largest relative error of the loops of a right law at a bolt.

    Of friction, the energy of a cycle at three amplitudes, in shares of the spring; of
    a stop, the largest force up to three times its gap; of the other laws, their
    coefficient.

    Returns:
        None if the effect is no law.
    """
    (effect,) = run["found"]["effects"]
    name, true = effect["name"], run["truth"]["effects"][effect["name"]]
    found = {k: float(v["value"]) for k, v in effect["parameters"].items()}
    if name not in {"microslip", "macroslip", "clearance", *_POWERS}:
        return None
    errors = []
    for share in _AMPLITUDES:
        near, far = (_loop(name, values, share, true) for values in (found, true))
        if far > 0.0:
            errors.append(abs(near / far - 1.0))
    return max(errors)


def _loop(
    name: str, values: Mapping[str, float], share: float, true: Mapping[str, float]
) -> float:
    """Return the energy of a cycle of friction, or the force of another law."""
    if name in _REACH:
        amplitude = _REACH[name] * share * true["slip"]
        if "early" not in values:
            return _true_cycle(values, amplitude)
        return values["share"] * _cycle(values, amplitude)
    if name == "clearance":
        return values["k"] * max(3.0 * share * true["g"] - values["g"], 0.0)
    return abs(values[_POWERS[name]])


def _true_cycle(true: Mapping[str, float], amplitude: float) -> float:
    """Return the energy of a cycle of the simulated law, over the spring [m^2]."""
    law = BoltLaw(PortLawKind.FRICTION, np.ones(1), friction_numbers(true, 1.0, 1.0))
    turns = np.linspace(0.0, 2.0 * np.pi * _TURNS, _POINTS * _TURNS + 1)
    path = amplitude * np.sin(turns)
    last = slice(-_POINTS - 1, None)
    force, motion = (forces_along(law, path) + true["share"] * path)[last], path[last]
    return float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(motion)))


def _cycle(found: Mapping[str, float], amplitude: float) -> float:
    """Return the energy of a cycle of the sliders found, over their spring [m^2].

    Of a gradual one, which unloads by F along its spring and then follows tanh over
    2 A - F, with F = tanh (2 A - F), it is 2 ln cosh (2 A - F) - F^2.
    """
    shape = found["early"], found["tail"]
    slips, weights = spread_sliders(found["slip"], *shape)
    gradual = found.get("gradual", 0.0)
    sharp = 4.0 * float(weights @ (slips * np.maximum(amplitude - slips, 0.0)))
    way, force = 2.0 * amplitude / found["slip"], 0.0
    for _ in range(200):
        force = 0.5 * (force + float(np.tanh(way - force)))
    smooth = found["slip"] ** 2 * (2.0 * np.log(np.cosh(way - force)) - force**2)
    return (1.0 - gradual) * sharp + gradual * float(smooth)
