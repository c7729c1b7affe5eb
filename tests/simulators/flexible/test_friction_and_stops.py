"""Laws without memory at ports."""

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.friction_and_stops import (
    BoltLaw,
    PortLawKind,
    PortMemory,
    law_bank,
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
