# SPDX-License-Identifier: MIT
"""Parameters over several solutions, each with its share of the evidence."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.lumped.identified import JointParameter
from jointbench.analysis.structures.identification.hypothesis_evidence import WeighedEnd
from jointbench.analysis.structures.identification.solution_branches import (
    LARGEST_LOG_SD,
)
from jointbench.analysis.structures.identification.stiffness_problem import (
    StiffnessProblem,
)
from jointbench.analysis.structures.reduction.body_moduli import is_factor

Part = tuple[float, StiffnessProblem, WeighedEnd]
"""Share, problem, and one end of its search."""

_TAIL = 0.025
# The 95 % interval lies within so many standard deviations of some part.
_REACH = 6.0
# Parts that together carry less than this are no reason to call a value ambiguous ...
_LITTLE = 0.05
# ... nor are those within so many standard deviations of the most probable one.
_APART = 4.0


def mixed_parameters(
    parts: Sequence[Part], names: Sequence[str] | None = None
) -> tuple[JointParameter, ...]:
    """Return mean, standard deviation and interval of each parameter over all parts.

    Args:
        parts: solutions, all of one reading or of several; shares need not sum to 1.
        names: of the parameters; default those of the first part.

    Returns:
        Values exp of the mean logarithm. A parameter is not identifiable where its
        standard deviation exceeds 100 % in ln, or where solutions with more than 5 % of
        the probability lie more than four standard deviations apart.
    """
    wanted = parts[0][1].names if names is None else tuple(names)
    return tuple(_mixed(parts, name) for name in wanted)


def _mixed(parts: Sequence[Part], name: str) -> JointParameter:
    share = np.array([one for one, _, _ in parts])
    share = share / share.sum()
    value, spread = np.zeros(share.size), np.zeros(share.size)
    for row, (_, problem, end) in enumerate(parts):
        at = problem.names.index(name)
        value[row] = end.end.unknowns[at]
        spread[row] = np.sqrt(end.covariance[at, at])
    centre = float(share @ value)
    sd = float(np.sqrt(share @ (spread**2 + (value - centre) ** 2)))
    best = int(np.argmax(share))
    away = np.abs(value - value[best]) > _APART * np.hypot(spread, spread[best])
    unit = "N s/m" if name.endswith("_damping") else "" if is_factor(name) else "N/m"
    if not sd < LARGEST_LOG_SD:
        reason = "not identifiable: its standard deviation exceeds 100 %"
    elif float(share[away].sum()) > _LITTLE:
        reason = "not identifiable: several values are probable"
    else:
        reason = ""
    middle = float(np.exp(centre))
    ends = _interval(share, value, spread)
    known = not reason
    return JointParameter(
        name, middle, middle * sd if known else None, unit, known, reason, ends
    )


def _interval(
    share: FloatArray, value: FloatArray, spread: FloatArray
) -> tuple[float, float]:
    """Return the 95 % interval of a mixture of normal distributions of ln values."""
    low = float((value - _REACH * spread).min())
    high = float((value + _REACH * spread).max())

    def below(at: float, wanted: float) -> float:
        return float(share @ ndtr((at - value) / spread)) - wanted

    ends = [brentq(below, low, high, args=(one,)) for one in (_TAIL, 1.0 - _TAIL)]
    return (float(np.exp(ends[0])), float(np.exp(ends[1])))
