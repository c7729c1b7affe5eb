# SPDX-License-Identifier: MIT
"""Estimates on flexible bodies beside their true values, and loops of bolts."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

Json = dict[str, Any]
_OWN_NAMES = {
    ("gain_error", "g"): "gain",
    ("hidden_mode", "frequency"): "f",
    ("hidden_mode", "damping_ratio"): "zeta",
}
"""Names of parameters that the engine reports in other words than the truth."""
_UNSIGNED = {"share", "angle"}
"""A turned sensor has a size and an azimuth, and either may carry the sign."""
_SLIDERS = 400
"""Sliders of an Iwan element in a loop."""
_AMPLITUDES = (0.1, 0.3, 1.0)
"""Of a loop over the largest slip displacement, or over the reach of a law."""


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

    Of friction, the energy of a cycle; of the others, the largest force. Each at three
    amplitudes up to the slip displacement, or to three times the gap.

    Returns:
        None if the effect is no law.
    """
    (effect,) = run["found"]["effects"]
    name, true = effect["name"], run["truth"]["effects"][effect["name"]]
    found = {k: float(v["value"]) for k, v in effect["parameters"].items()}
    errors = []
    for share in _AMPLITUDES:
        pair = [_loop(name, values, share, true) for values in (found, true)]
        if pair[1] is None:
            return None
        if pair[1] > 0:
            errors.append(abs(float(pair[0] or 0.0) / pair[1] - 1.0))
    return max(errors, default=None)


def _loop(
    name: str, values: Mapping[str, float], share: float, true: Mapping[str, float]
) -> float | None:
    match name:
        case "microslip":
            amplitude = share * true["phimax"]
            return values["share"] * _slip_energy(values, amplitude)
        case "macroslip":
            amplitude, slip = 10.0 * share * true["slip"], values["slip"]
            return values["share"] * slip * max(amplitude - slip, 0.0)
        case "clearance":
            return values["k"] * max(3.0 * share * true["g"] - values["g"], 0.0)
        case "cubic" | "quadratic" | "damping_law":
            (key,) = true
            return abs(values[key])
    return None


def _slip_energy(values: Mapping[str, float], amplitude: float) -> float:
    """Return the energy of a cycle over 4 k of an Iwan element (Segalman 2005)."""
    onset = values.get("onset", 0.0) * values["phimax"]
    edges = np.linspace(0.0, values["phimax"], _SLIDERS + 1)
    middle = np.maximum(0.5 * (edges[1:] + edges[:-1]), onset)
    power = values["chi"] + 2.0
    weight = np.diff(edges**power)
    weight /= weight.sum()
    return float(np.sum(weight * middle * np.maximum(amplitude - middle, 0.0)))
