# SPDX-License-Identifier: MIT
"""A reduced machine on disk: everything but the values of its joints.

A body keeps what its joints, points and pictures need; its mesh and the motion of all
of its nodes are left out.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.file_access.array_cache import (
    Arrays,
    read_arrays,
    write_arrays,
)
from jointbench.analysis.structures.machine.body_geometry import Surface
from jointbench.analysis.structures.machine.machine_parts import (
    JointSetting,
    MachineSpring,
)
from jointbench.analysis.structures.machine.reduce_machine import (
    MACHINE_BOX,
    MACHINE_MODES,
    MachineBody,
    ReducedMachine,
    nominal_values,
)
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.reduction.assembled import assemble_components
from jointbench.analysis.structures.reduction.port_joints import PortJoint
from jointbench.analysis.structures.reduction.reduction_cache import (
    component_arrays,
    component_of,
)


def write_machine(folder: Path, key: str, machine: ReducedMachine) -> None:
    """Write a reduced machine.

    Args:
        folder: of the cache.
        key: that names what it was made from.
        machine: to write.
    """
    facts = {
        "joints": [_joint_facts(one) for one in machine.assembled.joints],
        "parametric": len(machine.joints),
        "sides": machine.sides,
        "freedoms": machine.freedoms,
        "bodies": [[name for name, _ in one.surfaces] for one in machine.bodies],
    }
    arrays: Arrays = {"facts": np.array(json.dumps(facts)), "rigid": machine.rigid}
    for at, (component, body) in enumerate(
        zip(machine.assembled.components, machine.bodies, strict=True)
    ):
        lean = replace(component, basis=np.zeros((0, component.size)))
        arrays |= component_arrays(f"body{at}.", lean)
        arrays[f"body{at}.motion"] = body.rigid
        arrays[f"body{at}.gyroscopic"] = body.gyroscopic
        for part, ((_, surface), rows) in enumerate(
            zip(body.surfaces, body.motions, strict=True)
        ):
            arrays[f"nodes{at}.{part}"] = surface.nodes
            arrays[f"triangles{at}.{part}"] = surface.triangles
            # Pictures need no more digits.
            arrays[f"motion{at}.{part}"] = rows.astype(np.float32)
    write_arrays(folder, key, arrays)


def read_machine(
    folder: Path,
    key: str,
    settings: Mapping[str, JointSetting],
    springs: Sequence[MachineSpring],
    speeds: Mapping[str, float],
) -> ReducedMachine | None:
    """Read a reduced machine, and give its joints values.

    Args:
        folder: of the cache.
        key: see `write_machine`.
        settings: of the joints over areas, by name.
        springs: between pieces.
        speeds: of the bodies that turn, by name [rad/s].

    Returns:
        The machine; None if it is not there, or its file is cut short.
    """
    arrays = read_arrays(folder, key)
    if arrays is None:
        return None
    facts = json.loads(str(arrays["facts"]))
    components = [
        component_of(f"body{at}.", arrays) for at in range(len(facts["bodies"]))
    ]
    every = [_joint_of(one) for one in facts["joints"]]
    joints = tuple(every[: facts["parametric"]])
    assembled = assemble_components(
        components, every, box=MACHINE_BOX, modes=MACHINE_MODES
    )
    values = nominal_values(settings, springs, joints)
    sides = {name: (body, port) for name, (body, port) in facts["sides"].items()}
    return ReducedMachine(
        assembled=assembled,
        bodies=tuple(
            _body(arrays, at, names, component.name, assembled.places[at])
            for at, (names, component) in enumerate(
                zip(facts["bodies"], components, strict=True)
            )
        ),
        stiffness=values[0],
        damping=values[1],
        deviations=values[2:],
        joints=joints,
        rigid=arrays["rigid"],
        points={name: assembled.rows(side) for name, side in sides.items()},
        sides=sides,
        freedoms=facts["freedoms"],
        speeds=speeds,
    )


def _joint_facts(joint: PortJoint) -> list[Any]:
    return [joint.name, joint.first, joint.second, joint.directions]


def _joint_of(facts: list[Any]) -> PortJoint:
    name, first, second, directions = facts
    other = None if second is None else (second[0], second[1])
    return PortJoint(name, (first[0], first[1]), other, tuple(directions))


def _body(
    arrays: Arrays, at: int, names: list[str], name: str, place: Any
) -> MachineBody:
    none = Sparse((0, 0))
    parts = range(len(names))
    return MachineBody(
        name=name,
        place=place,
        stiffness=arrays[f"body{at}.stiffness"],
        rigid=arrays[f"body{at}.motion"],
        surfaces=tuple(
            (
                names[part],
                Surface(
                    arrays[f"nodes{at}.{part}"], arrays[f"triangles{at}.{part}"], none
                ),
            )
            for part in parts
        ),
        motions=tuple(
            arrays[f"motion{at}.{part}"].astype(np.float64) for part in parts
        ),
        gyroscopic=arrays[f"body{at}.gyroscopic"],
    )
