"""A small machine: a bed on the ground, a housing, a spindle in bearings, a wheel."""

import pytest

from jointbench.analysis.structures.machine.machine_parts import (
    JointSetting,
    Machine,
    MachinePoint,
    MachineSpring,
    RigidPart,
)
from jointbench.analysis.structures.machine.reduce_machine import (
    ReducedMachine,
    reduce_machine,
)
from jointbench.analysis.structures.matrices.beam_body import BeamSection, beam_body
from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import Joint, Support, solid_body
from jointbench.analysis.structures.matrices.structure import build_structure
from jointbench.analysis.structures.matrices.surface_motion import Attachment
from jointbench.analysis.structures.meshes.mesh import box_mesh

STEEL = Material(200e9, 0.3, 7850.0, 0.002)
BAND = 600.0
FRONT, REAR, NOSE = (0.45, 0.1, 0.3), (0.15, 0.1, 0.3), (0.6, 0.1, 0.3)


def bearing(name: str, place: tuple[float, float, float]) -> MachineSpring:
    """Return a bearing between the spindle and the top of the housing."""
    piece = Attachment(place, radius=0.16)
    return MachineSpring(
        name,
        ("spindle", "housing"),
        (piece, piece),
        (1.0, 0.0, 0.0),
        (1e8, 3e8, 3e8, 1e4, 1e5, 1e5),
        (2e3, 5e3, 5e3, 10.0, 20.0, 20.0),
        (0.2, 0.3),
    )


@pytest.fixture(scope="session")
def machine() -> Machine:
    """Bed and housing with a joint of an area, a beam, a rigid body."""
    bed = solid_body("bed", box_mesh((0.6, 0.2, 0.1), (3, 1, 1)), STEEL)
    top = box_mesh((0.6, 0.2, 0.15), (3, 1, 1), origin=(0.0, 0.0, 0.1))
    structure = build_structure(
        [bed, solid_body("housing", top, STEEL)],
        [Joint("foot", ("housing", "bed"))],
        supports=[Support("bed", "z-")],
    )
    section = BeamSection(0.6, 0.08, 0.03, elements=12)
    beam = beam_body("spindle", (0.0, 0.1, 0.3), (1, 0, 0), [section], STEEL)
    disc = Attachment(NOSE)
    flange = MachineSpring(
        "flange",
        ("wheel", "spindle"),
        (disc, disc),
        None,
        (1e9, 1e9, 1e9, 1e7, 1e7, 1e7),
        (0.0,) * 6,
    )
    return Machine(
        structure=structure,
        beams=(beam,),
        rigid=(RigidPart("wheel", NOSE, 8.0, (0.05, 0.03, 0.03)),),
        settings={"foot": JointSetting((8e8, 3e8, 3e8), (3e3, 2e3, 2e3), 0.2, 0.3)},
        springs=(bearing("front", FRONT), bearing("rear", REAR), flange),
        points={"tool": MachinePoint("wheel", NOSE)},
    )


@pytest.fixture(scope="session")
def reduced(machine: Machine) -> ReducedMachine:
    """The machine in reduced coordinates."""
    return reduce_machine(machine, BAND)
