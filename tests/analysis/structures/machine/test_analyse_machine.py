"""A machine of solids, a beam and a rigid body against its unreduced matrices."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.linalg import block_diag, eigh

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.machine.analyse_machine import analyse_machine
from jointbench.analysis.structures.machine.lean_machine import (
    jointed,
    lean_machine,
)
from jointbench.analysis.structures.machine.loads import Begin, HarmonicLoad
from jointbench.analysis.structures.machine.machine_parts import Machine
from jointbench.analysis.structures.machine.machine_request import (
    Cut,
    MachineRequest,
    TimeSpan,
)
from jointbench.analysis.structures.machine.machine_result import MachineResult
from jointbench.analysis.structures.machine.reduce_machine import (
    ReducedMachine,
    reduce_machine,
)
from jointbench.analysis.structures.matrices.surface_motion import (
    motion_of_piece,
    rotated,
)

BAND = 600.0
LOADS = tuple(HarmonicLoad(axis, 100.0, 600.0) for axis in range(3))
REQUEST = MachineRequest(
    BAND,
    modes=6,
    lines=200,
    samples=20,
    loads=LOADS,
    span=TimeSpan(0.1, 1e-3, Begin.STEADY),
    cut=Cut(2e9, (0, 0, 1), (0, 1, 1), (10.0, 100.0)),
)


@dataclass(frozen=True)
class Whole:
    """Matrices of the whole machine, no reduction."""

    stiffness: np.ndarray
    damping: np.ndarray
    loss: np.ndarray
    mass: np.ndarray
    tool: np.ndarray


@pytest.fixture(scope="module")
def whole(machine: Machine) -> Whole:
    """Assembled by hand: solids, beam, rigid body, joint, springs."""
    solids, beam, wheel = machine.structure, machine.beams[0], machine.rigid[0]
    size, ends = solids.size, 6 * len(beam.nodes)
    setting = machine.settings["foot"]
    joint = [
        sum(v * g for v, g in zip(values, solids.spread, strict=True)).toarray()
        for values in (setting.stiffness, setting.damping)
    ]
    bar, mass = beam.stiffness.toarray(), beam.mass.toarray()
    inert = np.diag([*[wheel.mass] * 3, *wheel.inertia])
    bodies = block_diag(solids.stiffness.toarray(), bar, np.zeros((6, 6)))
    total = size + ends + 6
    k = bodies + block_diag(joint[0], np.zeros((ends + 6, ends + 6)))
    c = block_diag(joint[1], np.zeros((ends + 6, ends + 6)))
    for spring in machine.springs:
        place = spring.pieces[0].position
        rows = np.zeros((6, total))
        if spring.name == "flange":
            rows[:, size + ends :] = np.eye(6)
            rows[:, size : size + ends] -= beam.motion_at(place).toarray()
        else:
            mesh = solids.bodies[1].mesh
            first = 3 * int(solids.first_node[1])
            own = np.zeros((6, 3 * int(solids.first_node[-1])))
            piece = motion_of_piece("housing", mesh, spring.pieces[1])
            own[:, first:] = rotated(piece, spring.axis).toarray()
            rows[:, :size] = -own[:, solids.free]
            turned = rotated(beam.motion_at(place), spring.axis)
            rows[:, size : size + ends] = turned.toarray()
        k += rows.T @ np.diag(spring.stiffness) @ rows
        c += rows.T @ np.diag(spring.damping) @ rows
    tool = np.zeros((3, total))
    tool[:, size + ends : size + ends + 3] = np.eye(3)
    return Whole(
        k, c, 0.002 * bodies, block_diag(solids.mass.toarray(), mass, inert), tool
    )


@pytest.fixture(scope="module")
def result(reduced: ReducedMachine) -> MachineResult:
    """The machine glued and jointed."""
    return analyse_machine(reduced, REQUEST)


def test_frequencies_are_those_of_the_whole(
    whole: Whole, result: MachineResult
) -> None:
    """1e-4, and never below; reduced by bodies and then by variants."""
    level = eigh(whole.stiffness, whole.mass, eigvals_only=True)[:6]
    exact = np.sqrt(level) / (2 * np.pi)
    found = result.jointed.modes.natural_frequency
    assert found == pytest.approx(exact, rel=1e-4)
    assert np.all(found >= exact * (1 - 1e-9))
    assert result.bound < 0.05


def test_the_receptance_is_that_of_the_whole_with_local_dampers(
    whole: Whole, result: MachineResult
) -> None:
    """1e-3 at lines between modes and on the first one; static too."""
    level, shape = eigh(whole.stiffness, whole.mass)
    # Structural loss as viscous damping of each mode, as in the product.
    own = np.einsum("ni,nm,mi->i", shape, whole.loss, shape) / np.sqrt(level)
    weighted = whole.mass @ shape
    damping = whole.damping + (weighted * own) @ weighted.T
    poles = result.jointed.poles
    first = result.jointed.modes.natural_frequency[0]
    for line in (0.0, 0.5 * first, first, 350.0):
        s = 2j * np.pi * line
        dynamic = whole.stiffness + s * damping + s**2 * whole.mass
        exact = whole.tool @ np.linalg.solve(dynamic, whole.tool.T)
        found = poles.receptance(np.array([line]))[:, :, 0]
        assert np.abs(found - exact).max() < 1e-3 * np.abs(exact).max()


def test_the_steady_motion_is_the_receptance_times_the_load(
    result: MachineResult,
) -> None:
    """All axes are loaded at 600 rad/s."""
    line = np.array([600.0 / (2 * np.pi)])
    answer = result.jointed.poles.receptance(line)[:, :, 0] @ np.full(3, 100.0)
    assert result.jointed.motion is not None
    moved = result.jointed.motion.displacement
    time = result.jointed.motion.time
    wanted = np.imag(np.outer(answer, np.exp(600j * time)))
    assert np.abs(moved - wanted).max() < 2e-3 * np.abs(wanted).max()


def test_energies_add_up_and_joints_lower_all_frequencies(
    result: MachineResult,
) -> None:
    """Shares of strain and of kinetic energy; glued joints take none."""
    for one in (result.glued, result.jointed):
        assert one.modes.energy.share.sum(axis=1) == pytest.approx(1.0)
        assert one.modes.motion.share.sum(axis=(1, 2)) == pytest.approx(1.0)
    soft, rigid = result.jointed.modes, result.glued.modes
    assert np.all(soft.natural_frequency < rigid.natural_frequency)
    joints = [rigid.energy.regions.index(n) for n in ("foot", "front", "rear")]
    assert not rigid.energy.share[:, joints].any()
    assert soft.energy.share[:, joints].sum() > 1.0


def test_the_costs_of_joints_and_bodies_are_the_static_compliance(
    result: MachineResult,
) -> None:
    """Shares of the compliance are at most one; a rigid joint never costs more."""
    share = np.array([one.static for one in result.costs])
    assert np.all(share.sum(axis=0) < 1.0)
    for one in result.costs:
        assert np.all(one.static_gain <= 1 - 0.99 * one.static)


def test_intervals_cover_the_nominal_machine(result: MachineResult) -> None:
    """Frequencies, static compliance and chatter limit; the flange is certain."""
    interval = result.frequency_interval
    assert interval is not None
    assert result.limit_interval is not None
    found = result.jointed.modes.natural_frequency
    assert np.all((interval[0] < found) & (found < interval[1]))
    tool = result.jointed.tool
    assert tool.static_interval is not None
    static = np.diag(tool.static)
    assert np.all(tool.static_interval[0] < static)
    assert np.all(static < tool.static_interval[1])
    low, high = result.limit_interval
    assert result.jointed.chatter is not None
    assert low < result.jointed.chatter.limit < high


def test_strong_dampers_make_modes_overdamped(reduced: ReducedMachine) -> None:
    """Real poles are counted, and modes without a partner have no ratio."""
    strong = replace(reduced, damping=3e3 * reduced.damping)
    found = analyse_machine(
        replace(strong, deviations=np.zeros_like(strong.deviations)),
        MachineRequest(BAND, modes=6, lines=100),
    )
    modes = found.jointed.modes
    assert modes.overdamped > 0
    assert np.isnan(modes.damping_ratio[modes.first_order > 10.0]).all()


def test_a_machine_without_dampers_has_the_loss_of_its_bodies(
    reduced: ReducedMachine,
) -> None:
    """Half the loss factor times the energy share of the bodies."""
    still = replace(reduced, damping=np.zeros_like(reduced.damping))
    lean = lean_machine(still, BAND)
    state = lean.state(jointed(still))
    ratio = state.poles.damping_ratio[:3]
    assert np.all((ratio > 0.0) & (ratio <= 0.001 * (1 + 1e-6)))


def test_a_floating_body_is_named(machine: Machine) -> None:
    """The wheel without its flange."""
    loose = replace(machine, springs=machine.springs[:2])
    with pytest.raises(BadData, match="'wheel' can move in 6 ways"):
        analyse_machine(reduce_machine(loose, BAND), REQUEST)


def test_names_that_there_are_not(machine: Machine, reduced: ReducedMachine) -> None:
    """A point, and a body of a spring."""
    with pytest.raises(UsageError, match="no point 'nose'"):
        analyse_machine(reduced, replace(REQUEST, tool="nose"))
    wrong = replace(machine.springs[0], between=("spindel", "housing"))
    with pytest.raises(UsageError, match="it must join"):
        replace(machine, springs=(wrong,))


def test_coupled_matrices_are_springs_when_they_are_diagonal(
    machine: Machine, result: MachineResult
) -> None:
    """The same machine with its front bearing as two matrices of six rows."""
    front = machine.springs[0]
    coupled = replace(
        front, matrices=(np.diag(front.stiffness), np.diag(front.damping))
    )
    other = replace(machine, springs=(coupled, *machine.springs[1:]))
    plain = replace(REQUEST, samples=20, span=None, cut=None)
    found = analyse_machine(reduce_machine(other, BAND), plain)
    for one, same in ((found.glued, result.glued), (found.jointed, result.jointed)):
        assert one.modes.natural_frequency == pytest.approx(
            same.modes.natural_frequency, rel=1e-6
        )
        assert one.modes.energy.share == pytest.approx(
            same.modes.energy.share, abs=1e-6
        )
    ratio = found.jointed.modes.damping_ratio
    assert ratio == pytest.approx(result.jointed.modes.damping_ratio, rel=1e-5)
    with pytest.raises(BadData, match="is not symmetric"):
        replace(coupled, matrices=(np.eye(6) + np.eye(6, k=1), np.eye(6)))
