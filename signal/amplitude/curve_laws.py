# SPDX-License-Identifier: MIT
"""Laws of joints fitted to a curve, ranked; and their family by one ratio.

What frequency and damping do with amplitude is the first harmonic of the joint's force:
micro-slip of exponent p loses stiffness as a^p and adds damping as a^p, a cubic spring
changes stiffness as a^2 and damping not at all, v|v| adds damping as a and leaves
stiffness alone, a stop or an opening acts above a threshold and dissipates nothing.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.optimize
import scipy.special

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.amplitude.amplitude_curve import (
    DAMPING_FLOOR,
    FREQUENCY_FLOOR,
    LawFit,
)
from jointbench.signal.amplitude.curve_of_fit import LevelCurve, known_part
from jointbench.signal.amplitude.dependence_test import Change

MICRO_SLIP = "friction or micro-slip"
CUBIC = "elastic (cubic spring or clearance)"
QUADRATIC = "quadratic damping"
# Ratio d zeta / (-df/f): friction gives .27 to .47 by theory, elastic laws none.
_FRICTION_RATIO = (0.1, 1.5)
_CLEAR = 3.0
_SLIDER = "slider (Jenkins)"
_EXPONENTS = (0.4, 1.0, 2.0)
_EXPONENT_RANGE = (0.05, 4.0)
# Displacements at which the smallest slider slips, over the largest; none first. Steps
# of a third move an exponent by less than its uncertainty.
_ONSETS = (0.0, *np.geomspace(1e-4, 0.1, 19))


def family_of(change: Change) -> tuple[str, float]:
    """Return the family of laws and the ratio R = d zeta / (-df/f).

    Args:
        change: from soft to hard.

    Returns:
        The family, "unresolved" where neither change is clear, and R; nan where the
        change of frequency is not clear.
    """
    by_frequency = abs(change.frequency) > _CLEAR * change.frequency_sd
    by_damping = abs(change.damping) > _CLEAR * change.damping_sd
    ratio = -change.damping / change.frequency if change.frequency else float("nan")
    if not by_frequency:
        return (QUADRATIC if by_damping else "unresolved"), float("nan")
    low, high = _FRICTION_RATIO
    if change.damping > 0 and abs(ratio) > high:
        return QUADRATIC, ratio
    if abs(ratio) < low:
        return CUBIC, ratio
    return (MICRO_SLIP if ratio > 0 else "unresolved"), ratio


def family_by_law(family: str, laws: Sequence[LawFit]) -> str:
    """Return the family, friction where one slider explains the curve best.

    At the onset of slip a slider's damping grows before its stiffness falls: R alone
    takes that for quadratic damping.
    """
    slider = bool(laws) and laws[0].name == _SLIDER
    return MICRO_SLIP if family == QUADRATIC and slider else family


@dataclass(frozen=True, slots=True)
class _Law:
    """Shapes of the changes of frequency and damping over amplitude x in (0, 1].

    Attributes:
        name: of the law.
        shapes: what the changes of stiffness and of the energy lost in a cycle, each
            over the energy of the mode, are proportional to.
        starts: of the free parameter; empty where there is none.
        bounds: of the free parameter.
        onsets: below which the law does nothing, to be averaged over.
    """

    name: str
    shapes: Callable[[FloatArray, float, float], tuple[FloatArray, FloatArray]]
    starts: tuple[float, ...]
    bounds: tuple[float, float] = _EXPONENT_RANGE
    onsets: tuple[float, ...] = (0.0,)


def _power(x: FloatArray, p: float, onset: float) -> tuple[FloatArray, FloatArray]:
    """Sliders whose stiffness goes with s^(p - 1) ds over their slip s > `onset`.

    First harmonics of one slider, see `_slider`, summed in closed form; x^p without an
    onset.
    """
    share = np.clip(onset / np.maximum(x, 1e-12), 0.0, 1.0)
    own, _ = _slider(x, onset, 0.0)
    whole = scipy.special.beta(p + 1.5, 1.5)
    above = whole * (1.0 - scipy.special.betainc(p + 1.5, 1.5, share))
    loss = 8.0 / np.pi * above - share**p * own
    first, second = ((1.0 - share ** (p + n)) / (p + n) for n in (1.0, 2.0))
    return x**p * loss / p, x**p * (first - second)


def _cubic(x: FloatArray, p: float, onset: float) -> tuple[FloatArray, FloatArray]:
    return x**2, np.zeros_like(x)


def _quadratic(x: FloatArray, p: float, onset: float) -> tuple[FloatArray, FloatArray]:
    return np.zeros_like(x), x


def _slider(x: FloatArray, slip: float, onset: float) -> tuple[FloatArray, FloatArray]:
    """One Jenkins element: nothing below `slip`, then the exact first harmonic."""
    share = np.clip(slip / np.maximum(x, 1e-12), 0.0, 1.0)
    angle = np.arccos(np.clip(1.0 - 2.0 * share, -1.0, 1.0))
    loss = 1.0 - (angle - 0.5 * np.sin(2.0 * angle)) / np.pi
    damping = 4.0 / np.pi * share * (1.0 - share)
    return loss, damping


def _stop(x: FloatArray, gap: float, onset: float) -> tuple[FloatArray, FloatArray]:
    """A stop beyond a gap (or an opening): elastic, above a threshold."""
    share = np.clip(gap / np.maximum(x, 1e-12), 0.0, 1.0)
    engaged = 1.0 - 2.0 / np.pi * (np.arcsin(share) + share * np.sqrt(1.0 - share**2))
    return engaged, np.zeros_like(x)


_LAWS = (
    _Law("micro-slip power law", _power, _EXPONENTS, onsets=_ONSETS),
    _Law(_SLIDER, _slider, (0.1, 0.3, 0.7), (0.005, 0.999)),
    _Law("cubic spring", _cubic, ()),
    _Law("quadratic damping", _quadratic, ()),
    _Law("clearance or opening", _stop, (0.1, 0.3, 0.7), (0.005, 0.999)),
)


def fit_laws(
    curve: LevelCurve, change: Change | None, derivatives: int
) -> tuple[LawFit, ...]:
    """Fit laws to a curve and rank them.

    The joint's force goes with displacement, loses stiffness, omega^2, and energy,
    zeta omega^2: over acceleration, omega and zeta the exponent of a mode that softens
    by 3 % is 3 % too large.

    Args:
        curve: with covariance.
        change: from soft to hard; None fits nothing.
        derivatives: of the response: 0 displacement, 1 velocity, 2 acceleration.

    Returns:
        Best first, by chi-squared plus ln(points) times the number of parameters. The
        Iwan joint is the micro-slip power law below macro-slip.
    """
    part = known_part(curve)
    if change is None or part.stop - part.start < 6:
        return ()
    level = curve.level[part] - derivatives * curve.log_omega[part]
    x = np.exp(level - level.max())
    stiffness = np.exp(2.0 * (curve.log_omega[part] - curve.log_omega[part.start]))
    data = np.concatenate((stiffness, stiffness * np.exp(curve.log_zeta[part])))
    root = _root(curve, part, stiffness)
    fits = [_fit_law(law, x, data, root) for law in _LAWS]
    return tuple(sorted(fits, key=lambda fit: fit.criterion))


def _root(curve: LevelCurve, part: slice, stiffness: FloatArray) -> FloatArray:
    """Return the Cholesky factor of the covariance of stiffness and loss, with floor.

    Args:
        curve: with the covariance of ln omega and ln zeta.
        part: of the levels.
        stiffness: omega^2 over its first value, shape (n,).
    """
    zeta = np.exp(curve.log_zeta[part])
    omega = curve.omega_covariance[part, part]
    cross = curve.cross_covariance[part, part] * zeta
    own = curve.zeta_covariance[part, part] * zeta[:, None] * zeta
    matrix = np.block([[omega, cross], [cross.T, own]])
    floor = np.concatenate(
        (
            np.hypot(FREQUENCY_FLOOR, curve.omega_model_sd[part]),
            np.hypot(DAMPING_FLOOR, curve.zeta_model_sd[part]) * zeta,
        )
    )
    matrix += np.diag(floor**2)
    slopes = np.diag(np.concatenate((2.0 * stiffness, stiffness)))
    own_place = np.arange(zeta.size)
    slopes[own_place + zeta.size, own_place] = 2.0 * zeta * stiffness
    return np.asarray(np.linalg.cholesky(slopes @ matrix @ slopes.T))


def _fit_law(law: _Law, x: FloatArray, data: FloatArray, root: FloatArray) -> LawFit:
    """Fit one law; constants and sizes are linear, the exponent is searched for.

    Where the smallest slider slips is not known and moves the exponent: one half of the
    probability is that of no onset, the other is spread over the onsets.
    """
    if not law.starts:
        rest, size = _left(law, x, data, root, 1.0, 0.0)
        chi2 = float(rest @ rest)
        exponent = 2.0 if law.shapes is _cubic else 1.0
        return LawFit(law.name, exponent, 0.0, chi2, chi2 + size * np.log(data.size))
    found: list[tuple[float, float, float, int]] = []
    for onset in law.onsets:
        starts = law.starts if not found else (found[-1][0],)
        found.append(_searched(law, x, data, root, starts, onset))
    value, variance, chi2, size = np.array(found).T
    criterion = chi2 + size * np.log(data.size)
    best = int(np.argmin(criterion))
    excess = max(1.0, float(chi2[best]) / max(data.size - float(size[best]), 1.0))
    prior = np.full(value.size, 0.5 / max(value.size - 1, 1))
    prior[0] = 0.5
    weight = scipy.special.softmax(np.log(prior) - 0.5 * chi2 / excess)
    # An onset that is ruled out may have an infinite variance: 0 times infinity.
    weight, value, variance = (
        one[weight > np.finfo(float).eps] for one in (weight, value, variance)
    )
    mean = float(weight @ value)
    sd = float(np.sqrt(weight @ (excess * variance + (value - mean) ** 2)))
    return LawFit(law.name, mean, sd, float(chi2[best]), float(criterion[best]))


def _searched(
    law: _Law,
    x: FloatArray,
    data: FloatArray,
    root: FloatArray,
    starts: Sequence[float],
    onset: float,
) -> tuple[float, float, float, int]:
    """Return the free parameter, its variance, chi-squared and all parameters."""

    def residual(parameter: FloatArray) -> FloatArray:
        return _left(law, x, data, root, float(parameter[0]), onset)[0]

    tried = [
        scipy.optimize.least_squares(residual, [start], bounds=law.bounds)
        for start in starts
    ]
    best = min(tried, key=lambda one: float(one.cost))
    value = float(best.x[0])
    size = _left(law, x, data, root, value, onset)[1] + 1 + (onset > 0.0)
    slope = float(np.sum(np.asarray(best.jac) ** 2))
    variance = 1.0 / slope if slope > 0.0 else float("inf")
    return value, variance, 2.0 * float(best.cost), size


def _left(
    law: _Law,
    x: FloatArray,
    data: FloatArray,
    root: FloatArray,
    p: float,
    onset: float,
) -> tuple[FloatArray, int]:
    """Return what a law leaves of the data, whitened, and its linear parameters."""
    columns = _columns(law.shapes(x, p, onset))
    whitened = scipy.linalg.solve_triangular(
        root, np.column_stack((columns, data)), lower=True
    )
    solved = np.linalg.lstsq(whitened[:, :-1], whitened[:, -1], rcond=1e-10)[0]
    return whitened[:, -1] - whitened[:, :-1] @ solved, columns.shape[1]


def _columns(shapes: tuple[FloatArray, FloatArray]) -> FloatArray:
    """Return constants of both curves and the law's shapes, stacked."""
    none, one = np.zeros_like(shapes[0]), np.ones_like(shapes[0])
    columns = [np.concatenate((one, none)), np.concatenate((none, one))]
    if np.any(shapes[0]):
        columns.append(np.concatenate((shapes[0], none)))
    if np.any(shapes[1]):
        columns.append(np.concatenate((none, shapes[1])))
    return np.array(columns).T
