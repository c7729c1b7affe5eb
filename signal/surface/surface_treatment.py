# SPDX-License-Identifier: MIT
"""Optional treatment of a surface before its fit: outliers, form, filter, lines."""

from dataclasses import dataclass, replace

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Areal, Surface
from jointbench.signal.surface.form_removal import mask_outliers, remove_form
from jointbench.signal.surface.gaussian_filter import filter_waves
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
        short: cut-off lambda_s of a Gaussian filter [m]; None for none.
        long: cut-off lambda_c [m]; None for none.
    """

    form: int | None = None
    outliers: float | None = None
    direction: float | None = None
    short: float | None = None
    long: float | None = None

    @property
    def changes_heights(self) -> bool:
        """Whether any height is masked or changed."""
        asked = (self.form, self.outliers, self.short, self.long)
        return any(one is not None for one in asked)

    @property
    def filters(self) -> bool:
        """Whether waves are removed."""
        return self.short is not None or self.long is not None


UNTREATED = SurfaceTreatment()


def treated(surface: Surface, treatment: SurfaceTreatment) -> Surface:
    """Mask outliers, remove the form, then filter; each step is in the provenance.

    Raises:
        UsageError: a degree, a limit or a cut-off out of range.
        SurfaceTooSmall: too few measured points.
    """
    if treatment.outliers is not None:
        surface = mask_outliers(surface, limit=treatment.outliers)
    if treatment.form is not None:
        surface = remove_form(surface, degree=treatment.form)
    if treatment.filters:
        surface = filter_waves(surface, short=treatment.short, long=treatment.long)
    return surface


def outside_filters(estimate: StructureFunction, surface: Surface) -> StructureFunction:
    """Return S at the lags of which the filter of the instrument leaves the surface.

    At lags below a stated lambda_s the slope of S is that of the filter; a blur is
    fitted to what it takes from longer ones.
    """
    cutoff = surface.instrument.cutoff_short
    if cutoff is None or not (estimate.lag >= cutoff).any():
        return estimate
    return estimate.only(estimate.lag >= cutoff)


def treated_structure(
    surface: Surface, treatment: SurfaceTreatment
) -> tuple[Surface, StructureFunction]:
    """Return the treated surface and its structure function.

    Raises:
        UsageError: a degree, a limit or a cut-off out of range, or a direction of a
            profile.
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
    if treatment.form is not None or treatment.filters:
        # The instrument's quantisation steps are only in the original heights.
        step = height_step(surface.heights[surface.valid])
        estimate = replace(estimate, quantum=step)
    return flat, estimate
