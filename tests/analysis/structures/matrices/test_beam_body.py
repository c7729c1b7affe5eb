"""Timoshenko beams against closed forms."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.beam_body import BeamSection, beam_body
from jointbench.analysis.structures.matrices.element_assembly import Material

STEEL = Material(200e9, 0.3, 7850.0)
SPINDLE = BeamSection(0.4, 0.06, 0.03, elements=16)
SLANTED = np.array([1.0, 2.0, 2.0]) / 3.0


def test_a_cantilever_bends_and_shears_as_the_closed_form_says() -> None:
    """P L^3 / 3 E I + P L / kappa G A, exact with one element, along any axis."""
    one = BeamSection(0.4, 0.06, 0.03, elements=1)
    beam = beam_body("spindle", (1.0, 0.0, 0.0), SLANTED, [one], STEEL)
    across = np.cross(SLANTED, [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    load = np.zeros(12)
    load[6:9] = 1000.0 * across
    moved = np.linalg.solve(beam.stiffness.toarray()[6:, 6:], load[6:])
    shear = 200e9 / 2.6
    wanted = 1000 * 0.4**3 / (3 * 200e9 * one.second_moment)
    wanted += 1000 * 0.4 / (one.shear_factor(0.3) * shear * one.area)
    assert moved[:3] @ across == pytest.approx(wanted, rel=1e-10)
    assert moved[:3] @ SLANTED == pytest.approx(0.0, abs=1e-12 * wanted)


def test_a_stretched_and_twisted_bar() -> None:
    """F L / E A and T L / G I_p."""
    beam = beam_body("bar", (0, 0, 0), (0, 0, 1), [SPINDLE], STEEL)
    k = beam.stiffness.toarray()[6:, 6:]
    load = np.zeros(k.shape[0])
    load[-4], load[-1] = 1000.0, 10.0
    moved = np.linalg.solve(k, load)
    assert moved[-4] == pytest.approx(1000 * 0.4 / (200e9 * SPINDLE.area), rel=1e-10)
    polar = 2 * SPINDLE.second_moment
    assert moved[-1] == pytest.approx(10 * 0.4 / (200e9 / 2.6 * polar), rel=1e-10)


def bending_rates(elements: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return three rates of a simply supported beam, bending in x-y [rad/s]."""
    section = BeamSection(0.4, 0.06, 0.03, elements=elements)
    beam = beam_body("beam", (0, 0, 0), (1, 0, 0), [section], STEEL)
    k, m = beam.stiffness.toarray(), beam.mass.toarray()
    # Deflection y and rotation z; both ends held.
    free = [at for at in range(k.shape[0]) if at % 6 in (1, 5)]
    free = [at for at in free if at not in (1, k.shape[0] - 5)]
    own = np.ix_(free, free)
    return np.sqrt(eigh(k[own], m[own], eigvals_only=True)[:3])


def test_a_simply_supported_beam_has_the_frequencies_of_timoshenko() -> None:
    """The quadratic of w = sin(n pi x / L): shear is constant in an element, h^2."""
    coarse, fine = bending_rates(16), bending_rates(32)
    shear = SPINDLE.shear_factor(0.3) * 200e9 / 2.6 * SPINDLE.area
    rigid = 200e9 * SPINDLE.second_moment
    heavy, rotary = 7850 * SPINDLE.area, 7850 * SPINDLE.second_moment
    for n, (rough, better) in enumerate(zip(coarse, fine, strict=True), 1):
        b = n * np.pi / 0.4

        def characteristic(w: float, b: float = b) -> float:
            bend = rigid * b**2 + shear - rotary * w**2
            return (shear * b**2 - heavy * w**2) * bend - (shear * b) ** 2

        exact = brentq(characteristic, 0.5 * better, 1.2 * better)
        assert better == pytest.approx(exact, rel=2e-3)
        assert (4 * better - rough) / 3 == pytest.approx(exact, rel=1e-5)


def test_rigid_motions_of_a_beam_have_no_strain_and_its_mass() -> None:
    """Six of them; the mass is density times volume; a point off the axis turns."""
    thick = BeamSection(0.1, 0.12, elements=2)
    beam = beam_body("spindle", (0, 0, 0), SLANTED, [SPINDLE, thick], STEEL)
    turned = np.tile([0.0, 0.0, 0.0, 0.3, -0.2, 0.5], len(beam.nodes)).reshape(-1, 6)
    turned[:, :3] = np.cross([0.3, -0.2, 0.5], beam.nodes)
    size = abs(beam.stiffness).max() * np.abs(turned).max()
    assert np.abs(beam.stiffness @ turned.ravel()).max() < 1e-11 * size
    along = np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], len(beam.nodes))
    volume = 0.4 * SPINDLE.area + 0.1 * thick.area
    assert along @ beam.mass @ along == pytest.approx(7850 * volume, rel=1e-12)
    point = beam.nodes[-1] + [0.01, 0.02, -0.01]
    motion = beam.motion_at(point) @ turned.ravel()
    assert motion[:3] == pytest.approx(np.cross([0.3, -0.2, 0.5], point))
    with pytest.raises(BadData, match="nearest node"):
        beam.motion_at((9.0, 0.0, 0.0))
