"""Gyroscopic moments of turning beams and rigid bodies, against closed forms."""

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.structures.machine.analyse_machine import analyse_machine
from jointbench.analysis.structures.machine.lean_machine import jointed, lean_machine
from jointbench.analysis.structures.machine.machine_parts import (
    Machine,
    MachinePoint,
    MachineSpring,
    RigidPart,
)
from jointbench.analysis.structures.machine.machine_request import MachineRequest
from jointbench.analysis.structures.machine.reduce_machine import reduce_machine
from jointbench.analysis.structures.matrices.beam_body import BeamSection, beam_body
from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import Support, solid_body
from jointbench.analysis.structures.matrices.structure import build_structure
from jointbench.analysis.structures.matrices.surface_motion import Attachment
from jointbench.analysis.structures.meshes.mesh import box_mesh

STEEL = Material(210e9, 0.3, 7850.0)
LENGTH, RADIUS = 0.4, 0.04
AREA, SECOND = np.pi * RADIUS**2, 0.25 * np.pi * RADIUS**4
CENTRE = (0.1, 0.05, 0.2)
POLAR, DIAMETRAL, TILT = 0.08, 0.05, 4e4


def whirl_of_a_shaft(speed: float, half_waves: int) -> np.ndarray:
    """Return |omega| of a pinned Timoshenko shaft, forward and backward [rad/s].

    Deflection W sin kx and slope P cos kx turn with exp(i omega t); the determinant of
    both equations is a polynomial in omega.
    """
    k = half_waves * np.pi / LENGTH
    shear = BeamSection(LENGTH, 2 * RADIUS).shear_factor(0.3)
    shear *= STEEL.youngs_modulus / 2.6 * AREA
    mass = np.array([-STEEL.density * AREA, 0.0, shear * k**2])
    inertia = STEEL.density * SECOND
    bend = STEEL.youngs_modulus * SECOND * k**2 + shear
    tilt = np.array([-inertia, 2.0 * inertia * speed, bend])
    whole = np.polysub(np.polymul(mass, tilt), [(shear * k) ** 2])
    return np.sort(np.abs(np.roots(whole)))


@pytest.mark.parametrize("speed", [0.0, 500.0, 3000.0])
@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
def test_a_turning_shaft_whirls_as_its_closed_form(speed, axis):
    """Forward and backward modes of one and two half waves: a Campbell diagram."""
    section = BeamSection(LENGTH, 2 * RADIUS, elements=24)
    beam = beam_body("shaft", (0, 0, 0), axis, [section], STEEL)
    size = beam.mass.shape[0]
    along = int(np.argmax(axis))
    held = [6 * node + i for node in (0, size // 6 - 1) for i in range(3)]
    held += [6 * node + i for node in range(size // 6) for i in (along, 3 + along)]
    free = np.setdiff1d(np.arange(size), held)
    own = np.ix_(free, free)
    k, m, g = (
        one.toarray()[own] for one in (beam.stiffness, beam.mass, beam.gyroscopic)
    )
    zero, one = np.zeros_like(k), np.eye(free.size)
    state = np.block([[zero, one], [-np.linalg.solve(m, k), -np.linalg.solve(m, g)]])
    state[free.size :, free.size :] *= speed
    found = np.sort(np.abs(np.linalg.eigvals(state).imag))[::2][:4]
    wanted = [whirl_of_a_shaft(speed, waves)[:2] for waves in (1, 2)]
    assert found == pytest.approx(np.sort(np.concatenate(wanted)), rel=2e-3)
    if speed:
        assert found[1] > 1.001 * found[0]


def disc(speed: float) -> Machine:
    """Return a disc on springs to the ground beside a bed."""
    bed = solid_body("bed", box_mesh((0.2, 0.1, 0.05), (1, 1, 1)), STEEL)
    structure = build_structure([bed], [], supports=[Support("bed", "z-")])
    piece = Attachment(CENTRE)
    spring = MachineSpring(
        "bearing",
        ("disc", "ground"),
        (piece, piece),
        (0.0, 1.0, 0.0),
        (1e9, 1e9, 1e9, 1e6, TILT, TILT),
        # So little that poles do not move, and lines do not meet them.
        (1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3),
    )
    inertia = (DIAMETRAL, POLAR, DIAMETRAL)
    return Machine(
        structure,
        (),
        (RigidPart("disc", CENTRE, 10.0, inertia, (0.0, 1.0, 0.0)),),
        {},
        (spring,),
        {"tool": MachinePoint("disc", CENTRE)},
        {"disc": speed} if speed else {},
    )


def test_a_disc_on_springs_tilts_forward_and_backward():
    """J_d w^2 -+ J_p Omega w - k = 0."""
    speed = 700.0
    reduced = reduce_machine(disc(speed), 600.0)
    lean = lean_machine(reduced, 600.0)
    state = lean.state(jointed(reduced))
    found = np.sort(np.abs(state.poles.poles))[:2]
    half = 0.5 * POLAR * speed / DIAMETRAL
    root = np.sqrt(half**2 + TILT / DIAMETRAL)
    assert found == pytest.approx([root - half, root + half], rel=1e-6)
    result = analyse_machine(reduced, MachineRequest(600.0, modes=2, samples=20))
    assert result.jointed.tool.bound is None
    at_rest = np.sqrt(TILT / DIAMETRAL) / (2 * np.pi)
    assert result.jointed.modes.natural_frequency == pytest.approx(at_rest, rel=1e-6)


def test_a_body_without_an_axis_does_not_turn():
    """A meshed body cannot have a speed."""
    machine = disc(0.0)
    with pytest.raises(UsageError, match="beams, and rigid bodies with an axis"):
        Machine(
            machine.structure,
            (),
            machine.rigid,
            {},
            machine.springs,
            machine.points,
            {"bed": 10.0},
        )
