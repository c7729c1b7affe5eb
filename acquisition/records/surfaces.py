# SPDX-License-Identifier: MIT
"""Records of a profilometer: heights on a line or on an area."""

from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.array_checks import (
    require_finite,
    require_positive,
    require_shape,
)
from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, freeze
from jointbench.acquisition.records.provenance import Provenance


@dataclass(frozen=True, slots=True)
class SurfaceInstrument:
    """Data of the instrument; None where the file does not state them.

    Attributes:
        name: as the file states it.
        stylus_radius: [m].
        numerical_aperture: of the objective [-].
        cutoff_short: short-wave filter cut-off lambda_s [m].
        cutoff_long: long-wave filter cut-off lambda_c [m].
    """

    name: str = ""
    stylus_radius: float | None = None
    numerical_aperture: float | None = None
    cutoff_short: float | None = None
    cutoff_long: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """Heights along a line at even spacing.

    Attributes:
        name: unique within a session.
        heights: z [m], shape (n,), finite; 0 where `valid` is False.
        spacing: distance between neighbours [m].
        valid: False where a point is missing, shape (n,).
        instrument: used for the measurement.
        provenance: origin and processing steps.
    """

    name: str
    heights: FloatArray
    spacing: float
    valid: BoolArray
    instrument: SurfaceInstrument = SurfaceInstrument()
    provenance: Provenance = field(default=())

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_shape("heights", self.heights, (None,))
        require_shape("valid", self.valid, (self.heights.size,))
        require_finite("heights", self.heights)
        require_positive("spacing", self.spacing)
        freeze(self, "heights", "valid")

    @property
    def length(self) -> float:
        """Distance from the first to the last point [m]."""
        return self.spacing * (self.heights.size - 1)


@dataclass(frozen=True, slots=True, eq=False)
class Areal:
    """Heights on a rectangular grid.

    Attributes:
        name: unique within a session.
        heights: z [m], shape (n_rows, n_columns), finite; 0 where not `valid`.
        spacing: distance between neighbours along (rows, columns) = (y, x) [m].
        valid: False where a point is missing, same shape.
        instrument: used for the measurement.
        provenance: origin and processing steps.
    """

    name: str
    heights: FloatArray
    spacing: tuple[float, float]
    valid: BoolArray
    instrument: SurfaceInstrument = SurfaceInstrument()
    provenance: Provenance = field(default=())

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_shape("heights", self.heights, (None, None))
        require_shape("valid", self.valid, self.heights.shape)
        require_finite("heights", self.heights)
        require_positive("spacing", self.spacing[0])
        require_positive("spacing", self.spacing[1])
        freeze(self, "heights", "valid")


Surface = Profile | Areal


def all_valid(heights: FloatArray) -> BoolArray:
    """Return a mask of the shape of `heights` that marks no point as missing."""
    return np.ones(heights.shape, dtype=np.bool_)
