# SPDX-License-Identifier: MIT
"""``jointbench contact``: a rough joint's stiffness from surface, material, preload."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from pathlib import Path

from jointbench.acquisition.errors import UsageError
from jointbench.acquisition.units import parse_value
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.models import ContactModel, contact_model
from jointbench.analysis.contact.predict import ContactState, predict_contact
from jointbench.analysis.contact.spread import StiffnessInterval, predict_interval
from jointbench.analysis.contact.surface import ContactSurface, contact_surface
from jointbench.signal.fractal import fit_fractal
from jointbench.signal.structure_function import StructureFunction, combine
from jointbench.station.inputs import read_surfaces
from jointbench.station.output import console, table, write_json
from jointbench.station.outputs import check_outputs
from jointbench.station.surface import analyse_surface

FACES = 2
MODE = "corrected"


@dataclass(frozen=True, slots=True)
class ContactPoint:
    """One model at one preload: what it predicts, and between which bounds."""

    state: ContactState
    interval: StiffnessInterval


def run_contact(
    models: Sequence[str],
    *,
    loads: Sequence[str],
    modulus: str,
    hardness: str,
    poisson: float,
    dimension: float | None,
    roughness: str | None,
    surfaces: Sequence[Path],
    columns: str | None,
    json_target: str | None,
) -> tuple[ContactPoint, ...]:
    """Predict every model at every load and show them."""
    check_outputs(surfaces, [json_target])
    chosen = [contact_model(name) for name in models]
    material = ContactMaterial(
        effective_modulus=parse_value(modulus, "pressure"),
        hardness=parse_value(hardness, "pressure"),
        poisson=poisson,
    )
    surface = _surface(dimension, roughness, surfaces, columns)
    points = tuple(
        predict_point(model, surface, material, parse_value(load, "force"))
        for model in chosen
        for load in loads
    )
    _show(points, surface, json_target)
    write_json(json_target, contact_json(points, surface))
    return points


def predict_point(
    model: ContactModel,
    surface: ContactSurface,
    material: ContactMaterial,
    preload: float,
) -> ContactPoint:
    """Predict one model at one preload [N], with the interval the surface leaves."""
    dimension = surface.dimension_for(model)
    state = predict_contact(
        model,
        dimension=dimension,
        roughness=surface.roughness,
        material=material,
        preload=preload,
    )
    interval = predict_interval(
        model,
        dimension=dimension,
        roughness=surface.roughness,
        material=material,
        preload=preload,
        spread=surface.spread,
    )
    return ContactPoint(state, interval)


def equivalent_surface(structures: Sequence[StructureFunction]) -> ContactSurface:
    """Return the one surface that stands for the faces of a joint, S_e = S_a + S_b."""
    return contact_surface(fit_fractal(reduce(combine, structures)))


def _surface(
    dimension: float | None,
    roughness: str | None,
    files: Sequence[Path],
    columns: str | None,
) -> ContactSurface:
    if files and dimension is None and roughness is None:
        found = read_surfaces(files, columns=columns)
        if len(found) > FACES:
            raise UsageError(
                f"{len(found)} surfaces for one joint; give one face or two"
            )
        faces = found if len(found) == FACES else found * FACES
        return equivalent_surface([analyse_surface(s).structure for _, s in faces])
    if dimension is None or roughness is None or files:
        raise UsageError(
            "give either --dimension and --roughness, or --surface for one face (both "
            "alike) or twice for two"
        )
    return ContactSurface(_of_a_line(dimension), parse_value(roughness, "length"))


def _of_a_line(dimension: float) -> float:
    """Return D of a line; a surface's D_s between 2 and 3 is one higher."""
    return dimension - 1 if dimension > FACES else dimension


def _show(
    points: Sequence[ContactPoint], surface: ContactSurface, json_target: str | None
) -> None:
    screen = console(json_target)
    rows = [
        (
            point.state.model,
            f"{point.state.preload:.6g}",
            f"{point.state.normal_stiffness:.4g}",
            _bounds(point.interval),
            f"{point.state.tangential_stiffness:.4g}",
            f"{point.state.real_area * 1e6:.4g}",
            point.state.verdict.value,
        )
        for point in points
    ]
    columns = (
        "model",
        "preload [N]",
        "normal K [N/m]",
        "95 % interval",
        "tangential K [N/m]",
        "real area [mm²]",
        "verdict",
    )
    title = (
        f"Contact at D = {surface.dimension:.4f} (line), G = {surface.roughness:.3g} m"
    )
    screen.print(table(title, columns, rows))
    for reason in dict.fromkeys(r for point in points for r in point.state.reasons):
        screen.print(f"  {reason}", markup=False)


def _bounds(interval: StiffnessInterval) -> str:
    """Write an interval; one that nothing widens is left out."""
    if interval.upper <= interval.lower * (1 + 1e-9):
        return "-"
    return f"{interval.lower:.3g} to {interval.upper:.3g}"


def contact_json(
    points: Sequence[ContactPoint], surface: ContactSurface
) -> dict[str, object]:
    """Return what the contract promises of ``contact``, and more."""
    return {
        "dimension": surface.dimension,
        "roughness_m": surface.roughness,
        "models": [
            {
                "name": point.state.model,
                "mode": MODE,
                "preload": point.state.preload,
                "normal_stiffness": point.state.normal_stiffness,
                "normal_stiffness_interval": [
                    point.interval.lower,
                    point.interval.upper,
                ],
                "tangential_stiffness": point.state.tangential_stiffness,
                "damping": point.state.damping,
                "largest_area": point.state.largest_area,
                "critical_area": point.state.critical_area,
                "real_area": point.state.real_area,
                "stiffness_parts": dict(point.state.stiffness_parts),
                "load_parts": dict(point.state.load_parts),
                "verdict": point.state.verdict.value,
                "reasons": list(point.state.reasons),
            }
            for point in points
        ],
    }
