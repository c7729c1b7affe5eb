"""Joints over faces, patches and bolt spots."""

from collections.abc import Callable

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import (
    GROUND,
    Joint,
    MeshedBody,
    PointMass,
    Support,
    SupportKind,
    solid_body,
)
from jointbench.analysis.structures.matrices.structure import Structure, build_structure
from jointbench.analysis.structures.meshes.elements import ElementKind
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.meshes.polygons import Patch, disc, rectangle
from jointbench.analysis.structures.reduction.full_modes import solve_full

PLATE = (0.5, 0.3, 0.05)
SOFT = np.array([28.667e6, 15e6, 22e6])


def two(
    marble: Material,
    first: tuple[int, int, int],
    second: tuple[int, int, int],
    *,
    kind: ElementKind = ElementKind.HEX20,
) -> list[MeshedBody]:
    """Return two plates with meshes of their own."""
    upper = box_mesh(PLATE, second, origin=(0.0, 0.0, 0.05), kind=kind)
    return [
        solid_body("lower", box_mesh(PLATE, first), marble),
        solid_body("upper", upper, marble),
    ]


def test_a_soft_joint_has_the_frequencies_of_an_independent_code(
    marble: Material, oracle: Callable[[str, str], list[float]]
) -> None:
    """Six rigid motions, six of the joint, then bending."""
    bodies = two(marble, (10, 6, 2), (10, 6, 2))
    structure = build_structure(bodies, [Joint("j", ("lower", "upper"))])
    found = solve_full(structure, SOFT, 13).natural_frequency
    np.testing.assert_allclose(found[6:], oracle("3", "hex_10x6x2")[:7], rtol=2e-8)


def test_glue_is_the_limit_of_a_stiff_joint(
    marble: Material, oracle: Callable[[str, str], list[float]]
) -> None:
    """A glued joint has no parameters, and the oracle's glued frequencies."""
    bodies = two(marble, (10, 6, 2), (10, 6, 2))
    structure = build_structure(bodies, [Joint("j", ("lower", "upper"), glued=True)])
    assert structure.parameter_names == ()
    found = solve_full(structure, np.zeros(0), 10).natural_frequency
    np.testing.assert_allclose(found[6:], oracle("5", "hex_10x6x2")[:4], rtol=3e-6)


@pytest.mark.parametrize("kind", list(ElementKind))
def test_faces_that_do_not_match_carry_the_same_springs(
    marble: Material, kind: ElementKind, oracle: Callable[[str, str], list[float]]
) -> None:
    """Rigid plates on springs care for the total stiffness, not for the meshes."""
    bodies = two(marble, (4, 3, 1), (3, 2, 1), kind=kind)
    structure = build_structure(bodies, [Joint("j", ("lower", "upper"))])
    found = solve_full(structure, SOFT, 12).natural_frequency
    np.testing.assert_allclose(found[6:], oracle("3", "hex_10x6x2")[:6], rtol=2e-4)


def test_unit_motion_across_a_joint_costs_its_total_stiffness(marble: Material) -> None:
    """Patches and bolt spots included: the total is spread, whatever the area."""
    patches = (disc((0.1, 0.1), 0.03), rectangle((0.3, 0.4), (0.1, 0.2)))
    joint = Joint("j", ("lower", "upper"), patches=patches)
    structure = build_structure(two(marble, (5, 3, 1), (4, 3, 1)), [joint])
    assert structure.area[0] == pytest.approx(np.pi * 0.03**2 + 0.01, rel=1e-9)
    motion = np.zeros((structure.nodes.shape[0], 3))
    motion[structure.first_node[1] :] = (2.0, 3.0, 1.0)
    energy = [motion.ravel() @ (g @ motion.ravel()) for g in structure.spread]
    np.testing.assert_allclose(energy, (1.0, 4.0, 9.0), rtol=1e-9)


def test_a_joint_of_stiffness_zero_leaves_bodies_free(marble: Material) -> None:
    """Twelve rigid motions, then each frequency of the plate twice."""
    bodies = two(marble, (4, 3, 1), (4, 3, 1))
    structure = build_structure(bodies, [Joint("j", ("lower", "upper"))])
    found = solve_full(structure, np.zeros(3), 16).natural_frequency
    assert np.all(found[:12] == 0.0)
    np.testing.assert_allclose(found[12::2], found[13::2], rtol=1e-9)


def test_a_joint_that_touches_nothing_is_named(marble: Material) -> None:
    """A gap of a millimetre, or patches beside the plate."""
    lower = solid_body("lower", box_mesh(PLATE, (2, 2, 1)), marble)
    far = box_mesh(PLATE, (2, 2, 1), origin=(0.0, 0.0, 0.051))
    apart = [lower, solid_body("upper", far, marble)]
    with pytest.raises(BadData, match="'gap' touches nothing"):
        build_structure(apart, [Joint("gap", ("lower", "upper"))])
    beside = Joint(
        "beside", ("lower", "upper"), patches=(rectangle((2.0, 3.0), (0.0, 0.1)),)
    )
    with pytest.raises(BadData, match="'beside' touches nothing"):
        build_structure(two(marble, (2, 2, 1), (2, 2, 1)), [beside])


def test_a_support_that_holds_too_little_leaves_mechanisms(marble: Material) -> None:
    """Springs along the normal alone: three motions have zero strain energy."""
    body = solid_body("block", box_mesh(PLATE, (4, 3, 1)), marble)
    springs = Support("block", "z-", SupportKind.SPRINGS, (1e8, 0.0, 0.0))
    structure = build_structure([body], [], supports=[springs])
    found = solve_full(structure, np.zeros(0), 5).natural_frequency
    assert np.all(found[:3] == 0.0)
    assert found[3] > 100.0


def test_a_fixed_face_leaves_no_rigid_motion(marble: Material) -> None:
    """The first mode of a long column is that of a clamped beam within 3 %."""
    column = box_mesh((0.05, 0.05, 1.0), (1, 1, 8))
    body = solid_body("column", column, marble)
    structure = build_structure([body], [], supports=[Support("column", "z-")])
    found = solve_full(structure, np.zeros(0), 1).natural_frequency[0]
    # Euler beam: 1.8751^2 / (2 pi L^2) sqrt(E I / (rho A)), I / A = h^2 / 12.
    beam = 1.875104**2 / (2 * np.pi) * np.sqrt(55e9 / 2600.0 * 0.05**2 / 12)
    assert found == pytest.approx(beam, rel=0.03)


def test_a_point_mass_lowers_frequencies_by_its_share(marble: Material) -> None:
    """On springs, a rigid block of 19.5 kg with 1.95 kg: f / sqrt(1.1) along z."""
    body = solid_body("block", box_mesh(PLATE, (2, 2, 2)), marble)
    joint = Joint("bed", ("block", GROUND), face="z-")
    centre = PointMass("block", (0.25, 0.15, 0.025), 1.95)
    light = build_structure([body], [joint])
    heavy = build_structure([body], [joint], masses=[centre])
    soft = np.array([1e5, 1e9, 1e9])
    before, after = bounce(light, soft), bounce(heavy, soft)
    assert before == pytest.approx(np.sqrt(1e5 / 19.5) / (2 * np.pi), rel=1e-4)
    assert after == pytest.approx(before / np.sqrt(1.1), rel=1e-4)


def bounce(structure: Structure, stiffness: FloatArray) -> float:
    """Return the frequency of the mode that moves most mass along z [Hz]."""
    found = solve_full(structure, stiffness, 3)
    along_z = np.tile([0.0, 0.0, 1.0], structure.size // 3)
    moved = np.abs(found.shapes @ (structure.mass @ along_z))
    return float(found.natural_frequency[np.argmax(moved)])


def test_a_patch_without_area_is_refused() -> None:
    """Corners on a line, or the wrong way round."""
    with pytest.raises(BadData, match="no area"):
        Patch(np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]))


def test_a_joint_between_unknown_bodies_is_refused(marble: Material) -> None:
    """The message lists the bodies that there are."""
    bodies = two(marble, (2, 2, 1), (2, 2, 1))
    with pytest.raises(UsageError, match=r"\['lower', 'upper'\]"):
        build_structure(bodies, [Joint("j", ("lower", "middle"))])


def test_a_negative_stiffness_is_refused(marble: Material) -> None:
    """A spring that pushes has no place here."""
    bodies = two(marble, (2, 2, 1), (2, 2, 1))
    structure = build_structure(bodies, [Joint("j", ("lower", "upper"))])
    with pytest.raises(BadData, match="must be >= 0"):
        solve_full(structure, np.array([1e8, -1.0, 1e8]), 8)
