# SPDX-License-Identifier: MIT
"""What would give a surface without a scaling range its D and G."""

from dataclasses import replace

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.records.surfaces import Surface
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.fractal.verdict_records import FractalFit
from jointbench.signal.surface.form_removal import OUTLIER_LIMIT
from jointbench.signal.surface.surface_treatment import (
    SurfaceTreatment,
    outside_filters,
    treated_structure,
)
from jointbench.station.screen.value_text import engineering

_FORM = 2
"""Degree of the form that is tried: cylinders and spheres [-]."""
_MOST_POINTS = 200_000
"""Points of a surface up to which remedies are tried; larger ones take as long as the
fit again for each [-]."""


def remedy(
    surface: Surface, fit: FractalFit, treatment: SurfaceTreatment
) -> str | None:
    """Return what helps a surface without a scaling range, None where it has one.

    Args:
        surface: as it was read.
        fit: of the surface with its treatment.
        treatment: as given.

    Returns:
        One line: the option under which the surface has a D, tried on the heights;
        else the options that were tried in vain, and what remains.
    """
    if fit.scaling is not None:
        return None
    stated = _stated_filter(surface)
    tries = _tries(treatment)
    if surface.heights.size > _MOST_POINTS or not tries:
        return stated or "a longer or finer measurement may show a scaling range"
    for words, one in tries:
        found = _fitted(surface, one)
        if found is not None and found.scaling is not None:
            return f"{words} helps: {found.verdict.value}, D = {found.dimension:.3f}"
    tried = ", ".join(words for words, _ in tries)
    rest = stated or "measure longer, finer, or several profiles for --pool"
    return f"without a scaling range under {tried} too; {rest}"


def _tries(treatment: SurfaceTreatment) -> list[tuple[str, SurfaceTreatment]]:
    """Return the options that are still open, each alone and then both."""
    found = []
    masked = replace(treatment, outliers=OUTLIER_LIMIT)
    if treatment.outliers is None:
        found.append((f"--outliers {OUTLIER_LIMIT:g}", masked))
    if treatment.form is None:
        found.append((f"--form {_FORM}", replace(treatment, form=_FORM)))
    if len(found) > 1:
        words = " ".join(words for words, _ in found)
        found.append((words, replace(masked, form=_FORM)))
    return found


def _fitted(surface: Surface, treatment: SurfaceTreatment) -> FractalFit | None:
    try:
        flat, structure = treated_structure(surface, treatment)
        return fit_fractal(outside_filters(structure, flat))
    except (BadData, UsageError):
        return None


def _stated_filter(surface: Surface) -> str | None:
    """Name the instrument's filter, inside which no power law can be seen."""
    cutoff = surface.instrument.cutoff_short
    if cutoff is None:
        return None
    return (
        f"the file states a filter of lambda_s = {engineering(cutoff, 'm')}, which "
        "hides all shorter waves; measure with a shorter lambda_s"
    )
