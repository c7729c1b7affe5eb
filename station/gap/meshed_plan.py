# SPDX-License-Identifier: MIT
"""Places of a structure model, for the picture of the structure."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.station.bolted.free_bodies import BoltedModel
from jointbench.station.gap.structure_plan import StructurePlan
from jointbench.station.joints.structure_model import StructureModel


def plan_of(table: StructureModel, model: BoltedModel) -> StructurePlan:
    """Return the places of a structure model.

    Args:
        table: content of the model file.
        model: its bodies and bolted areas.
    """
    rows: list[tuple[str, str, FloatArray]] = [
        (f"bolt:{area.name}", "bolts", area.position) for area in model.areas
    ]
    feet = table.gap.feet if table.gap is not None else None
    for k, foot in enumerate(() if feet is None else feet.places):
        rows.append((f"foot:{k}", "feet", np.array(foot.position)))
    for kind, word, tables in (
        ("point", "hammer points", table.hits),
        ("channel", "sensors", table.sensors),
    ):
        rows += [(f"{kind}:{n}", word, np.array(t.position)) for n, t in tables.items()]
    names, kinds, places = zip(*rows, strict=True)
    bodies = model.structure.bodies
    boxes = [_box(one.mesh.nodes) for one in bodies]
    return StructurePlan(
        names,
        kinds,
        np.array(places),
        np.array(boxes),
        tuple(one.name for one in bodies),
        {
            name: tuple(f"bolt:{model.areas[k].name}" for k in own)
            for name, own in model.bodies.joints.items()
        },
    )


def _box(nodes: FloatArray) -> list[list[float]]:
    """Return the corners of the box around a mesh [m]."""
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    ends = np.stack([low, high])
    return [[float(ends[(k >> d) & 1, d]) for d in range(3)] for k in range(8)]
