"""Bodies reduced one by one and closed over their joints."""

from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csc_array
from scipy.sparse.linalg import spsolve

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.element_assembly import Material, Sparse
from jointbench.analysis.structures.matrices.parts import Joint, Support, solid_body
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    build_structure,
    pick,
)
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.reduction.assembled import (
    Assembled,
    assemble_components,
)
from jointbench.analysis.structures.reduction.component import (
    BodyMatrices,
    point_port,
)
from jointbench.analysis.structures.reduction.full_modes import solve_full
from jointbench.analysis.structures.reduction.port_joints import PortJoint, PortSpring
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduce import reduce_machine
from jointbench.analysis.structures.reduction.reduce_body import reduce_body
from jointbench.analysis.structures.reduction.structure_bodies import LOADS

MODES = 12
BAND = 1500.0
TOOL = ("head", (0.35, 0.2, 0.45))


@pytest.fixture(scope="module")
def column(marble: Material) -> Structure:
    """A bed, a column and a head; six stiffnesses; the bed is fixed."""
    bodies = [
        solid_body("bed", box_mesh((0.5, 0.4, 0.1), (4, 3, 1)), marble),
        solid_body(
            "column",
            box_mesh((0.15, 0.3, 0.4), (1, 2, 3), origin=(0, 0.05, 0.1)),
            marble,
        ),
        solid_body(
            "head",
            box_mesh((0.2, 0.1, 0.1), (2, 1, 1), origin=(0.15, 0.15, 0.35)),
            Material(200e9, 0.3, 7850.0, 0.002),
        ),
    ]
    joints = [Joint("foot", ("column", "bed")), Joint("neck", ("head", "column"))]
    return build_structure(bodies, joints, supports=[Support("bed", "z-")])


@pytest.fixture(scope="module")
def machine(column: Structure) -> Assembled:
    """The machine, reduced up to 1.5 kHz."""
    load = pick(column, *TOOL).toarray()
    return reduce_machine(column, BAND, modes=MODES, loads=load)


def test_frequencies_are_those_of_the_full_mesh_in_six_decades(
    column: Structure, machine: Assembled
) -> None:
    """At random joints, within 1e-4, and the bound holds."""
    random = np.random.default_rng(5)
    for _ in range(6):
        point = 10.0 ** random.uniform(5, 11, 6)
        values = JointValues(point, np.zeros(6))
        found, shapes = machine.modes(values, MODES)
        full = solve_full(column, point, MODES).natural_frequency
        error = found / full - 1.0
        assert np.all(np.abs(error[full < BAND]) < 1e-4)
        assert np.all(error <= machine.bound(values, MODES) / found + 1e-7)
        shares = machine.energy(values, shapes[:, 0])
        assert sum(shares.values()) == pytest.approx(1.0)


def test_the_softest_modes_are_there(column: Structure, machine: Assembled) -> None:
    """A column of 47 kg on 1e4 N/m, from 2 Hz on."""
    point = np.array([1e4, 1e4, 1e4, 1e9, 1e9, 1e9])
    found, _ = machine.modes(JointValues(point, np.zeros(6)), 6)
    full = solve_full(column, point, 6).natural_frequency
    assert found[0] < 3.0
    np.testing.assert_allclose(found, full, rtol=1e-6)


@pytest.mark.parametrize("damping", [1e2, 1e5])
def test_the_receptance_is_that_of_the_full_mesh(
    column: Structure, machine: Assembled, damping: float
) -> None:
    """With light dampers and with some that hold their joints."""
    values = JointValues(np.array([5e8, 2e8, 2e8] * 2), np.full(6, damping))
    frequency = np.array([20.0, 131.0, 305.0, 590.0])
    rows, load = machine.rows((TOOL[0], LOADS)), pick(column, *TOOL).toarray()
    found = machine.frf(values, frequency, rows, rows)
    damper = damping * sum(column.spread, Sparse(column.mass.shape))
    whole = column.with_joints(values.stiffness) + 1j * column.loss
    for at, s in enumerate(2j * np.pi * frequency):
        matrix = csc_array(whole + s * damper + s**2 * column.mass)
        exact = load @ spsolve(matrix, load.T + 0j)
        assert np.abs(found[:, :, at] - exact).max() < 1e-3 * np.abs(exact).max()


def test_strong_dampers_leave_decays(machine: Assembled) -> None:
    """The printed dampers are far above critical; light ones give half their share."""
    stiffness = np.array([5e8, 2e8, 2e8] * 2)
    strong = machine.complex_modes(JointValues(stiffness, np.full(6, 1e6)))
    assert np.any(strong.overdamped)
    assert np.all(strong.pole.real <= 0)
    light = JointValues(stiffness, np.full(6, 10.0))
    modes = machine.complex_modes(light)
    undamped, _ = machine.modes(light, 3)
    np.testing.assert_allclose(modes.natural_frequency[:3], undamped, rtol=1e-4)
    assert not np.any(modes.overdamped[:3])


def test_a_cached_machine_is_the_same(column: Structure, tmp_path: Path) -> None:
    """Bodies and the whole are read back by content; a torn file is made again."""
    first = reduce_machine(column, 800.0, modes=MODES, order=1, cache=tmp_path)
    files = sorted(tmp_path.glob("*.npz"), key=lambda one: one.stat().st_mtime_ns)
    assert len(files) == 4
    for torn in (files[0], files[-1]):
        torn.write_bytes(b"PK torn")
    again = reduce_machine(column, 800.0, modes=MODES, order=1, cache=tmp_path)
    values = JointValues(np.full(6, 1e8), np.zeros(6))
    np.testing.assert_array_equal(first.modes(values, 8)[0], again.modes(values, 8)[0])
    np.testing.assert_array_equal(first.bound(values, 8), again.bound(values, 8))


def chain(count: int) -> BodyMatrices:
    """Return a free chain of unit masses and springs of 1 MN/m."""
    stiffness = np.diag(np.full(count, 2.0)) - np.eye(count, k=1) - np.eye(count, k=-1)
    stiffness[0, 0] = stiffness[-1, -1] = 1.0
    ends = np.ones((count, 1)) / np.sqrt(count)
    return BodyMatrices("chain", Sparse(1e6 * stiffness), Sparse(np.eye(count)), ends)


def test_springs_between_points_join_matrices_of_other_programs() -> None:
    """Two chains, a known spring between them and one to the ground: as assembled."""
    ports = [point_port("left", np.eye(8)[:1]), point_port("right", np.eye(8)[-1:])]
    one = reduce_body(chain(8), ports, 150.0)
    other = reduce_body(
        BodyMatrices("other", *(getattr(chain(8), n) for n in ("stiffness", "mass"))),
        ports,
        150.0,
    )
    assert one.rigid == other.rigid == 1
    spring = PortSpring(
        "wall", ("chain", "left"), None, np.array([[3e5]]), np.array([[10.0]])
    )
    joint = PortJoint("j", ("chain", "right"), ("other", "left"), ("x",))
    whole = assemble_components(
        [one, other], [joint], [spring], box=(1e4, 1e7), modes=6
    )
    values = JointValues(np.array([4e5]), np.array([20.0]))
    found, _ = whole.modes(values, 6)
    dense = np.zeros((16, 16))
    dense[:8, :8] = dense[8:, 8:] = chain(8).stiffness.toarray()
    dense[0, 0] += 3e5
    dense[7:9, 7:9] += 4e5 * np.array([[1, -1], [-1, 1]])
    wanted = np.sqrt(np.linalg.eigvalsh(dense)[:6]) / (2 * np.pi)
    np.testing.assert_allclose(found, wanted, rtol=1e-6)
    assert whole.energy(values, whole.modes(values, 1)[1][:, 0])["wall"] > 0.1


def test_what_cannot_be_reduced_is_refused_in_one_line() -> None:
    """Unsymmetric matrices, unknown ports, ports that do not fit, negative springs."""
    skew = Sparse(np.array([[1.0, 0.5], [0.0, 1.0]]))
    with pytest.raises(BadData, match=r"not symmetric: entries differ by 0\.5"):
        BodyMatrices("b", skew, Sparse(np.eye(2)))
    with pytest.raises(BadData, match="must be equal"):
        BodyMatrices("b", Sparse(np.eye(3)), Sparse(np.eye(2)))
    ports = [point_port("end", np.eye(8)[:1]), point_port("all", np.eye(8)[:2])]
    one = reduce_body(chain(8), ports, 100.0)
    with pytest.raises(BadData, match="share a name"):
        reduce_body(chain(8), [ports[0], ports[0]], 100.0)
    with pytest.raises(BadData, match="above 0 Hz"):
        reduce_body(chain(8), ports, 0.0)
    far = PortJoint("j", ("chain", "middle"), None, ("x",))
    with pytest.raises(UsageError, match="no port 'middle'; it has"):
        assemble_components([one], [far], box=(1e4, 1e7), modes=3)
    odd = PortJoint("j", ("chain", "all"), ("chain", "end"), ("x",))
    with pytest.raises(BadData, match="both sides need the same number"):
        assemble_components([one], [odd], box=(1e4, 1e7), modes=3)
    with pytest.raises(BadData, match="must not give energy"):
        PortSpring("s", ("chain", "end"), None, -np.eye(1), np.eye(1))
