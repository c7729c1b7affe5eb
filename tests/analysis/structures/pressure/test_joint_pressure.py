"""Pressure over a joint: limits that are known, and inputs that cannot be."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.basics.units import STANDARD_GRAVITY
from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import (
    Joint,
    Support,
    SupportKind,
    solid_body,
)
from jointbench.analysis.structures.matrices.spring_pattern import SpringPattern
from jointbench.analysis.structures.matrices.structure import Structure, build_structure
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.pressure.clamped_loads import ClampBolt
from jointbench.analysis.structures.pressure.interface_law import (
    InterfaceLaw,
    PowerInterface,
    law_of_loads,
)
from jointbench.analysis.structures.pressure.joint_pressure import (
    PressureCase,
    joint_pressure,
)

SIDE, THICK = 0.12, 0.02
STEEL = Material(200e9, 0.3, 7850.0, 0.0)
POWER = PowerInterface(1e13, 1e6, 0.5, 0.8, 0.02, 100.0, 0.0)
BOLT = ClampBolt("bolt 1", (SIDE / 2, SIDE / 2), 2e4, 0.0, 0.03, 0.0)


def plates(cells: int = 6, pattern: SpringPattern | None = None) -> Structure:
    """Two plates, the lower one on springs that carry its weight."""
    bodies = [
        solid_body(
            name,
            box_mesh((SIDE, SIDE, THICK), (cells, cells, 1), origin=(0.0, 0.0, level)),
            STEEL,
        )
        for name, level in (("upper", 0.0), ("lower", -THICK))
    ]
    foot = Support("lower", "z-", SupportKind.SPRINGS, (1e8, 1e8, 1e8))
    joint = Joint("plates", ("upper", "lower"), pattern=pattern)
    return build_structure(bodies, [joint], supports=[foot])


@pytest.fixture(scope="module")
def structure() -> Structure:
    """Two plates."""
    return plates()


def power(pressures: FloatArray, _: float) -> InterfaceLaw:
    """Return the law of these tests."""
    return POWER.law(pressures)


def case(*bolts: ClampBolt) -> PressureCase:
    """Return bolts through both plates."""
    return PressureCase(("upper", "lower"), bolts, power)


def test_the_approach_of_a_power_law_is_its_integral() -> None:
    """Of p^(1-m) p_0^m / (c (1 - m)), with the linear start below the first point."""
    law = POWER.law(np.geomspace(1e2, 1e8, 40))
    start = 1e2 / float(law.normal[0])
    exact = (
        (np.array([1e4, 1e6, 3e8]) * 1e6) ** 0.5 - (1e2 * 1e6) ** 0.5
    ) / 0.5 / 1e13 + start
    np.testing.assert_allclose(law.approach(np.array([1e4, 1e6, 3e8])), exact, 1e-9)


def test_a_law_of_loads_does_not_depend_on_the_number_of_patches() -> None:
    """K = P^0.9 on a reference area: patches of half the size add up to the same."""
    law = law_of_loads(
        np.geomspace(1e3, 1e9, 30),
        1e-6,
        lambda load: (load**0.9, 0.8 * load**0.9, 0.0),
        log_sd=0.0,
        source="test",
    )
    once = float(law.stiffness(np.array(1e6))) * 1e-2
    halves = 2 * float(law.stiffness(np.array(1e6))) * 0.5e-2
    assert halves == pytest.approx(once, rel=1e-12)
    assert once == pytest.approx((1e6 * 1e-6) ** 0.9 / 1e-6 * 1e-2, rel=1e-9)


def test_the_surface_carries_the_preload(structure: Structure) -> None:
    """Whatever the field, its integral is the preload."""
    found = joint_pressure(structure, "plates", case(BOLT))
    assert found.force == pytest.approx(2e4, rel=1e-6)
    assert 0.2 < found.opened < 0.8


def test_one_bolt_presses_a_cone_of_known_angle(structure: Structure) -> None:
    """The edge lies between the cones of 30 degrees (VDI 2230) and 60 degrees."""
    found = joint_pressure(structure, "plates", case(BOLT))
    radius = np.sqrt((1 - found.opened) * SIDE**2 / np.pi)
    angle = np.degrees(np.arctan((radius - BOLT.head / 2) / THICK))
    assert 30 <= angle <= 60


def test_weight_alone_presses_with_the_weight_of_the_upper_plate(
    structure: Structure,
) -> None:
    """No bolt: the upper plate rests on the lower one."""
    down = replace(case(), gravity=np.array([0.0, 0.0, -1.0]))
    found = joint_pressure(structure, "plates", down)
    weight = 7850 * SIDE**2 * THICK * STANDARD_GRAVITY
    assert found.force == pytest.approx(weight, rel=1e-4)
    assert found.opened < 0.01


def test_a_crowned_surface_closes_under_a_huge_preload(structure: Structure) -> None:
    """A crown of 2 um: open at 1 kN on a ring of bolts, closed at 1 MN."""
    heads = [
        replace(BOLT, name=f"bolt {x} {y}", position=(x, y), head=0.036)
        for x in (0.02, 0.06, 0.10)
        for y in (0.02, 0.06, 0.10)
    ]
    opened = []
    for preload in (1e3, 1e6):
        bolts = [replace(one, preload=preload / 9) for one in heads]
        crowned = replace(case(*bolts), crown=2e-6)
        opened.append(joint_pressure(structure, "plates", crowned).opened)
    assert opened[0] > 0.1
    assert opened[1] < 0.01


def test_a_soft_interface_is_pressed_evenly(structure: Structure) -> None:
    """Where the bodies are stiff beside the law the even assumption holds."""
    soft = PowerInterface(1e9, 1e6, 0.0, 0.8, 0.0, 100.0, 0.0)
    even = replace(case(BOLT), law=lambda pressures, _: soft.law(pressures))
    found = joint_pressure(structure, "plates", even)
    np.testing.assert_allclose(found.totals[:5], found.even[:5], rtol=1e-3)
    assert found.surface.pressure.max() == pytest.approx(found.mean, rel=0.02)


def test_intervals_hold_law_and_preloads(structure: Structure) -> None:
    """A stiffer law concentrates the pressure: less than in proportion."""
    wide = PowerInterface(1e13, 1e6, 0.5, 0.8, 0.0, 100.0, 0.2)
    bolt = replace(BOLT, log_sd=0.1)
    known = replace(case(bolt), law=lambda pressures, _: wide.law(pressures))
    found = joint_pressure(structure, "plates", replace(known, common_sd=0.1))
    assert set(found.parts) == {"contact law", "all preloads", "each preload"}
    assert 0.1 < found.parts["contact law"][0] <= 0.2
    assert found.parts["all preloads"][0] == pytest.approx(0.05, abs=0.01)
    np.testing.assert_allclose(
        found.parts["all preloads"], found.parts["each preload"], rtol=1e-6
    )


def test_a_pattern_keeps_the_total_and_moves_the_springs() -> None:
    """All springs near one side: the same normal total about a smaller rocking one."""
    place = np.array([[x, y] for x in (0.02, 0.10) for y in (0.02, 0.10)])
    aside = plates(3, SpringPattern(place, np.array([1.0, 1.0, 0.0, 0.0])))
    face = aside.faces[0]
    assert face.points.area == pytest.approx(SIDE**2)
    mean = face.points.weight @ face.points.position[:, 0] / face.points.area
    assert mean < 0.4 * SIDE
    lifted = np.tile([0.0, 0.0, 1.0], plates(3).nodes.shape[0])
    lifted[3 * int(aside.first_node[1]) :] = 0.0
    assert lifted @ (aside.spread[0] @ lifted) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("bolts", "gravity", "said"),
    [
        ((), None, "nothing presses"),
        ((replace(BOLT, preload=0.0),), None, "nothing presses"),
        ((), (0.0, 0.0, 1.0), "nothing holds the surfaces together"),
        ((replace(BOLT, position=(0.5, 0.06)),), None, "mm outside of the surface"),
        ((replace(BOLT, position=(0.115, 0.06)),), None, "% of the ring below its"),
        ((), (0.0, 0.0, 0.0), "gravity has no direction"),
    ],
    ids=["no load", "no preload", "upwards", "outside", "edge", "no direction"],
)
def test_what_cannot_be_is_said_in_one_line(
    structure: Structure,
    bolts: tuple[ClampBolt, ...],
    gravity: tuple[float, float, float] | None,
    said: str,
) -> None:
    """No load, loads apart, bolts off the surface."""
    asked = replace(
        case(*bolts), gravity=None if gravity is None else np.array(gravity)
    )
    with pytest.raises(BadData, match=said) as caught:
        joint_pressure(structure, "plates", asked)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("preload", [np.nan, np.inf, -1.0])
def test_a_preload_is_a_finite_number(preload: float) -> None:
    """Neither NaN nor below 0."""
    with pytest.raises(BadData, match="preload is"):
        replace(BOLT, preload=preload)
