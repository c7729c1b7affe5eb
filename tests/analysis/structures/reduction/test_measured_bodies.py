"""Bodies that were struck alone, coupled by their modes and by their FRFs."""

from collections.abc import Sequence

import numpy as np
import pytest
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import solid_body
from jointbench.analysis.structures.matrices.structure import build_structure, pick
from jointbench.analysis.structures.measured.coupled_measurements import coupled_modes
from jointbench.analysis.structures.measured.frf_coupling import (
    FrfBlock,
    FrfLink,
    couple_frfs,
)
from jointbench.analysis.structures.measured.measured_body import (
    ModalTable,
    modal_body,
)
from jointbench.analysis.structures.measured.measured_frfs import fit_frfs
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.reduction.assembled import assemble_components
from jointbench.analysis.structures.reduction.component import BodySource
from jointbench.analysis.structures.reduction.port_joints import PortJoint
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from tests.judges.struck_bodies import Hammering, dense_modes, struck

BAND = (60.0, 1190.0)
STIFFNESS = 3e8
POINTS = ((0.05, 0.11, 0.12), (0.05, 0.19, 0.12), (0.3, 0.15, 0.12))
TIP = (0.5, 0.1, 0.14)


@pytest.fixture(scope="module")
def coupled(marble: Material) -> tuple[list[FrfBlock], FloatArray, FloatArray]:
    """A steel beam on a marble block: FRFs of each alone, modes of both together."""
    steel = Material(200e9, 0.3, 7850.0)
    size = ((0.5, 0.12, 0.02), (0.4, 0.3, 0.12))
    beam = solid_body(
        "beam", box_mesh(size[0], (7, 2, 1), origin=(0, 0.09, 0.12)), steel
    )
    block = solid_body("block", box_mesh(size[1], (4, 3, 1)), marble)
    rows, matrices, blocks = [], [], []
    random = np.random.default_rng(0)
    for body in (beam, block):
        whole = build_structure([body], [])
        own = [pick(whole, body.name, point).toarray() for point in POINTS]
        if body is beam:
            own.append(pick(whole, body.name, TIP).toarray()[2:])
        rows.append(np.concatenate(own))
        stiffness, mass = body.stiffness.toarray(), body.mass.toarray()
        modes = dense_modes(stiffness, mass)
        swing = mass @ modes[1]
        damping = 2.0 * Hammering().damping * (swing * modes[0]) @ swing.T
        matrices.append((stiffness, mass, damping))
        blocks.append(struck(body.name, modes, rows[-1], Hammering(), random))
    stiffness, mass, damping = (
        scipy.linalg.block_diag(*(one[k] for one in matrices)) for k in range(3)
    )
    tie = np.concatenate([rows[0][:9], -rows[1]], axis=1)
    stiffness += STIFFNESS * tie.T @ tie
    value, shapes = scipy.linalg.eigh(stiffness, mass, subset_by_index=(6, 9))
    small = shapes.T @ damping @ shapes
    state = np.block([[np.zeros((4, 4)), np.eye(4)], [-np.diag(value), -small]])
    pole = np.linalg.eigvals(state)
    pole = pole[pole.imag > 0]
    pole = pole[np.argsort(np.abs(pole))]
    return blocks, np.sqrt(value) / (2.0 * np.pi), -pole.real / np.abs(pole)


def lowest_elastic(tables: Sequence[ModalTable]) -> FloatArray:
    """Return the first three frequencies of the tables joined at three points."""
    beam = modal_body(tables[0], {"feet": range(9), "tip": [9]})
    block = modal_body(tables[1], {"top": range(9)})
    joint = PortJoint("feet", ("beam", "feet"), ("block", "top"), ("xyz",))
    whole = assemble_components([beam, block], [joint], box=(1e7, 1e9), modes=9)
    found, _ = whole.modes(JointValues(np.array([STIFFNESS]), np.zeros(1)), 10)
    return found[found > BAND[0]][:3]


def test_a_beam_on_a_block_from_the_hits_of_each_alone(
    coupled: tuple[list[FrfBlock], FloatArray, FloatArray],
) -> None:
    """The first three frequencies within 0.05 %, by their poles; intervals hold them.

    The modes above the band that a machine uses in their place are within 0.5 %.
    """
    blocks, truth, damping = coupled
    links = [FrfLink(("beam", at), ("block", at), STIFFNESS) for at in range(9)]
    found = coupled_modes(blocks, links, BAND, draws=20)
    error = np.abs(found.frequency[:3] - truth[:3])
    assert np.all(error < 5e-4 * truth[:3])
    assert np.all(error <= 2.0 * found.frequency_sd[:3])
    assert np.all(found.frequency_sd[:3] < 1e-3 * truth[:3])
    assert found.damping_ratio[:3] == pytest.approx(damping[:3], rel=0.03)
    tables = [fit_frfs(one, BAND).table() for one in blocks]
    np.testing.assert_allclose(lowest_elastic(tables), truth[:3], rtol=5e-3)


def test_what_the_frfs_hardly_determine_is_remarked_on(
    coupled: tuple[list[FrfBlock], FloatArray, FloatArray],
) -> None:
    """With 200 times the noise, the interval is wide and its cause is named."""
    blocks, _, _ = coupled
    random = np.random.default_rng(4)
    loud = []
    for one in blocks:
        noise = random.standard_normal((2, *one.variance.shape))
        add = 200.0 * np.sqrt(0.5 * one.variance) * (noise[0] + 1j * noise[1])
        loud.append(
            FrfBlock(
                one.name, one.frequency, one.receptance + add, 40001 * one.variance
            )
        )
    links = [FrfLink(("beam", at), ("block", at), STIFFNESS) for at in range(9)]
    found = coupled_modes(loud, links, BAND, draws=20)
    wide = 1.96 * found.frequency_sd > 5e-3 * found.frequency
    assert np.any(wide)
    assert len(found.remarks) == np.count_nonzero(wide)
    assert "average more hits" in found.remarks[0]


def test_frfs_are_coupled_line_by_line(
    coupled: tuple[list[FrfBlock], FloatArray, FloatArray],
) -> None:
    """The tip's FRF peaks at the coupled frequencies; its variance is propagated."""
    blocks, truth, _ = coupled
    links = [FrfLink(("beam", i), ("block", i), STIFFNESS) for i in range(9)]
    frf = couple_frfs(blocks, links, [("beam", 9)])
    level = np.abs(frf.response[0, 0])
    for one in truth[:2]:
        near = np.abs(frf.frequency - one) < 20.0
        peak = frf.frequency[near][np.argmax(level[near])]
        assert peak == pytest.approx(one, rel=5e-3)
    assert frf.variance is not None
    assert np.all(frf.variance > 0)
    # Nothing between two points of one body: as measured.
    alone = couple_frfs(blocks, [], [("beam", 9)])
    np.testing.assert_allclose(alone.response[0, 0], blocks[0].receptance[9, 9])


def test_rigid_links_and_the_ground() -> None:
    """A mass on a spring, held rigidly: the receptance of the rest."""
    frequency = np.array([1.0, 2.0, 5.0])
    omega = 2 * np.pi * frequency
    mass, spring = 2.0, 5e3
    dynamic = np.array([[spring - 3.0 * omega**2, -spring + 0 * omega]] * 2)
    dynamic[1] = dynamic[1][::-1]
    dynamic[1, 1] = spring - mass * omega**2
    free = np.moveaxis(np.linalg.inv(np.moveaxis(dynamic, 2, 0)), 0, 2) + 0j
    block = FrfBlock("pair", frequency, free, np.full(free.shape, 1e-20))
    held = couple_frfs([block], [FrfLink(("pair", 0), None)], [("pair", 1)])
    np.testing.assert_allclose(
        held.response[0, 0], 1.0 / (spring - mass * omega**2), rtol=1e-9
    )
    with pytest.raises(UsageError, match="has points 0 to 1, not 2"):
        couple_frfs([block], [], [("pair", 2)])
    with pytest.raises(BadData, match="not symmetric"):
        FrfBlock("b", frequency, np.triu(np.ones((2, 2)))[:, :, None] * free, free.real)


def test_a_modal_table_with_rigid_modes_among_the_elastic_is_refused() -> None:
    """Frequencies above zero; rigid motions have their own rows."""
    none = np.zeros((0, 1))
    one = np.ones(1)
    square = np.zeros((1, 1))
    with pytest.raises(BadData, match="above 0 Hz in ascending order"):
        ModalTable(
            "b",
            0 * one,
            one,
            one,
            one,
            none.T @ none + 1,
            square,
            none,
            square,
            square,
            9.0,
        )
    table = ModalTable(
        "b",
        5 * one,
        0.1 * one,
        0.01 * one,
        one,
        square + 1,
        square,
        none,
        square,
        square,
        9.0,
    )
    body = modal_body(table, {"p": [0]})
    assert body.source is BodySource.MODAL_TABLE
    assert body.error_bound == pytest.approx(0.04)
