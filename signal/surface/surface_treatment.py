# SPDX-License-Identifier: MIT
"""Optional treatment of a surface before its fit: outliers, form, direction."""

from dataclasses import dataclass, replace

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Areal, Surface
from jointbench.signal.surface.form_removal import mask_outliers, remove_form
from jointbench.signal.surface.quantisation_step import height_step
from jointbench.signal.surface.structure_along import structure_along
from jointbench.signal.surface.structure_function import (
    StructureFunction,
    structure_function,
)


@dataclass(frozen=True, slots=True)
class SurfaceTreatment:
    """Steps that are made only on request.

    Attributes:
        form: degree of the polynomial to remove [-]; None for none.
        outliers: distance from its neighbours that masks a point, in robust standard
            deviations [-]; None masks none.
        direction: of the lines of a map, from its rows towards its columns [rad];
            None for the rows.
    """

    form: int | None = None
    outliers: float | None = None
    direction: float | None = None

    @property
    def changes_heights(self) -> bool:
        """Whether any height is masked or changed."""
        return self.form is not None or self.outliers is not None


UNTREATED = SurfaceTreatment()


def treated(surface: Surface, treatment: SurfaceTreatment) -> Surface:
    """Mask outliers, then remove the form, each with a step in the provenance.

    Raises:
        UsageError: a degree or a limit out of range.
        SurfaceTooSmall: too few measured points.
    """
    if treatment.outliers is not None:
        surface = mask_outliers(surface, limit=treatment.outliers)
    if treatment.form is not None:
        surface = remove_form(surface, degree=treatment.form)
    return surface


def treated_structure(
    surface: Surface, treatment: SurfaceTreatment
) -> tuple[Surface, StructureFunction]:
    """Return the treated surface and its structure function.

    Raises:
        UsageError: a degree or a limit out of range, or a direction of a profile.
        SurfaceTooSmall: too few measured points.
    """
    flat = treated(surface, treatment)
    if treatment.direction is None:
        estimate = structure_function(flat)
    elif isinstance(flat, Areal):
        estimate = structure_along(flat, treatment.direction)
    else:
        raise UsageError(
            f"surface {surface.name!r} is a profile, it has one direction; leave out "
            "--direction or give maps"
        )
    if treatment.form is not None:
        # The instrument's quantisation steps are only in the original heights.
        step = height_step(surface.heights[surface.valid])
        estimate = replace(estimate, quantum=step)
    return flat, estimate
