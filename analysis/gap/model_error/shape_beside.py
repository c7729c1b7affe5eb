# SPDX-License-Identifier: MIT
"""An elementary shape beside a law that is a function of the motion alone.

A spring and a stop stand in for each other: both raise the frequency of a hard hit, and
one of them alone may remove most of the residual of the other. What a stand-in leaves
is again a function of the motion, so that an elementary one (a power of the motion, its
magnitude) explains part of it. The correct law leaves no such part, whatever else the
joint does: friction and damping resemble no function of the motion.
"""

from jointbench.analysis.gap.catalogue.probes import SPRINGS
from jointbench.analysis.gap.model.partial_records import ShapeBeside
from jointbench.analysis.gap.model_error.whitened_bench import WhitenedBench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.screening import screen

ELASTIC = frozenset({"stiffness", "contact"})
"""Families whose force is a function of the motion alone."""
_SHAPES = frozenset(entry.name for entry in SPRINGS)


def shape_beside(bench: WhitenedBench, base: Fit, fit: Fit) -> ShapeBeside | None:
    """Return the elementary shape that explains most beside an elastic law.

    Args:
        bench: of both fits.
        base: fit without a law.
        fit: fit of one law.

    Returns:
        None for a law that dissipates energy, or without such shapes.
    """
    (law,) = fit.candidates
    shapes = [
        c for c in bench.inner.probes if c.effect.name in _SHAPES and c.site == law.site
    ]
    if law.effect.family not in ELASTIC or not shapes:
        return None
    best = screen(bench, fit, shapes).directions[0]
    explained = max(base.cost - fit.cost, 1e-300)
    return ShapeBeside(best.candidate.effect.name, best.drop / explained)
