"""Mean motion of a piece of a body."""

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.surface_motion import (
    Attachment,
    motion_of_piece,
    rotated,
)
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.meshes.polygons import disc

BLOCK = box_mesh((0.2, 0.1, 0.05), (4, 2, 1))
POINT = (0.05, 0.05, 0.05)
PIECES = (
    Attachment(POINT, radius=0.04),
    Attachment(POINT, face="z+"),
    Attachment(POINT, face="z+", patch=disc((0.06, 0.05), 0.03)),
)


@pytest.mark.parametrize("piece", PIECES)
def test_a_rigid_motion_is_found_exactly(piece: Attachment) -> None:
    """Displacement of the point and rotation, whatever the piece."""
    shift, turn = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.1, -0.7])
    motion = shift + np.cross(turn, BLOCK.nodes)
    found = motion_of_piece("block", BLOCK, piece) @ motion.ravel()
    assert found[:3] == pytest.approx(shift + np.cross(turn, POINT))
    assert found[3:] == pytest.approx(turn)


def test_forces_and_moments_are_spread_with_the_same_resultants() -> None:
    """The transpose of the motion: sums of nodal forces, moments about the point."""
    rows = motion_of_piece("block", BLOCK, PIECES[2])
    load = np.array([1.0, 2.0, 3.0, 0.4, 0.5, 0.6])
    force = (rows.T @ load).reshape(-1, 3)
    assert force.sum(axis=0) == pytest.approx(load[:3])
    arm = BLOCK.nodes - np.array(POINT)
    assert np.cross(arm, force).sum(axis=0) == pytest.approx(load[3:])


def test_an_axis_turns_displacement_and_rotation_alike() -> None:
    """The first row is along the axis."""
    rows = motion_of_piece("block", BLOCK, PIECES[0])
    turned = rotated(rows, (0.0, 3.0, 0.0))
    assert abs(turned[[0, 3]] - rows[[1, 4]]).max() < 1e-15


def test_a_piece_without_nodes_is_refused() -> None:
    """With the number found and the remedy."""
    with pytest.raises(BadData, match=r"0 nodes within 0\.001 m"):
        motion_of_piece("block", BLOCK, Attachment((9.0, 0.0, 0.0), radius=1e-3))
    with pytest.raises(BadData, match="on a line"):
        fine = box_mesh((0.2, 0.1, 0.05), (4, 4, 1))
        motion_of_piece("block", fine, Attachment((0.0, 0.05, 0.0), radius=0.013))
