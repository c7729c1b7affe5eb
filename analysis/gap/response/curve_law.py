# SPDX-License-Identifier: MIT
"""Make a force law of a joint from plain functions, for user-defined effects."""

import numpy as np

from jointbench.analysis.gap.response.curve_integration import (
    FASTEST,
    REACH,
    Curve,
    finest_of,
    tabulate,
)
from jointbench.analysis.gap.response.effect_hooks import Law
from jointbench.analysis.gap.response.law_forces import CURVES


def curve_law(
    *,
    spring: Curve | None = None,
    damping: Curve | None = None,
    drag: Curve | None = None,
) -> Law:
    """Return the law of force = spring(r) + damping(r) v + drag(v).

    Each curve takes an array and returns one of its shape; r is the motion of the
    second end of the link relative to the first, positive if they separate. Curves
    are tabulated up to 10 mm and 100 m/s.

    Args:
        spring: force [N] of r [m].
        damping: damping coefficient [N s/m] of r [m].
        drag: force [N] of v [m/s].

    Returns:
        The law, for the `law` hook of an effect.

    Raises:
        UsageError: a curve returns another shape or non-finite values.
    """
    tables = [tabulate(spring, REACH), tabulate(damping, REACH)]
    return Law(
        CURVES,
        np.array([finest_of(REACH), finest_of(FASTEST)]),
        tables=np.stack([*tables, tabulate(drag, FASTEST)]),
    )
