# SPDX-License-Identifier: MIT
"""What measured surfaces of a joint give: D and G, and the laws of their spectra."""

from collections.abc import Sequence
from dataclasses import dataclass

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.surfaces import Surface
from jointbench.analysis.contact.surface import ContactSurface
from jointbench.station.contact.measured_prediction import (
    MeasuredJoint,
    MeasuredPrediction,
    measured_prediction,
)
from jointbench.station.pipeline.contact_prediction import fractal_surface
from jointbench.station.pipeline.contact_request import ContactRequest


@dataclass(frozen=True, slots=True, eq=False)
class FacesPrediction:
    """What follows from the measured surfaces of a joint.

    Attributes:
        surface: D and G of the equivalent surface; None without a scaling range.
        measured: the laws of their spectra; None without an apparent area or preload.
    """

    surface: ContactSurface | None
    measured: MeasuredPrediction | None


def predict_faces(faces: Sequence[Surface], request: ContactRequest) -> FacesPrediction:
    """Fit the surfaces of a joint and predict by the laws of measured spectra.

    Raises:
        BadData: they have no scaling range, and an area or a preload for the other
            laws is missing.
    """
    area = request.conditions.nominal_area
    known = area is not None and bool(request.preloads)
    fractal: ContactSurface | str
    try:
        fractal = fractal_surface(faces)
    except BadData as error:
        if not known:
            raise BadData(
                f"{error}; give --nominal-area with --load or --torque for the laws of "
                "the measured spectrum"
            ) from error
        fractal = str(error)
    surface = None if isinstance(fractal, str) else fractal
    if area is None or not known:
        return FacesPrediction(surface, None)
    joint = MeasuredJoint(area, request.conditions, request.preloads, request.models)
    return FacesPrediction(surface, measured_prediction(faces, joint, fractal))
