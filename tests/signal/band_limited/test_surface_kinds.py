"""Names of machined surfaces, drawn by the traces of their tools."""

import machined_surfaces
import numpy as np
import pytest
from lay_surfaces import Embedded

from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.band_limited.band_records import RollOffVerdict
from jointbench.signal.band_limited.surface_kinds import not_one_band, surface_kinds
from jointbench.signal.surface.periodic_marks import periodic_marks
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile
from jointbench.station.screen.surface_kind_words import kind_lines, kinds_json

PITCH = 1e-6


def profile(heights):
    return Profile("p", 1e-7 * heights, PITCH, all_valid(heights))


@pytest.mark.parametrize("kind", ["turned", "milled"])
def test_marks_of_a_tool_are_named_with_their_distance(kind):
    """The feed is drawn first: 60 to 300 samples turned, 40 to 120 milled."""
    rng = np.random.default_rng([3, {"turned": 1, "milled": 2}[kind]])
    feed = rng.uniform(60, 300) if kind == "turned" else rng.uniform(40, 120)
    found = periodic_marks(profile(getattr(machined_surfaces, kind)(8000, 3)))
    multiple = found.wavelength / (feed * PITCH)
    assert multiple == pytest.approx(round(multiple), abs=0.02)
    assert found.share > 0.2


def test_two_crossing_directions_are_named():
    """Scratches at two angles: both within a sector of 5 degrees."""
    heights, angles = machined_surfaces.honed(200, 2)
    surface = Areal("h", 1e-7 * heights, (PITCH, PITCH), all_valid(heights))
    kinds = surface_kinds(surface, None)
    assert np.degrees(kinds.directions) == pytest.approx(np.degrees(angles), abs=5)
    assert "honed" in " ".join(kind_lines(kinds))


def test_one_lay_is_no_second_direction():
    """Maps with fewer sectors than directions: empty ones were valleys."""
    maker = Embedded((96, 96), hurst=0.7, along=20.0, across=10.0, angle=0.4)
    for seed in range(4):
        for heights in maker.draw(np.random.default_rng(seed)):
            surface = Areal("l", 1e-7 * heights, (PITCH, PITCH), all_valid(heights))
            assert surface_kinds(surface, None).directions == ()


def test_plateaus_over_valleys_are_two_processes():
    kinds = surface_kinds(profile(machined_surfaces.plateau(8000, 1)), None)
    assert kinds.two_processes
    assert kinds_json(kinds)["skewness"] < -0.8


def test_two_power_laws_are_never_one_over_all_lags():
    """H 0.25 below a wave of 50 samples and 0.8 above."""
    surface = profile(machined_surfaces.bifractal(16_000, 3))
    fit = fit_band_limited([surface])
    kinds = surface_kinds(surface, fit)
    assert kinds.bend.hurst_short < 0.5 < kinds.bend.hurst_long
    said = not_one_band(fit, kind_lines(kinds)[0])
    assert said.verdict is RollOffVerdict.NO_BAND
    assert said.hurst is None
    assert said.moments is not None


def test_a_fractal_profile_has_no_other_name():
    rough = rough_profile(4000, spacing=PITCH, dimension=1.5, roughness=1e-10, seed=3)
    assert kind_lines(surface_kinds(rough, None)) == ()
