# SPDX-License-Identifier: MIT
"""``jointbench contact``: a rough joint's stiffness from surface, material, preload."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.basics.units import parse_value
from jointbench.acquisition.records.surfaces import Surface
from jointbench.analysis.contact.contact_case import ContactCase
from jointbench.analysis.contact.curve import require_surface
from jointbench.analysis.contact.draws import StiffnessInterval
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.inverse import preload_of
from jointbench.analysis.contact.model_catalogue import contact_law_package
from jointbench.analysis.contact.models import ContactModel, Mode
from jointbench.analysis.contact.predict import (
    ContactState,
    ContactVerdict,
    predict_contact,
)
from jointbench.analysis.contact.surface import ContactSurface, contact_surface
from jointbench.analysis.contact.torque_to_preload import Preload
from jointbench.analysis.contact.uncertainty import (
    JointUncertainty,
    predict_uncertainty,
)
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.surface.structure_function import StructureFunction, combine
from jointbench.signal.surface.surface_treatment import outside_filters
from jointbench.station.files.input_files import read_surfaces
from jointbench.station.pipeline.contact_request import ContactRequest
from jointbench.station.pipeline.roughness_words import contact_surface_json
from jointbench.station.pipeline.surface_stages import analyse_surface, chain_cautions

FACES = 2


@dataclass(frozen=True, slots=True)
class ContactPoint:
    """One model at one preload: what it predicts, and between which bounds.

    Attributes:
        state: the prediction.
        uncertainty: None where it rests on nothing: as printed, or without stiffness.
    """

    state: ContactState
    uncertainty: JointUncertainty | None

    @property
    def interval(self) -> StiffnessInterval:
        """Bounds of the normal stiffness; the value itself where nothing widens it."""
        if self.uncertainty is not None:
            return self.uncertainty.stiffness.interval
        value = self.state.normal_stiffness
        return StiffnessInterval(value, value, value, 0.95, 0, 0.0)


def predict_request(
    request: ContactRequest, surface: ContactSurface
) -> tuple[ContactPoint, ...]:
    """Predict every model at every preload of a request."""
    return tuple(
        predict_point(ContactCase(model, surface, preload, request.conditions))
        for model in request.models
        for preload in request.preloads or (_reaching(request, model, surface),)
    )


def _reaching(
    request: ContactRequest, model: ContactModel, surface: ContactSurface
) -> Preload:
    """Return the preload that gives a model the stiffness or real area asked for."""
    material = request.conditions.material
    fractal = FractalSurface(
        np.array(surface.dimension_for(model)),
        np.array(surface.roughness),
        np.array(material.hardness),
    )
    require_surface(model, fractal)
    value = preload_of(
        model,
        fractal,
        material,
        real_area=request.real_area,
        stiffness=request.stiffness,
    )
    return Preload(float(value), 0.0)


def predict_point(case: ContactCase) -> ContactPoint:
    """Predict one model at one preload, with the interval the inputs leave."""
    state = predict_contact(case)
    if case.model.mode is Mode.AS_PRINTED:
        return ContactPoint(state, None)
    known = case if state.damping is not None else case.without_damping()
    return ContactPoint(state, predict_uncertainty(known))


def equivalent_surface(structures: Sequence[StructureFunction]) -> ContactSurface:
    """Return the equivalent surface of a joint, S_e = S_a + S_b."""
    return contact_surface(fit_fractal(reduce(combine, structures)))


def surface_of(
    dimension: float | None,
    roughness: str | None,
    files: Sequence[Path],
    columns: str | None,
    *,
    dimension_sd: float = 0.0,
    roughness_sd: str = "0 %",
) -> ContactSurface:
    """Return the surface from numbers or from files of one or two surfaces."""
    if files and dimension is None and roughness is None:
        found = read_surfaces(files, columns=columns)
        return fractal_surface([surface for _, surface in found])
    if dimension is None or roughness is None or files:
        raise UsageError(
            "give either --dimension and --roughness, or --surface once (both "
            "alike) or twice for two"
        )
    plain = ContactSurface(_of_a_line(dimension), parse_value(roughness, "length"))
    spread = replace(
        plain.spread,
        dimension=dimension_sd,
        log_roughness=parse_value(roughness_sd, "ratio"),
    )
    return replace(plain, spread=spread)


def fractal_surface(given: Sequence[Surface]) -> ContactSurface:
    """Return D and G of the equivalent surface of one or two measured ones.

    Raises:
        BadData: they have no scaling range; the message holds what is odd about them.
        UsageError: there are more than two.
    """
    if len(given) > FACES:
        raise UsageError(f"{len(given)} surfaces for one joint; give one or two")
    faces = given if len(given) == FACES else [given[0]] * FACES
    chains = [analyse_surface(one) for one in faces]
    said = [one for chain in chains for one in chain_cautions(chain)]
    try:
        whole = equivalent_surface(
            [outside_filters(c.structure, c.surface) for c in chains]
        )
    except BadData as error:  # what is odd about the heights may be the cause
        raise BadData("; ".join([str(error), *dict.fromkeys(said)])) from error
    return replace(whole, cautions=tuple(dict.fromkeys(said)))


def _of_a_line(dimension: float) -> float:
    """Return D of a line; a surface's D_s between 2 and 3 is one higher."""
    if not (1 < dimension < FACES or FACES < dimension < FACES + 1):
        raise BadData(
            f"fractal dimension {dimension:g} is neither between 1 and 2 (a line) nor "
            "between 2 and 3 (a surface); give e.g. 1.54, the ends are no fractals"
        )
    return dimension - 1 if dimension > FACES else dimension


def contact_json(
    points: Sequence[ContactPoint],
    surface: ContactSurface | None,
    measured: Mapping[str, object] | None = None,
) -> dict[str, object]:
    """Return what the contract promises of ``contact``, and more.

    Args:
        points: of fractal laws.
        surface: that they take; None without a scaling range.
        measured: laws of measured surfaces, see `measured_json`.
    """
    return {
        **contact_surface_json(surface),
        "models": [_point_json(point) for point in points],
        "measured": measured,
    }


def _point_json(point: ContactPoint) -> dict[str, object]:
    state, found = point.state, point.uncertainty
    damping = None if found is None else found.damping
    return {
        "name": state.model,
        "package": contact_law_package(state.model),
        "mode": state.mode.value,
        "preload": state.preload,
        "normal_stiffness": state.normal_stiffness,
        "normal_stiffness_interval": [point.interval.lower, point.interval.upper],
        "normal_stiffness_first_order": list(found.stiffness.first_order)
        if found
        else None,
        "dominant_input": found.stiffness.dominant if found else None,
        "variance_shares": dict(found.stiffness.shares) if found else {},
        "approach_stiffness": state.approach_stiffness,
        "tangential_stiffness": state.tangential_stiffness,
        "loss_factor": state.loss_factor,
        "damping": state.damping,
        "damping_interval": [damping.interval.lower, damping.interval.upper]
        if damping
        else None,
        "largest_area": state.largest_area,
        # Beyond the largest double near the lower end of the dimension.
        "critical_area": state.critical_area
        if math.isfinite(state.critical_area)
        else None,
        "real_area": state.real_area,
        "stiffness_parts": dict(state.stiffness_parts),
        "load_parts": dict(state.load_parts),
        "verdict": state.verdict.value,
        "usable": state.verdict is ContactVerdict.USABLE,
        "reasons": list(state.reasons),
    }
