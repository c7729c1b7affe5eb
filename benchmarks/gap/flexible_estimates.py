# SPDX-License-Identifier: MIT
"""Estimates on flexible bodies beside their true values, and loops of bolts."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from jointbench.analysis.gap.structure_response.port_laws import iwan_sliders

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
_FINE = 1e-3
"""Onset of the true micro-slip: its smallest sliders are far below any motion."""


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

    Of friction, the energy of a cycle at three amplitudes up to the largest slip
    displacement, in shares of the spring; of a stop, the largest force up to three
    times its gap; of the other laws, their coefficient.

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
    if name == "microslip":
        slips, weights = iwan_sliders(
            values["phimax"], values["chi"] + 2.0, values.get("onset", _FINE)
        )
        beyond = np.maximum(share * true["phimax"] - slips, 0.0)
        return float(values["share"] * np.sum(weights * slips * beyond))
    if name == "macroslip":
        beyond_slip = max(10.0 * share * true["slip"] - values["slip"], 0.0)
        return values["share"] * values["slip"] * beyond_slip
    if name == "clearance":
        return values["k"] * max(3.0 * share * true["g"] - values["g"], 0.0)
    return abs(values[_POWERS[name]])
