"""A joint in the formats of other programs: written, read back, assembled again."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import BadData, FormatError, UsageError
from jointbench.analysis.structures.exchange import (
    abaqus_joint,
    ansys_joint,
    calculix_joint,
    joint_tables,
    nastran_joint,
)
from jointbench.analysis.structures.exchange.joint_pieces import (
    JointPiece,
    joint_pieces,
    piece_members,
    piece_motion,
    tiles,
)
from jointbench.analysis.structures.exchange.slip_law import SpeedLaw, law_of
from jointbench.analysis.structures.matrices.element_assembly import Material, Sparse
from jointbench.analysis.structures.matrices.parts import Joint, solid_body
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    build_structure,
)
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.meshes.polygons import Patch, disc
from jointbench.analysis.structures.reduction.full_modes import solve_full
from jointbench.station.joint_files.calculix_run import (
    PROGRAM,
    calculix_frequencies,
)

K = np.array([6e8, 9e7, 2e8])
C = np.array([4e3, 1.5e3, 2e3])
HEAD = ["Joint of a test."]


def slanted() -> Structure:
    """Two boxes whose shared face lies along no global axis."""
    marble = Material(youngs_modulus=55e9, poisson_ratio=0.25, density=2600.0)
    turn, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    bodies = []
    for name, level in (("lower", 0.0), ("upper", 0.05)):
        mesh = box_mesh((0.2, 0.1, 0.05), (2, 1, 1), origin=(0.0, 0.0, level))
        mesh = replace(mesh, nodes=mesh.nodes @ (turn * np.linalg.det(turn)).T)
        bodies.append(solid_body(name, mesh, marble))
    return build_structure(bodies, [Joint("joint", ("lower", "upper"))])


def pieces_of(structure: Structure) -> tuple[JointPiece, ...]:
    """Six pieces of the joint of a structure."""
    face = structure.faces[0]
    return joint_pieces("joint", face, tiles(face, (3, 2)), K, C)


def over_nodes(structure: Structure, values: np.ndarray) -> Sparse:
    """The joint over the degrees of freedom of all nodes."""
    parts = zip(structure.spread, values, strict=True)
    total = sum((value * one for one, value in parts), Sparse((structure.size,) * 2))
    return calculix_joint.over_all_nodes(structure, Sparse(total))


@pytest.fixture(scope="module")
def skew() -> Structure:
    """Two boxes whose shared face lies along no global axis."""
    return slanted()


def test_pieces_sum_up_to_the_totals_and_turn_as_the_area_does(
    skew: Structure,
) -> None:
    """A rectangle a x b: rocking k b^2/12 about its long axis; torsion of both."""
    one = joint_pieces("joint", skew.faces[0], (), K, C)[0]
    total = sum(piece.stiffness[:3, :3] for piece in pieces_of(skew))
    assert_allclose(total, np.diag(K), atol=1.0)
    first, second = 0.2, 0.1
    if abs(np.ptp(skew.faces[0].points.position @ one.frame[1]) - 0.2) > 0.05:
        first, second = second, first
    wanted = [K[0] * second**2 / 12, K[0] * first**2 / 12]
    if abs(one.stiffness[4, 5]) < 1.0:
        assert_allclose(np.diag(one.stiffness)[4:], wanted, rtol=1e-9)
    assert_allclose(np.trace(one.stiffness[4:, 4:]), sum(wanted), rtol=1e-9)


def test_pieces_follow_a_rigid_motion_and_hold_the_energy_of_the_joint(
    skew: Structure,
) -> None:
    """Relative rigid motion of the bodies strains pieces and joint alike."""
    rng = np.random.default_rng(5)
    shift, turn = rng.normal(size=3), rng.normal(size=3)
    begin, end = skew.first_node[1], skew.first_node[2]
    motion = np.zeros((len(skew.nodes), 3))
    motion[begin:end] = shift + np.cross(turn, skew.nodes[begin:end])
    face, flat = skew.faces[0], motion.ravel()
    energy = sum(
        k * float(flat @ (spread @ flat))
        for k, spread in zip(K, skew.spread, strict=True)
    )
    found = 0.0
    members = piece_members(face, tiles(face, (3, 2)))
    for inside, piece in zip(members, pieces_of(skew), strict=True):
        moved = piece_motion(face, inside, piece) @ flat
        found += float(moved @ piece.stiffness @ moved)
    assert_allclose(found, energy, rtol=1e-9)


def test_every_format_of_pieces_is_read_back(skew: Structure) -> None:
    """Ansys, Abaqus, Nastran and the table, along slanted axes."""
    pieces = pieces_of(skew)
    table = joint_tables.read_pieces_table(joint_tables.pieces_table(pieces))
    read = {
        "ansys": ansys_joint.read_matrix27(ansys_joint.matrix27_text(pieces, HEAD)),
        "abaqus": abaqus_joint.read_pieces_text(abaqus_joint.pieces_text(pieces, HEAD)),
        "nastran": nastran_joint.read_cbush(nastran_joint.cbush_text(pieces, HEAD)),
    }
    for number, piece in enumerate(pieces):
        assert_allclose(table[number].stiffness, piece.stiffness, atol=1e-6)
        for found in read.values():
            one = found[number]
            assert_allclose(one.centre, piece.centre, atol=1e-9)
            scale = np.abs(piece.global_stiffness).max()
            assert_allclose(
                one.stiffness, piece.global_stiffness, rtol=1e-7, atol=1e-7 * scale
            )
            scale = np.abs(piece.global_damping).max()
            assert_allclose(
                one.damping, piece.global_damping, rtol=1e-7, atol=1e-7 * scale
            )


def test_a_piece_with_coupled_rotations_takes_two_bushes(plates: Structure) -> None:
    """A patch that lies askew to the tangents rocks about other axes."""
    corners = np.array([[0.1, 0.05], [0.3, 0.15], [0.28, 0.19], [0.08, 0.09]])
    bodies = list(plates.bodies)
    joint = Joint("joint", ("lower", "upper"), (Patch(corners),))
    structure = build_structure(bodies, [joint])
    pieces = joint_pieces("joint", structure.faces[0], (), K, C)
    text = nastran_joint.cbush_text(pieces, HEAD)
    assert abs(pieces[0].stiffness[4, 5]) > 0.1 * pieces[0].stiffness[4, 4]
    assert text.count("CBUSH*") == 2
    found = nastran_joint.read_cbush(text)[0]
    assert_allclose(found.stiffness, pieces[0].global_stiffness, rtol=1e-6, atol=1.0)


def test_every_format_by_nodes_is_the_joint_again(skew: Structure) -> None:
    """Matrices of Abaqus and Nastran, and the springs of CalculiX."""
    k, c, count = over_nodes(skew, K), over_nodes(skew, C), len(skew.nodes)
    springs = calculix_joint.read_springs(
        calculix_joint.springs_text(k, HEAD, 5), count
    )
    both = [
        abaqus_joint.read_nodes_text(abaqus_joint.nodes_text(k, c, HEAD), count),
        nastran_joint.read_dmig(nastran_joint.dmig_text(k, c, HEAD), count),
    ]
    assert abs(springs - k).max() < 1e-10 * abs(k).max()
    for stiffness, damping in both:
        assert abs(stiffness - k).max() < 1e-8 * abs(k).max()
        assert abs(damping - c).max() < 1e-8 * abs(c).max()


@pytest.mark.skipif(shutil.which(PROGRAM) is None, reason="CalculiX is not installed")
def test_calculix_finds_our_frequencies_with_the_exported_joint(
    skew: Structure,
) -> None:
    """A slanted joint through springs between different directions: 1e-6."""
    marble = Material(youngs_modulus=55e9, poisson_ratio=0.25, density=2600.0)
    model = calculix_joint.CalculixModel(skew, (marble, marble), (), 16)
    text = calculix_joint.model_text(model, [over_nodes(skew, K)])
    own = solve_full(skew, K, 12).natural_frequency[6:]
    found = calculix_frequencies(text)
    assert_allclose(found[found > 0.5 * own[0]][:6], own, rtol=1e-6)


def test_an_iwan_law_becomes_sliders_that_keep_stiffness_and_slip_force() -> None:
    """Force at gross slip: kt phimax (chi + 2)/(chi + 3), as the density integrates."""
    values = {"kt": 2e8, "phimax": 1e-5, "chi": -0.5}
    law = law_of("iwan", values)
    assert not isinstance(law, SpeedLaw)
    assert_allclose(law.total, 2e8, rtol=1e-12)
    assert_allclose(law.slip_force.sum(), 2e8 * 1e-5 * 1.5 / 2.5, rtol=1e-12)


def test_sliders_take_their_share_out_of_the_linear_springs(skew: Structure) -> None:
    """COMBIN40 and COMBIN14 of one direction add up to the identified stiffness."""
    law = law_of("jenkins", {"kt": 4e7, "Fs": 120.0})
    assert not isinstance(law, SpeedLaw)
    text = ansys_joint.combin14_text(pieces_of(skew)[:1], HEAD, {1: law})
    rows = [line.split(",") for line in text.splitlines() if line.startswith("R,")]
    linear, slider = float(rows[1][2]), float(rows[2][2])
    assert_allclose(linear + slider, pieces_of(skew)[0].stiffness[1, 1])
    assert_allclose(float(rows[2][6]), 120.0)
    deck = abaqus_joint.pieces_text(pieces_of(skew), HEAD, {1: law})
    assert deck.count("*CONNECTOR PLASTICITY") == 6


def test_a_power_of_speed_becomes_a_table() -> None:
    """Force over speed, odd."""
    law = law_of("power_damping", {"c": 50.0, "p": 2.0})
    assert isinstance(law, SpeedLaw)
    speed, force = law.table(0.1)
    assert_allclose(force, 50.0 * speed * np.abs(speed))
    assert "force [N]" in joint_tables.law_table(law, 0.1)


def test_what_cannot_be_written_or_read_is_said(skew: Structure) -> None:
    """A law without sliders; a damaged file; patches that leave an area out."""
    with pytest.raises(UsageError, match="no springs with sliders"):
        law_of("cubic_stiffness", {})
    with pytest.raises(FormatError, match="write the file again"):
        ansys_joint.read_matrix27("N,1,0,0,0\n")
    with pytest.raises(FormatError, match="lacks its property"):
        nastran_joint.read_cbush("$ nothing\n")
    with pytest.raises(FormatError, match="no eigenvalues"):
        calculix_joint.read_frequencies("")
    with pytest.raises(BadData, match="in no piece"):
        joint_pieces("joint", skew.faces[0], (disc((9.0, 9.0), 0.01),), K, C)


@pytest.mark.parametrize(("name", "power"), [("iwan", 1.5), ("iwan_segalman", 0.5)])
def test_the_exponent_of_an_iwan_law_is_that_of_its_effect(
    name: str, power: float
) -> None:
    """Stiffness below phi grows as phi^(chi + 1) in Segalman's law, at any beta."""
    law = law_of(name, {"kt": 1e8, "phimax": 1e-6, "chi": -0.5, "beta": 0.0}, ())
    assert not isinstance(law, SpeedLaw)
    slip = law.slip_force / law.stiffness
    below = np.cumsum(law.stiffness) / 1e8
    # The edge between two sliders lies between their mean slip displacements.
    edge = np.sqrt(slip[2:-1] * slip[3:]) / 1e-6
    assert_allclose(
        np.polyfit(np.log(edge), np.log(below[2:-1]), 1)[0], power, rtol=0.03
    )
