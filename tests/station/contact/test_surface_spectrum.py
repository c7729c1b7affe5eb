"""The spectrum that contact laws take of a map with a lay."""

import numpy as np
import pytest
from lay_surfaces import Embedded, rms_in_rings

from jointbench.acquisition.records.surfaces import Areal, all_valid
from jointbench.analysis.contact.spectral.isotropic_spectrum import isotropic_spectrum
from jointbench.signal.band_limited.band_limited_fit import fit_lines
from jointbench.station.contact.surface_spectrum import surface_spectrum

PITCH = 1e-6


def drawn(along: float, across: float) -> Areal:
    """Return a map of H 0.6 whose lay runs along its rows."""
    lay = {"hurst": 0.6, "along": along, "across": across, "angle": 0.0}
    heights, _ = Embedded((128, 256), **lay).draw(np.random.default_rng(11))
    return Areal("m", 1e-6 * heights, (PITCH, PITCH), all_valid(heights))


def test_a_map_with_a_lay_has_the_gradient_of_both_directions() -> None:
    """Rows alone, along a lay of 4 to 1, have two thirds of it."""
    surface = drawn(48.0, 12.0)
    fit = fit_lines([surface])
    found, ratio = surface_spectrum(surface, fit)
    truth = rms_in_rings(
        2 * np.pi / found.longest, 2 * np.pi / found.shortest,
        hurst=0.6, along=48 * PITCH, across=12 * PITCH,
    )  # fmt: skip
    # The mean square slope of a line is half the mean square gradient.
    gradient = 1e-6 * truth[1] * np.sqrt(2)
    assert np.sqrt(found.moment(2)[0]) == pytest.approx(gradient, rel=0.1)
    assert ratio > 1.4
    assert np.sqrt(isotropic_spectrum(fit).moment(2)[0]) < 0.8 * gradient


def test_a_map_without_a_lay_has_the_spectrum_of_its_rows() -> None:
    """As the laws were judged."""
    surface = drawn(20.0, 20.0)
    fit = fit_lines([surface])
    found, ratio = surface_spectrum(surface, fit)
    assert ratio < 1.1
    assert found.wavenumber.size == 240
