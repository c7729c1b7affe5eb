# SPDX-License-Identifier: MIT
"""The joint twice: as the contact law predicts it, and as the modes identify it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.surfaces import Surface
from jointbench.analysis.contact.contact_case import ContactCase, ContactConditions
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.surface import ContactSurface
from jointbench.analysis.contact.torque_to_preload import Preload
from jointbench.signal.surface.structure_function import StructureFunction
from jointbench.station.contact.measured_prediction import (
    MeasuredJoint,
    MeasuredPrediction,
    measured_prediction,
)
from jointbench.station.pipeline.contact_prediction import (
    FACES,
    ContactPoint,
    equivalent_surface,
    predict_point,
)
from jointbench.station.schemas.bench_model import ContactTable

CURVE_POINTS = 13
CURVE_DECADES = 1.0
"""The curve runs this many decades of preload to either side."""


@dataclass(frozen=True, slots=True)
class ContactPrediction:
    """Prediction of the contact law for two surfaces.

    Attributes:
        surface: the equivalent surface of both.
        at: the prediction at the joint's own preload.
        curve: predictions over a range of preloads around it.
    """

    surface: ContactSurface
    at: ContactPoint
    curve: tuple[ContactPoint, ...]


def predict_joint(
    structures: Sequence[StructureFunction], table: ContactTable
) -> ContactPrediction:
    """Predict a joint from the structure functions of its surfaces.

    Args:
        structures: of two surfaces, or of one equivalent surface.
        table: material, preload and model.

    Raises:
        BadData: no surface, more than two, or no scaling range on them.
    """
    _require_faces(structures)
    faces = structures if len(structures) == FACES else [structures[0]] * FACES
    surface = equivalent_surface(faces)
    case = ContactCase(
        contact_model(table.model),
        surface,
        Preload(table.preload, 0.0),
        _conditions(table),
    )
    preloads = table.preload * np.logspace(-CURVE_DECADES, CURVE_DECADES, CURVE_POINTS)
    return ContactPrediction(
        surface,
        predict_point(case),
        tuple(
            predict_point(replace(case, preload=Preload(float(p), 0.0)))
            for p in preloads
        ),
    )


def predict_measured_joint(
    surfaces: Sequence[Surface], table: ContactTable, area: float
) -> MeasuredPrediction:
    """Predict a joint by the laws of measured surfaces.

    Args:
        surfaces: of both sides, or one that stands for both.
        table: material and preload.
        area: apparent [m^2].

    Raises:
        BadData: no surface, more than two, or no wavelength that they show.
    """
    _require_faces(surfaces)
    joint = MeasuredJoint(area, _conditions(table), (Preload(table.preload, 0.0),))
    return measured_prediction(surfaces, joint, None)


def _conditions(table: ContactTable) -> ContactConditions:
    return ContactConditions(
        ContactMaterial(
            effective_modulus=table.modulus,
            hardness=table.hardness,
            poisson=table.poisson,
        )
    )


def _require_faces(surfaces: Sequence[object]) -> None:
    if not 1 <= len(surfaces) <= FACES:
        raise BadData(
            f"{len(surfaces)} surfaces for one joint; keep the two in contact "
            "in the session, or one that stands for both"
        )
