# SPDX-License-Identifier: MIT
"""How papers read D and G off profiles, kept by name for comparison.

Least squares of lg S over lg lag at every lag, and the arithmetic mean of the G of
several profiles: 10 to 30 times less precise than `fit_fractal`, and one profile with
a large G rules the mean.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Profile
from jointbench.signal.fractal.fractal_fit import FractalLine, fractal_from_line
from jointbench.signal.surface.structure_constant import DEFAULT_GAMMA, ConstantForm
from jointbench.signal.surface.structure_function import structure_function

LONGEST_SHARE = 0.1
"""Longest lag over the length of a profile [-]."""


@dataclass(frozen=True, slots=True)
class RecipeResult:
    """D and G by the papers' recipe.

    Attributes:
        lines: what each profile gives by itself.
        dimension: arithmetic mean of D [-].
        roughness: arithmetic mean of G [m].
    """

    lines: tuple[FractalLine, ...]
    dimension: float
    roughness: float


def fit_papers_recipe(
    profiles: Sequence[Profile],
    *,
    gamma: float = DEFAULT_GAMMA,
    constant: ConstantForm = "as-printed",
) -> RecipeResult:
    """Fit a straight line through lg S at every lag of each profile, and average.

    Args:
        profiles: at least one.
        gamma: frequency ratio in the constant of G [-].
        constant: form of the constant of G; the papers' own by default.

    Returns:
        The lines and the arithmetic means.

    Raises:
        UsageError: no profile, or a slope that is no fractal's.
        SurfaceTooSmall: a profile has too few points.

    Source:
        Appl. Sci. 2025, 15, 9040, eqs. (9) and (10) and its table of five fits.
    """
    if not profiles:
        raise UsageError("no profile given; the recipe averages one or more")
    lines = tuple(_line(one, gamma, constant) for one in profiles)
    return RecipeResult(
        lines=lines,
        dimension=float(np.mean([line.dimension for line in lines])),
        roughness=float(np.mean([line.roughness for line in lines])),
    )


def _line(profile: Profile, gamma: float, constant: ConstantForm) -> FractalLine:
    """Fit one profile at all lags to a tenth of its length."""
    longest = max(2, int(LONGEST_SHARE * profile.heights.size))
    estimate = structure_function(profile, lags=range(1, longest + 1))
    seen = estimate.value > 0
    if np.count_nonzero(seen) < 2:
        raise UsageError(f"profile {profile.name!r} is flat, it has no slope")
    slope, intercept = np.polyfit(
        np.log10(estimate.lag[seen]), np.log10(estimate.value[seen]), 1
    )
    return fractal_from_line(
        float(slope), float(intercept), gamma=gamma, constant=constant
    )
