"""The bound of the tool's receptance, against full solves at random joint values."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.analysis.structures.machine.lean_machine import (
    LeanMachine,
    Variant,
    lean_machine,
)
from jointbench.analysis.structures.machine.machine_parts import (
    JointSetting,
    Machine,
    MachinePoint,
)
from jointbench.analysis.structures.machine.machine_result import ReceptanceBound
from jointbench.analysis.structures.machine.reduce_machine import reduce_machine
from jointbench.analysis.structures.machine.tool_bound import tool_bound
from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import Joint, Support, solid_body
from jointbench.analysis.structures.matrices.structure import build_structure, pick
from jointbench.analysis.structures.meshes.mesh import box_mesh

STEEL = Material(200e9, 0.3, 7850.0)
TOOL = MachinePoint("column", (0.05, 0.05, 0.6))
LINES = np.array([1.0, 60.0, 150.0, 350.0, 600.0])


@pytest.fixture(scope="module")
def machine() -> Machine:
    """A column on a bed on the ground, one joint, no loss."""
    bed = solid_body("bed", box_mesh((0.3, 0.1, 0.1), (3, 1, 1)), STEEL)
    mesh = box_mesh((0.1, 0.1, 0.5), (1, 1, 4), origin=(0.0, 0.0, 0.1))
    structure = build_structure(
        [bed, solid_body("column", mesh, STEEL)],
        [Joint("foot", ("column", "bed"))],
        supports=[Support("bed", "z-")],
    )
    setting = JointSetting((2e8, 1e8, 1e8), (3e3, 2e3, 2e3))
    return Machine(structure, (), (), {"foot": setting}, (), {"tool": TOOL})


@pytest.fixture(scope="module")
def lean(machine: Machine) -> LeanMachine:
    """The reduced machine."""
    return lean_machine(reduce_machine(machine, 600.0), 600.0)


def full_receptance(machine: Machine, values: Variant) -> np.ndarray:
    """Return the receptance at the tool from dense solutions of all equations."""
    structure = machine.structure
    rows = pick(structure, TOOL.body, TOOL.position).toarray()
    damping = sum(
        c * one for c, one in zip(values.damping, structure.spread, strict=True)
    ).toarray()
    stiffness = structure.with_joints(values.stiffness).toarray()
    mass = structure.mass.toarray()
    found = []
    for s in 2j * np.pi * LINES:
        dynamic = stiffness + s * damping + s**2 * mass
        found.append(rows @ np.linalg.solve(dynamic, rows.T))
    return np.stack(found, axis=2)


def test_the_bound_is_never_below_the_error_at_random_joint_values(machine, lean):
    """Three decades of stiffness and four of damping, overdamped joints among them."""
    random = np.random.default_rng(5)
    tight = 0
    for _ in range(12):
        values = Variant(
            10.0 ** random.uniform(7, 10, 3), 10.0 ** random.uniform(1, 5, 3)
        )
        state = lean.state(values)
        found = state.poles.receptance(LINES)
        error = np.abs(found - full_receptance(machine, values))
        bound = tool_bound(lean, values, state, "tool", LINES)
        assert np.all(error <= bound)
        size = np.abs(np.einsum("aal->al", found))
        tight += int((np.einsum("aal->al", bound) < 1e-2 * size).sum())
    assert tight > 0.7 * 12 * 3 * LINES.size


def test_a_basis_without_the_modes_of_the_band_has_no_bound(lean):
    """Above the modes of the basis nothing is known."""
    values = Variant(np.full(3, 1e8), np.full(3, 1e3))
    state = lean.state(values)
    bound = tool_bound(lean, values, state, "tool", np.array([1.0, 5e4]))
    assert np.isfinite(bound[..., 0]).all()
    assert np.isinf(bound[..., 1]).all()


def test_the_largest_bound_leaves_antiresonances_out():
    """A single line far below its neighbours does not count."""
    size = np.ones((3, 50))
    error = np.full((3, 50), 1e-4)
    size[1, 20] = 1e-3
    found = ReceptanceBound(np.arange(50.0), size, error)
    assert found.largest == pytest.approx(1e-4)
    closer = replace(found, error=np.where(np.arange(50) == 7, 3e-4, error))
    assert closer.largest == pytest.approx(3e-4)
