"""A heavy block on a soft joint: one mass on one spring, in closed form."""

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import GROUND, Joint, solid_body
from jointbench.analysis.structures.matrices.structure import Structure, build_structure
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.reduction.mounted_sensors import (
    MountedSensor,
    readout,
    sensor_rows,
)
from jointbench.analysis.structures.reduction.predict_modes import (
    JointValues,
    predict_modes,
)
from jointbench.analysis.structures.reduction.predict_response import (
    predict_complex_modes,
    predict_frf,
    response_to_force,
)
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel

MASS = 2600.0 * 0.2 * 0.2 * 0.1
SOFT = JointValues(np.array([1e6, 4e6, 9e6]), np.array([400.0, 0.0, 0.0]))
TOP = MountedSensor("top", "block", (0.1, 0.1, 0.1), (0, 0, 2))


@pytest.fixture(scope="module")
def block(marble: Material) -> Structure:
    """A block of 10.4 kg on the ground."""
    body = solid_body("block", box_mesh((0.2, 0.2, 0.1), (2, 2, 1)), marble)
    return build_structure([body], [Joint("bed", ("block", GROUND), face="z-")])


@pytest.fixture(scope="module")
def small(block: Structure) -> ReducedModel:
    """The block, reduced."""
    return reduce_structure(
        block, modes=7, box=(1e5, 1e8), loads=sensor_rows(block, [TOP])
    )


def test_bouncing_is_a_mass_on_a_spring(block: Structure, small: ReducedModel) -> None:
    """Frequency sqrt(k/m), damping c / (2 sqrt(k m)), all energy in the normal."""
    found = predict_modes(small, SOFT, readout(block, small, [TOP]))
    at = int(np.argmax(np.abs(found.shapes[:6, 0])))
    wanted = np.sqrt(1e6 / MASS) / (2 * np.pi)
    assert found.natural_frequency[at] == pytest.approx(wanted, rel=1e-3)
    ratio = 400.0 / (2 * np.sqrt(1e6 * MASS))
    assert found.damping_ratio[at] == pytest.approx(ratio, rel=3e-3)
    assert found.energy_share[at, 0] == pytest.approx(1.0, abs=3e-3)
    frequency, damping = predict_complex_modes(small, SOFT)
    near = int(np.argmin(np.abs(frequency - wanted) + 1e3 * (damping < 0.5 * ratio)))
    assert damping[near] == pytest.approx(ratio, rel=3e-3)


def test_at_its_natural_frequency_only_damping_holds_it(
    block: Structure, small: ReducedModel
) -> None:
    """Receptance 1 / (c omega) at sqrt(k/m), 1 / k far below."""
    rows = readout(block, small, [TOP])
    omega = np.array([1.0, np.sqrt(1e6 / MASS)])
    found = predict_frf(small, SOFT, 1j * omega, rows, rows)
    size = np.abs(found.response[0, 0])
    assert size[0] == pytest.approx(1e-6, rel=5e-3)
    assert size[1] == pytest.approx(1 / (400.0 * omega[1]), rel=2e-2)


def test_a_slow_push_is_answered_by_force_over_stiffness(
    block: Structure, small: ReducedModel
) -> None:
    """Half a sine of 2 s on a block of 49 Hz: the displacement follows the force."""
    rows = readout(block, small, [TOP])
    time = np.arange(4096) / 1024.0
    force = np.where(time < 2.0, np.sin(np.pi * time / 2.0), 0.0)
    moved = response_to_force(small, SOFT, force[None], 1024.0, rows, rows)[0]
    # The corners of the force shake the block by about (pi/2) / omega of its peak.
    assert np.abs(moved - force * 1e-6).max() < 1.2e-8


def test_a_sensor_beside_the_body_is_refused(
    block: Structure, small: ReducedModel
) -> None:
    """So is one on a body that does not exist, or without a direction."""
    with pytest.raises(BadData, match=r"is not on the body|is .* from"):
        readout(block, small, [MountedSensor("s", "block", (0.3, 0.1, 0.1), (0, 0, 1))])
    with pytest.raises(UsageError, match="no body 'wheel'"):
        readout(block, small, [MountedSensor("s", "wheel", (0.1, 0.1, 0.1), (0, 0, 1))])
    with pytest.raises(BadData, match="no direction"):
        readout(block, small, [MountedSensor("s", "block", (0.1, 0.1, 0.1), (0, 0, 0))])
