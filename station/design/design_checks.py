# SPDX-License-Identifier: MIT
"""Checks of ``jointbench design`` before meshes are reduced, which takes long."""

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.design.plan_search import require_choice
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import modulus_name
from jointbench.station.design.design_records import DesignRequest
from jointbench.station.joints.structure_model import StructureModel
from jointbench.station.joints.structure_tables import DesignTable


def require_points(
    settings: StructureModel, table: DesignTable, request: DesignRequest
) -> None:
    """Check sensors and hit points before the meshes are reduced, which takes long."""
    if request.measured:
        if not settings.sensors or not settings.hits:
            raise BadData("--next needs [sensors.*] and [hits.*] as they were measured")
        chosen = len(settings.sensors)
    else:
        require_choice(table.sensors, table.hits, (len(settings.reachable),) * 2)
        chosen = table.sensors
    if request.plan_sensors not in {None, chosen}:
        raise BadData(
            f"the plan has {request.plan_sensors} response sensors with a point, the "
            f"design {chosen}; give the plan as many, or change design.sensors"
        )


def require_wanted(
    settings: StructureModel, table: DesignTable, structure: Structure
) -> None:
    """Check the names of wanted parameters before the meshes are reduced."""
    there = [
        f"{name}_{kind}"
        for kind in ("stiffness", "damping")
        for name in structure.parameter_names
    ]
    there += [modulus_name(body) for body in settings.identify.modulus_sd]
    unknown = [one for one in table.wanted if one not in there]
    if unknown:
        raise UsageError(f"design.wanted: no {unknown[0]!r}; there are {there}")
