"""Laws at ports, moved along given motions."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.friction_and_stops import (
    BoltLaw,
    PortLawKind,
    PortMemory,
    law_bank,
    power_law_sliders,
)

ROW = np.ones(1)


def forces(law: BoltLaw, path: FloatArray) -> FloatArray:
    """Return the force of a law along a path of its port [N]."""
    bank = law_bank((law,), 1)
    assert bank is not None
    memory, found = PortMemory(bank, 1), []
    for r in path:
        point = np.array([[r], [0.0]])
        memory.commit(np.vstack((point, point)), point)
        found.append(float(memory.force[0, 0]))
    return np.array(found)


def slider(slip: float) -> BoltLaw:
    """Return one slider with all of a stiffness of 1 N/m."""
    return BoltLaw(PortLawKind.FRICTION, ROW, (1.0, 0.0), np.ones(1), np.array([slip]))


def test_a_slider_loads_along_a_hyperbolic_tangent() -> None:
    """Wen's equation with n = 2: z = phi tanh(r / phi); the law adds z - r."""
    path = np.linspace(0, 3, 31)
    assert_allclose(forces(slider(1.0), path) + path, np.tanh(path), atol=2e-5)


def test_a_slider_unloads_along_its_spring() -> None:
    """Back by less than its load, the slope is that of the spring."""
    found = forces(slider(1.0), np.array([2.0, 1.5])) + np.array([2.0, 1.5])
    assert found[0] - found[1] == pytest.approx(0.5)


def test_a_loop_loses_energy_and_closes() -> None:
    """Unloading by F, then tanh over 2 A - F: its area is 2 ln cosh(2 A - F) - F^2."""
    turn = np.linspace(0, 6 * np.pi, 3001)
    path = 2.0 * np.sin(turn)
    force = forces(slider(1.0), path) + path
    assert_allclose(force[2001:3001:50], force[1001:2001:50], atol=1e-3)
    area = float(np.sum(0.5 * (force[2001:] + force[2000:-1]) * np.diff(path[2000:])))
    largest = float(force[2001:].max())
    expected = 2 * np.log(np.cosh(4 - largest)) - largest**2
    assert area == pytest.approx(expected, rel=2e-3)


def test_the_sliders_of_a_power_law_hold_the_whole_stiffness() -> None:
    """Weights add up to 1; slip displacements rise up to the largest one."""
    weights, slips = power_law_sliders(2e-5, -0.4)
    assert float(weights.sum()) == pytest.approx(1.0)
    assert np.all(np.diff(slips) > 0)
    assert slips[-1] < 2e-5


@pytest.mark.parametrize(
    ("kind", "parameters", "motion", "force"),
    [
        (PortLawKind.STOP, (3.0, 0.5), 1.0, 1.5),
        (PortLawKind.STOP, (3.0, 0.5), 0.4, 0.0),
        (PortLawKind.CUBIC, (2.0, 0.0), -0.5, -0.25),
        (PortLawKind.QUADRATIC, (2.0, 0.0), -0.5, 0.5),
        (PortLawKind.SLOT, (4.0, 0.5), -1.0, -2.0),
        (PortLawKind.LIFT_OFF, (4.0, 0.5), 1.0, -2.0),
    ],
)
def test_laws_without_memory_have_their_closed_forms(
    kind: PortLawKind, parameters: tuple[float, float], motion: float, force: float
) -> None:
    """One motion, one force."""
    found = forces(BoltLaw(kind, ROW, parameters), np.array([motion]))
    assert found[0] == pytest.approx(force)
