"""Rigid is what strains nothing: soft joints keep their modes, free bodies theirs."""

import numpy as np
import pytest
from scipy.sparse import csc_array
from scipy.sparse.linalg import spsolve

from jointbench.analysis.structures.matrices.element_assembly import (
    Material,
    Sparse,
    assemble,
)
from jointbench.analysis.structures.matrices.mesh_files import matrix_body
from jointbench.analysis.structures.matrices.parts import (
    GROUND,
    Joint,
    Support,
    SupportKind,
    solid_body,
)
from jointbench.analysis.structures.matrices.structure import Structure, build_structure
from jointbench.analysis.structures.meshes.mesh import Mesh, box_mesh
from jointbench.analysis.structures.meshes.polygons import rectangle
from jointbench.analysis.structures.reduction.full_modes import lowest_modes, solve_full
from jointbench.analysis.structures.reduction.mounted_sensors import (
    MountedSensor,
    readout,
    sensor_rows,
)
from jointbench.analysis.structures.reduction.predict_modes import (
    JointValues,
    modal_state,
    predict_modes,
)
from jointbench.analysis.structures.reduction.predict_response import (
    predict_complex_modes,
    predict_frf,
    response_to_force,
)
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    frequency_bound,
    solve_reduced,
)

STEEL = Material(youngs_modulus=200e9, poisson_ratio=0.3, density=7850.0)
# The guide joint printed in the 2025 paper's Table 3, with light damping.
GUIDE = JointValues(
    np.array([5.003e5, 8.977e7, 5.197e5]), np.array([400.0, 9e3, 500.0])
)
TABLE = (0.8, 0.6, 0.0625)
CENTRE = MountedSensor("tool", "table", (0.4, 0.3, 0.0625), (0, 0, 1))


@pytest.fixture(scope="module")
def table() -> Structure:
    """A table of 235 kg whose four corners stand on the ground."""
    body = solid_body("table", box_mesh(TABLE, (4, 4, 1)), STEEL)
    pads = tuple(
        rectangle((x, x + 0.2), (y, y + 0.15)) for x in (0.0, 0.6) for y in (0.0, 0.45)
    )
    guide = Joint("guide", ("table", GROUND), patches=pads, face="z-")
    return build_structure([body], [guide])


@pytest.fixture(scope="module")
def swinging(table: Structure) -> ReducedModel:
    """The table, reduced for eight modes."""
    loads = sensor_rows(table, [CENTRE])
    return reduce_structure(table, modes=8, box=(1e5, 1e9), tolerance=1e-6, loads=loads)


def test_a_heavy_table_on_a_soft_joint_keeps_its_slow_modes(
    table: Structure, swinging: ReducedModel
) -> None:
    """235 kg on the printed guide: sqrt(k/m) is 7.3 Hz along, 7.5 Hz across."""
    mass = STEEL.density * np.prod(TABLE)
    wanted = np.sqrt(GUIDE.stiffness[[0, 2]] / mass) / (2 * np.pi)
    np.testing.assert_allclose(wanted, [7.34, 7.48], atol=0.01)
    full = solve_full(table, GUIDE.stiffness, 8).natural_frequency
    predicted = predict_modes(swinging, GUIDE)
    for found in (full, predicted.natural_frequency):
        # The joint lies below the centre of mass: across, the table rocks a little.
        for one, limit in zip(wanted, (2e-3, 3e-2), strict=True):
            assert np.abs(found / one - 1).min() < limit
    np.testing.assert_allclose(predicted.natural_frequency, full, rtol=1e-6)
    _, bound = frequency_bound(swinging, GUIDE.stiffness)
    assert np.all(predicted.natural_frequency - full <= bound + 1e-7 * full)
    # Damping ratio c / (2 m omega) of the bounce.
    at = int(np.argmin(np.abs(full - wanted[0])))
    ratio = GUIDE.damping[0] / (2 * mass * 2 * np.pi * wanted[0])
    assert predicted.damping_ratio[at] == pytest.approx(ratio, rel=5e-3)
    frequency, damping = predict_complex_modes(swinging, GUIDE)
    np.testing.assert_allclose(frequency[at], full[at], rtol=5e-3)
    np.testing.assert_allclose(damping[at], ratio, rtol=5e-3)


def test_the_response_below_a_soft_mode_is_that_of_the_whole_mesh(
    table: Structure, swinging: ReducedModel
) -> None:
    """100 N at 2 Hz: receptance by one solve of the mesh, and the record it makes."""
    omega, rate, seconds = 2 * np.pi * 2.0, 512.0, 16
    rows, load = readout(table, swinging, [CENTRE]), sensor_rows(table, [CENTRE])[0]
    damper = sum(c * g for c, g in zip(GUIDE.damping, table.spread, strict=True))
    dynamic = table.with_joints(GUIDE.stiffness) - omega**2 * table.mass
    exact = load @ spsolve(csc_array(dynamic + 1j * omega * damper), load + 0j)
    found = predict_frf(swinging, GUIDE, np.array([1j * omega]), rows, rows)
    assert abs(found.response[0, 0, 0] / exact - 1) < 1e-5
    time = np.arange(int(seconds * rate)) / rate
    # Switched on gently: the table's own swing stays far below the forced one.
    grown = 0.5 - 0.5 * np.cos(np.pi * np.minimum(time / 8.0, 1.0))
    moved = response_to_force(
        swinging, GUIDE, (100.0 * grown * np.sin(omega * time))[None], rate, rows, rows
    )[0]
    late = time >= 12.0
    wanted = 100.0 * np.imag(exact * np.exp(1j * omega * time[late]))
    assert np.abs(moved[late] - wanted).max() < 1e-4 * np.abs(wanted).max()


def test_however_soft_a_joint_is_it_holds(table: Structure) -> None:
    """One newton a metre swings at 0.01 Hz; none at all is a free body."""
    held = solve_full(table, np.array([1.0, 0.0, 0.0]), 8).natural_frequency
    assert np.count_nonzero(held == 0) == 3
    bounce = np.sqrt(1.0 / 235.5) / (2 * np.pi)
    assert np.abs(held[3:6] / bounce - 1).min() < 1e-2
    free = solve_full(table, np.zeros(3), 8).natural_frequency
    assert np.count_nonzero(free == 0) == 6


def test_free_bodies_rest_at_exactly_zero(plates: Structure) -> None:
    """Six motions of two joined plates; twelve of the loose ones."""
    stiffness = np.array([1e3, 1e2, 1e10])
    assert np.all(solve_full(plates, stiffness, 14).natural_frequency[:6] == 0.0)
    assert solve_full(plates, stiffness, 14).natural_frequency[6] > 0.0
    assert np.all(solve_full(plates, np.zeros(3), 14).natural_frequency[:12] == 0.0)


def test_a_reduced_model_knows_its_mechanisms_at_any_joint(
    reduced: ReducedModel,
) -> None:
    """Each slack direction frees what it alone holds, exactly."""
    for stiffness, rigid in (
        ((1e9, 1e9, 1e9), 6),
        ((1.0, 1e-3, 1e10), 6),
        ((0.0, 1e9, 1e9), 9),
        ((1e9, 0.0, 1e9), 7),
        ((1e9, 0.0, 0.0), 9),
        ((0.0, 0.0, 0.0), 12),
    ):
        values = np.array(stiffness)
        found = solve_reduced(reduced, values)
        assert found.rigid == rigid
        assert np.all(found.eigenvalue[:rigid] == 0.0)
        assert np.all(found.eigenvalue[rigid:] > 0.0)
        state = modal_state(reduced, values)
        span = state.shapes.T @ state.shapes
        np.testing.assert_allclose(span, np.eye(reduced.size), atol=1e-10)


def test_a_dashpot_without_a_spring_leaves_the_other_modes_alone(
    reduced: ReducedModel,
) -> None:
    """A slack direction with damping: its decays are no modes, the rest swing."""
    values = JointValues(np.array([1e9, 0.0, 1e9]), np.array([0.0, 50.0, 0.0]))
    frequency, damping = predict_complex_modes(reduced, values)
    undamped = predict_modes(reduced, values).natural_frequency
    np.testing.assert_allclose(frequency[:3], undamped[:3], rtol=1e-3)
    assert np.all(damping < 0.1)


def test_soft_supports_are_no_mechanism(marble: Material) -> None:
    """A plate of 19.5 kg on 10 N/m bounces at 0.11 Hz; what nothing holds is rigid."""
    body = solid_body("plate", box_mesh((0.5, 0.3, 0.05), (3, 2, 1)), marble)
    top = solid_body(
        "top", box_mesh((0.5, 0.3, 0.05), (3, 2, 1), origin=(0, 0, 0.05)), marble
    )
    springs = Support("plate", "z-", SupportKind.SPRINGS, (10.0, 0.0, 0.0))
    joint = Joint("joint", ("plate", "top"))
    structure = build_structure([body, top], [joint], supports=[springs])
    full = solve_full(structure, np.full(3, 1e8), 8).natural_frequency
    assert np.all(full[:3] == 0.0)
    bounce = np.sqrt(10.0 / 39.0) / (2 * np.pi)
    assert np.abs(full[3:6] / bounce - 1).min() < 1e-2


def test_matrices_alone_tell_rigid_from_slow_by_rounding(table: Structure) -> None:
    """Without a mesh, energy that rounding makes counts as none, and no other."""
    found = lowest_modes(table.stiffness, table.mass, 8).natural_frequency
    assert np.all(found[:6] == 0.0)
    assert found[6] > 1.0
    whole = table.with_joints(GUIDE.stiffness)
    assert lowest_modes(whole, table.mass, 8).natural_frequency[0] > 5.0


def rounded(matrix: Sparse, digits: int) -> Sparse:
    """Return a matrix as text with few digits gives it back."""
    data = np.array([float(f"{one:.{digits - 1}e}") for one in matrix.data.tolist()])
    return Sparse((data, matrix.indices, matrix.indptr), shape=matrix.shape)


def test_matrices_of_few_digits_have_rigid_motions_too(marble: Material) -> None:
    """Another program's text of eight digits: six motions at exactly zero."""
    mesh = box_mesh((0.5, 0.3, 0.05), (3, 2, 1))
    stiffness, mass = assemble(mesh, marble)
    body = matrix_body("plate", mesh, rounded(stiffness, 8), rounded(mass, 8))
    structure = build_structure([body], [Joint("bed", ("plate", GROUND), face="z-")])
    exact = build_structure(
        [solid_body("plate", mesh, marble)],
        [Joint("bed", ("plate", GROUND), face="z-")],
    )
    for joint in ((0.0, 0.0, 0.0), (1e9, 1e9, 1e9)):
        found = solve_full(structure, np.array(joint), 8).natural_frequency
        wanted = solve_full(exact, np.array(joint), 8).natural_frequency
        np.testing.assert_array_equal(found == 0, wanted == 0)
        np.testing.assert_allclose(found, wanted, rtol=1e-4)


def test_a_body_of_two_pieces_has_twelve_rigid_motions(marble: Material) -> None:
    """Pieces that share no node move alone."""
    one = box_mesh((0.2, 0.1, 0.05), (2, 1, 1))
    nodes = np.concatenate([one.nodes, one.nodes + np.array([0.5, 0.0, 0.0])])
    cells = np.concatenate([one.cells, one.cells + one.nodes.shape[0]])
    both = solid_body("pair", Mesh(nodes, cells, one.kind), marble)
    structure = build_structure([both], [Joint("bed", ("pair", GROUND), face="z-")])
    found = solve_full(structure, np.zeros(3), 14).natural_frequency
    assert np.count_nonzero(found == 0) == 12
