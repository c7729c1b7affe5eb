# SPDX-License-Identifier: MIT
"""A free spring with a free damper: a rival of friction where no spring is known.

Friction softens a joint and dissipates, and the one follows from the other. A softening
spring beside a damper does both as well, each by a law of its own, and a spring alone
is imitated by a Bouc-Wen law that unloads along its loading. No catalogue holds all
springs and dampers: their first powers beyond the linear ones, fitted together, stand
for them. They cannot follow a slider from stick to slip, whose stiffness and loss are
no powers of the motion.

Source:
    Masri and Caughey 1979, J. Appl. Mech. 46, 433, eq. (9): a restoring force as powers
    of motion and speed.
"""

import numpy as np

from jointbench.analysis.gap.model.effect import Site
from jointbench.analysis.gap.model_error.model_error_settings import (
    MODEL_ERROR_SETTINGS,
)
from jointbench.analysis.gap.model_error.whitened_bench import WhitenedBench
from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise

FREE_LAW = "free spring and damper"
"""Name of this rival; it belongs to no family."""
FRICTION = "friction"
"""Family whose laws soften a joint and dissipate."""
STIFFNESS = "stiffness"
"""Family of springs; where the catalogue has one, that is the rival of friction."""
POWERS = frozenset(
    {
        "square of the motion",
        "cube of the motion",
        "damping proportional to the square of the motion",
        "square of the speed",
    }
)
"""Shapes of `catalogue.probes` that are fitted together."""


def fit_free_law(bench: WhitenedBench, base: Fit, site: Site) -> Fit | None:
    """Fit a free spring with a free damper, from zero.

    Args:
        bench: of the base's fit.
        base: fit without a law.
        site: of the friction law.

    Returns:
        None for a bench without such shapes at the site.
    """
    shapes = tuple(
        c for c in bench.inner.probes if c.effect.name in POWERS and c.site == site
    )
    if not shapes:
        return None
    settings = MODEL_ERROR_SETTINGS
    return minimise(
        make_problem(bench, shapes),
        np.concatenate([base.x, np.zeros(len(shapes))]),
        MIDDLE,
        iterations=settings.law_iterations,
        least_drop=settings.least_drop_share * bench.blocks.dof,
    )
