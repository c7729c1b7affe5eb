# SPDX-License-Identifier: MIT
"""Force laws of links in continuous time, written independently for the second route.

Nothing here is shared with the compiled time integration: a law gives its force and the
rates of its own states at one instant, and `motion` integrates.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.response.curve_integration import GRADE
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.effect_hooks import Law
from jointbench.analysis.gap.response.law_forces import CURVES
from jointbench.analysis.gap.second_method.second_method_settings import (
    SECOND_METHOD,
)


@dataclass(frozen=True, slots=True)
class ContinuousLaw:
    """A force law that may own states.

    Attributes:
        states: how many states it owns in each record.
        force: from elongation [m], its rate [m/s] and the states to the force [N];
            shapes (...), (...), (..., states) to (...).
        rate: from the same to the rates of the states [1/s], shape (..., states).
    """

    states: int
    force: Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
    rate: Callable[[FloatArray, FloatArray, FloatArray], FloatArray]


Values = Mapping[str, float]


def _without_states(
    force: Callable[[FloatArray, FloatArray], FloatArray],
) -> ContinuousLaw:
    return ContinuousLaw(0, lambda r, v, z: force(r, v), lambda r, v, z: z)


def _cubic(p: Values) -> ContinuousLaw:
    return _without_states(lambda r, v: p["k3"] * r**3)


def _quadratic(p: Values) -> ContinuousLaw:
    return _without_states(lambda r, v: p["k2"] * r**2)


def _gap(p: Values) -> ContinuousLaw:
    return _without_states(lambda r, v: p["k"] * np.maximum(r - p["g"], 0.0))


def _coulomb(p: Values) -> ContinuousLaw:
    return _without_states(lambda r, v: p["Fc"] * np.tanh(v / p["width"]))


def _quadratic_damping(p: Values) -> ContinuousLaw:
    return _without_states(lambda r, v: p["c"] * v * np.abs(v))


def _maxwell(p: Values) -> ContinuousLaw:
    """Spring and dashpot in series: the state is the force of both."""
    return ContinuousLaw(
        1,
        lambda r, v, z: z[..., 0],
        lambda r, v, z: p["k"] * v[..., None] - z / p["tau"],
    )


def _bouc_wen_law(
    stiffness: FloatArray, slip: FloatArray, b: float, g: float, n: float
) -> ContinuousLaw:
    """Sliders that take their stiffness from the link they sit in.

    A state is the displacement of a slider over its slip displacement.

    Source:
        Wen 1976, J. Eng. Mech. Div. 102, eq. (2).
    """

    def force(r: FloatArray, v: FloatArray, z: FloatArray) -> FloatArray:
        return np.asarray(np.sum(stiffness * (slip * z - r[..., None]), axis=-1))

    def rate(r: FloatArray, v: FloatArray, z: FloatArray) -> FloatArray:
        speed = v[..., None] / slip
        bend = b * np.sign(speed * z) + g
        return np.asarray(speed * (1.0 - bend * np.abs(z) ** n))

    return ContinuousLaw(slip.size, force, rate)


def _one(value: float) -> FloatArray:
    return np.array([value])


def _jenkins(p: Values) -> ContinuousLaw:
    return _bouc_wen_law(_one(p["kt"]), _one(p["slip"]), 0.5, 0.5, p["sharpness"])


def _bouc_wen(p: Values) -> ContinuousLaw:
    b, g = (1.0 + p["unloading"]) / 2.0, (1.0 - p["unloading"]) / 2.0
    return _bouc_wen_law(_one(p["k"]), _one(p["zy"]), b, g, p["n"])


def _bouc_wen_free(p: Values) -> ContinuousLaw:
    loading, unloading = np.cos(p["angle"]), np.sin(p["angle"])
    b, g = (loading + unloading) / 2.0, (loading - unloading) / 2.0
    return _bouc_wen_law(_one(p["k"]), _one(p["zy"]), b, g, p["n"])


def _iwan_segalman(p: Values) -> ContinuousLaw:
    """32 sliders at a constant ratio and one at the end, all of sharpness 30."""
    chi, beta = p["chi_plus_2"] - 2.0, p["beta"]
    edge = p["phimax"] * np.append(0.0, 0.003 ** np.linspace(1.0, 0.0, 32))
    low, high = edge[:-1], edge[1:]
    weight = (high ** (chi + 1) - low ** (chi + 1)) / (chi + 1)
    moment = (high ** (chi + 2) - low ** (chi + 2)) / (chi + 2)
    stiffness = np.append(weight / weight.sum(), beta) / (1.0 + beta)
    slip = np.append(moment / weight, p["phimax"])
    return _bouc_wen_law(p["kt"] * stiffness, slip, 0.5, 0.5, 30.0)


def _clearance(p: Values) -> ContinuousLaw:
    """A stop at either side; a stop closed at rest counts where it opens."""
    middle, half = p["offset"] * p["half_width"], p["half_width"]

    def contact(r: FloatArray) -> FloatArray:
        away = r - middle
        return np.asarray(p["k"] * (away - np.clip(away, -half, half)))

    rest = contact(np.zeros(1))[0]
    linear = p["k"] if abs(p["offset"]) > 1.0 else 0.0
    return _without_states(lambda r, v: contact(r) - rest - linear * r)


def _quadratic_cubic(p: Values) -> ContinuousLaw:
    return _without_states(lambda r, v: p["k3"] * (r**3 + p["k2_over_k3"] * r**2))


def _cubic_quintic(p: Values) -> ContinuousLaw:
    return _without_states(lambda r, v: p["k3"] * (r**3 + p["k5_over_k3"] * r**5))


def _power_damping(p: Values) -> ContinuousLaw:
    """The amplitude is the force at 10 mm/s."""
    return _without_states(
        lambda r, v: p["force"] * np.sign(v) * np.abs(v / 0.01) ** p["p"]
    )


def _iwan(p: Values) -> ContinuousLaw:
    stiffness, slip = iwan_bank(p["kt"], p["phimax"], p["chi_plus_2"] - 1.0)
    return _bouc_wen_law(stiffness, slip, 0.5, 0.5, p["sharpness"])


def iwan_bank(
    kt: float, phimax: float, chi: float, count: int = SECOND_METHOD.iwan_sliders
) -> tuple[FloatArray, FloatArray]:
    """Return stiffness [N/m] and slip displacement [m] of each slider, (count,).

    Slip displacements phi lie between 0 and `phimax` with a density of stiffness
    that goes as phi^chi; each slider stands for an equal range of them.

    Source:
        Segalman 2005, J. Appl. Mech. 72, 752, eq. (14), without its delta at the end.
    """
    edge = phimax * np.arange(count + 1) / count
    low, high = edge[:-1], edge[1:]
    weight = (high ** (chi + 1) - low ** (chi + 1)) / (chi + 1)
    moment = (high ** (chi + 2) - low ** (chi + 2)) / (chi + 2)
    return kt * weight / weight.sum(), moment / weight


LAWS: Mapping[str, Callable[[Values], ContinuousLaw]] = {
    "cubic_stiffness": _cubic,
    "quadratic_stiffness": _quadratic,
    "gap": _gap,
    "coulomb": _coulomb,
    "quadratic_damping": _quadratic_damping,
    "maxwell": _maxwell,
    "jenkins": _jenkins,
    "iwan": _iwan,
    "bouc_wen": _bouc_wen,
    "bouc_wen_free": _bouc_wen_free,
    "iwan_segalman": _iwan_segalman,
    "clearance": _clearance,
    "quadratic_cubic": _quadratic_cubic,
    "cubic_quintic": _cubic_quintic,
    "power_damping": _power_damping,
}
"""Laws of links by the name of their effect."""


def values_by_name(action: Action) -> dict[str, float]:
    """Return the values of an action [SI] by the names of its parameters."""
    names = [p.name for p in action.entry.effect.parameters]
    return dict(zip(names, (float(v) for v in action.values), strict=True))


def has_law(action: Action) -> bool:
    """Return whether an effect acts on its link by a law rather than a matrix."""
    return action.entry.law is not None or action.entry.effect.name in LAWS


def law_of(action: Action) -> ContinuousLaw:
    """Return the law of an effect.

    Args:
        action: an effect with a law.

    Raises:
        UsageError: it is neither of the catalogue nor given by curves.
    """
    name = action.entry.effect.name
    if name in LAWS:
        return LAWS[name](values_by_name(action))
    law = action.entry.law(action.values) if action.entry.law is not None else None
    if law is None or law.kind != CURVES:
        raise UsageError(
            f"effect {name!r} has no second route; write its law in "
            f"analysis/gap/second_method/laws.py beside {', '.join(sorted(LAWS))}"
        )
    return _of_curves(law)


def _of_curves(law: Law) -> ContinuousLaw:
    """Return a law given by curves, splined through its points."""
    at = np.linspace(-GRADE, GRADE, law.tables.shape[1])
    spring, damping, drag = (_splined(at, row) for row in law.tables)
    distance, speed = law.parameters

    def force(r: FloatArray, v: FloatArray) -> FloatArray:
        x, y = np.arcsinh(r / distance), np.arcsinh(v / speed)
        return np.asarray(spring(x) + damping(x) * v + drag(y))

    return _without_states(force)


def _splined(at: FloatArray, row: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return a cubic spline of evenly spaced points, for arrays of any shape.

    The spline itself checks its arguments, which takes ten times as long as the sum.
    """
    pieces = CubicSpline(at, row).c
    start, step, last = float(at[0]), float(at[1] - at[0]), at.size - 2

    def value(x: FloatArray) -> FloatArray:
        k = np.clip(((x - start) / step).astype(np.intp), 0, last)
        away = x - at[k]
        a, b, c, d = pieces[:, k]
        return np.asarray(((a * away + b) * away + c) * away + d)

    return value
