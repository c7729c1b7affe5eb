"""Half-space contact of maps: closed forms, orientation, waviness apart."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.records.surfaces import Areal, all_valid
from jointbench.analysis.contact.half_space.contact_patch import contact_patch
from jointbench.analysis.contact.half_space.elastic_contact import solve_contact
from jointbench.analysis.contact.half_space.influence import (
    periodic_influence,
    single_influence,
)
from jointbench.analysis.contact.half_space.mated_heights import mated_heights


def areal(heights: FloatArray, spacing: tuple[float, float] = (1e-5, 1e-5)) -> Areal:
    """Return heights as a complete map."""
    return Areal("made", heights, spacing, all_valid(heights))


def test_a_sphere_is_that_of_hertz() -> None:
    """Radius within a fifth of a point, peak pressure and approach within 0.3 %."""
    points, radius = 64, 0.2
    place = (np.arange(points) + 0.5) / points - 0.5
    heights = -(place[:, None] ** 2 + place[None, :] ** 2) / 2
    influence = single_influence((points, points), (1 / points, 1 / points), 1.0)
    found = solve_contact(heights, 4 / 3 * radius**3, influence)
    assert_allclose(np.sqrt(found.area_share / np.pi), radius, atol=0.2 / points)
    assert_allclose(found.pressure.max(), 2 * radius / np.pi, rtol=3e-3)
    moved = influence.displacement(found.pressure) - heights
    assert_allclose(moved[found.pressure > 0].mean(), radius**2, rtol=3e-3)


@pytest.mark.parametrize("share", [0.2, 0.7])
def test_a_sinusoid_is_that_of_westergaard(share: float) -> None:
    """Contact over 2/pi asin((p/p*)^(1/2)) of the width, to a point at each edge."""
    points, height = 128, 0.01
    heights = np.tile(height * np.cos(2 * np.pi * np.arange(points) / points), (4, 1))
    influence = periodic_influence(heights.shape, (1 / points, 1 / points), 1.0)
    found = solve_contact(heights, share * np.pi * height, influence)
    wanted = 2 / np.pi * np.arcsin(np.sqrt(share))
    assert_allclose(found.area_share, wanted, atol=2 / points)


def test_maps_are_mated_as_declared() -> None:
    """The left edge of the upper map, seen from outside, lies on the right edge."""
    lower, upper = np.zeros((2, 20, 24))
    lower[5, 3], upper[5, 20] = 1e-6, 1e-6
    flat = mated_heights(areal(lower), areal(upper))
    assert_allclose(np.unravel_index(flat.heights.argmax(), (20, 24)), (5, 3))
    assert_allclose(np.ptp(flat.heights), 2e-6, rtol=0.05)
    turned = np.zeros((24, 20))
    turned[20, 14] = 1e-6
    back = mated_heights(areal(lower), areal(turned), turn=90)
    assert back.heights.shape == (20, 24)
    assert_allclose(np.ptp(back.heights), 2e-6, rtol=0.05)
    with pytest.raises(UsageError, match="multiple of 90"):
        mated_heights(areal(lower), areal(upper), turn=30)
    with pytest.raises(BadData, match="measure a larger map"):
        mated_heights(areal(lower[:8]), None)


def test_missing_points_are_valleys_and_other_spacings_are_interpolated() -> None:
    """Both are remarked; a map of twice the spacing adds its own heights."""
    random = np.random.default_rng(3)
    rough = 1e-6 * random.standard_normal((32, 32))
    valid = np.ones((32, 32), dtype=np.bool_)
    valid[4, 5] = False
    holed = Areal("holed", np.where(valid, rough, 0.0), (1e-5, 1e-5), valid)
    ramp = np.tile(1e-6 * np.cos(np.arange(20) / 3), (20, 1))
    found = mated_heights(holed, areal(ramp, (2e-5, 2e-5)))
    assert any("missing" in one for one in found.remarks)
    assert any("interpolated" in one for one in found.remarks)
    assert found.heights.shape == (32, 32)


def test_waviness_and_roughness_are_apart() -> None:
    """Long waves alone give the waviness; fine ones on a plane give roughness alone."""
    place = np.arange(48)
    long = 1e-6 * np.cos(2 * np.pi * place / 48)
    fine = 1e-7 * np.cos(2 * np.pi * place / 6)
    given = {"modulus": 1e11, "hardness": 1e10, "cutoff": 1.2e-4}
    for wave, share in ((long, 1.0), (fine, 0.0)):
        mated = mated_heights(areal(wave[:, None] + wave[None, :]), None)
        found = contact_patch(mated, 2e7 * mated.area, **given)
        assert found.compliance > 0
        part = found.wavy_compliance / found.compliance
        assert part == pytest.approx(share, abs=0.12)
        total = found.wavy_compliance + found.rough_compliance
        assert_allclose(total, found.compliance)
        assert_allclose(found.pressure.mean(), 2e7)
