"""Laws without memory at ports."""

import numpy as np
import pytest

from jointbench.simulators.flexible.friction_and_stops import (
    BoltLaw,
    PortLawKind,
    forces_along,
)

ROW = np.ones(1)


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
    found = forces_along(BoltLaw(kind, ROW, parameters), np.array([motion]))
    assert found[0] == pytest.approx(force)
