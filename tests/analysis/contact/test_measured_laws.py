"""Laws of measured surfaces: closed forms, limits, ranges."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from jointbench.analysis.contact.spectral.height_distribution import (
    HeightFacts,
    facts_of_both,
)
from jointbench.analysis.contact.spectral.isotropic_spectrum import (
    DRAWS,
    IsotropicSpectrum,
    combined,
    doubled,
    isotropic_spectrum,
)
from jointbench.analysis.contact.spectral.measured_laws import (
    LawCurve,
    MeasuredCase,
    predict_measured,
)
from jointbench.analysis.contact.spectral.persson import (
    exponential_length,
    persson_state,
)
from jointbench.analysis.contact.spectral.summit_laws import (
    bush_gibson_thomas,
    greenwood_williamson,
    line_moments,
)
from jointbench.signal.band_limited.band_records import (
    BandLimitedFit,
    DrawnModels,
    Interval95,
    LineDensity,
    RollOffVerdict,
    RoughnessMoments,
)
from jointbench.signal.band_limited.matern_spectrum import BandLimited

ONE = np.ones(1)
NORMAL = HeightFacts(0.0, 0.0, 100.0, 1e-6)


def power_law(rows: int = 1, hurst: float = 0.8) -> IsotropicSpectrum:
    """Return a self-affine surface of waves of 1/64 to 1/4 m, height of about 1 um."""
    q = 2 * np.pi * np.geomspace(4, 64, 300)
    variance = q ** (-2 * hurst)
    variance *= 1e-12 / variance.sum()
    spread = np.ones((rows, 1))
    return IsotropicSpectrum(
        q, spread * variance, np.full(rows, hurst), saturated=True, modelled=True
    )


def made_fit(**changes: object) -> BandLimitedFit:
    """Return a fit of a Matern surface, roll-off 200 samples of 1 um, h 1 um."""
    model = BandLimited(level=1.0, pivot=0.1, hurst=0.7, roll_off=200.0)
    wide = Interval95(1.0, 0.9, 1.1)
    fit = BandLimitedFit(
        verdict=RollOffVerdict.SATURATED,
        reason="made",
        hurst=wide,
        roll_off=wide,
        roll_off_beyond=None,
        height=wide,
        short_cut=None,
        tip_deviation=None,
        noise=0.0,
        moments=RoughnessMoments(8e-6, 5e-3, wide, wide, wide, modelled=True),
        tolerance=0.0,
        model=model,
        pitch=1e-6,
        scale=1e-6,
        draws=DrawnModels((model,), (1.0,)),
    )
    return replace(fit, **changes)


def test_lines_of_the_surface_have_the_density_of_the_fit() -> None:
    """The integral across the line of the surface's density is the line's, exactly."""
    fit = made_fit()
    assert fit.model is not None
    found = isotropic_spectrum(fit)
    height = float(np.sqrt(found.moment(0)[0]))
    whole, _ = quad(lambda q: 2 * float(fit.model.surface(np.array(q))), 0, np.inf)
    # Waves shorter than the shortest hold (q_r / q_s)^(2 H) of the variance.
    left = 1 - (1 + (200 / 8) ** 2) ** -0.7
    assert_allclose(height**2, 1e-12 * whole * left, rtol=2e-3)


def test_a_measured_line_gives_its_surface_back() -> None:
    """Rings fitted to the density of a line have the moments of the surface."""
    fit = made_fit()
    assert fit.model is not None
    omega = np.geomspace(2e-3, 2 * np.pi / 8, 80)
    density = 1e-18 * fit.model.surface(omega)
    line = LineDensity(omega * 1e6, density, np.full(omega.size, 50.0))
    direct = isotropic_spectrum(fit)
    found = isotropic_spectrum(replace(fit, model=None, draws=None, density=line))
    assert_allclose(found.moment(0)[0], direct.moment(0)[0], rtol=0.02)
    # A line shows waves of the surface up to its own shortest only in part.
    assert_allclose(found.moment(2)[0], direct.moment(2)[0], rtol=0.07)
    assert_allclose(found.moment(4)[0], direct.moment(4)[0], rtol=0.2)
    middle = np.median(np.sqrt(found.moment(2)[1:]))
    assert_allclose(middle, np.sqrt(found.moment(2)[0]), rtol=0.05)


def test_spectra_of_two_surfaces_add() -> None:
    """One that stands for both is doubled; two are cut at the longer short wave."""
    one = power_law(DRAWS + 1)
    assert_allclose(doubled(one).moment(2), 2 * one.moment(2))
    other = one.without_below(1 / 30)
    both = combined(one, other)
    assert both.shortest > 1 / 30
    assert_allclose(both.moment(0), 2 * other.moment(0), rtol=1e-9)


def test_persson_has_its_limits() -> None:
    """Area 1.596 p/(E* h') at light load and full at high load; k = p/u_0 at light."""
    surface = power_law()
    gradient = float(np.sqrt(surface.moment(2)[0]))
    pressure = gradient * np.array([1e-5, 3.0])
    found = persson_state(surface, pressure, ONE, 1e9 * ONE)
    assert_allclose(found.real_area[0, 0], np.sqrt(8 / np.pi) * 1e-5, rtol=1e-3)
    assert_allclose(found.real_area[0, 1], 1.0, rtol=1e-4)
    length = exponential_length(surface)
    assert_allclose(found.stiffness[0, 0], pressure[0] / length[0], rtol=1e-2)
    # Gap and stiffness belong to each other: u falls by u_0 for each factor e.
    lower = persson_state(surface, pressure[:1] / np.e, ONE, 1e9 * ONE)
    assert_allclose(lower.gap[0] - found.gap[0], length[0], rtol=1e-2)


def test_yielded_contacts_carry_the_hardness() -> None:
    """A soft surface has the area of load over hardness; a hard one is elastic."""
    surface = power_law()
    gradient = float(np.sqrt(surface.moment(2)[0]))
    pressure = gradient * np.array([1e-4])
    soft = persson_state(surface, pressure, ONE, 0.05 * gradient * ONE)
    assert_allclose(soft.real_area[0], 1e-4 / 0.05, rtol=1e-3)
    assert soft.yielded[0, 0] > 0.99
    assert soft.stiffening[0, 0] > 1
    hard = persson_state(surface, pressure, ONE, 1e3 * gradient * ONE)
    assert hard.yielded[0, 0] == 0
    assert_allclose(hard.stiffening, 1)


def test_summits_are_those_of_nayak_and_of_greenwood_and_williamson() -> None:
    """Density m_4/(6 pi 3^(1/2) m_2); load and stiffness by quadrature over heights."""
    moments = line_moments(power_law())
    pressure = np.array([1e-9, 1e-8])
    found = greenwood_williamson(moments, pressure, ONE)
    sd, radius = moments.summit_height[0], moments.radius[0]
    above = 4 * np.sqrt(moments.height[0] / (np.pi * moments.breadth[0]))
    plane = (found.separation[0, 0] - above) / sd

    def total(power: float) -> float:
        value, _ = quad(
            lambda x: (x - plane) ** power * np.exp(-(x**2) / 2) / np.sqrt(2 * np.pi),
            plane,
            plane + 10,
            epsabs=0,
        )
        return float(value)

    density = moments.density[0]
    load = 4 / 3 * density * np.sqrt(radius) * sd**1.5 * total(1.5)
    assert_allclose(load, 1e-9, rtol=1e-3)
    assert_allclose(
        found.stiffness[0, 0],
        2 * density * np.sqrt(radius * sd) * total(0.5),
        rtol=1e-3,
    )
    # With the planes far below every summit is in contact.
    deep = bush_gibson_thomas(moments, np.array([10.0]), ONE)
    assert_allclose(deep.contacts[0, 0], density, rtol=0.05)


def test_elliptic_summits_lie_between_persson_and_the_asymptote() -> None:
    """The area over p/(E* h') falls with load from near (2 pi)^(1/2) towards 1.6."""
    surface = power_law()
    gradient = float(np.sqrt(surface.moment(2)[0]))
    load = np.array([1e-6, 1e-4, 1e-2])
    found = bush_gibson_thomas(line_moments(surface), gradient * load, ONE)
    share = found.real_area[0] / load
    assert np.all(np.diff(share) < 0)
    assert np.all((share > 1.6) & (share < np.sqrt(2 * np.pi)))


def case(**changes: object) -> MeasuredCase:
    """Return a joint with 160,000 hills that no law refuses at moderate load."""
    surface = power_law(DRAWS + 1)
    joint = MeasuredCase(surface, NORMAL, area=2500.0, modulus=1e11, hardness=1e12)
    return replace(joint, **changes)


def at(joint: MeasuredCase, load: float) -> dict[str, LawCurve]:
    """Return the laws by name at one p / (E* h')."""
    pressure = np.array([load * joint.modulus * joint.gradient])
    return {one.law: one for one in predict_measured(joint, pressure)}


def test_elastic_laws_apply_at_light_load_and_agree() -> None:
    """All three within a factor 1.6; each interval holds its own value."""
    found = at(case(), 0.003)
    names = ("persson", "greenwood_williamson", "bush_gibson_thomas")
    for name in names:
        curve = found[name]
        assert curve.outside == ((),)
        assert curve.low[0] < curve.stiffness[0] < curve.high[0]
    values = [found[name].stiffness[0] for name in names]
    assert max(values) < 1.6 * min(values)
    assert found["yovanovich"].outside[0][0].startswith("E* m / H")


@pytest.mark.parametrize(
    ("changes", "load", "words"),
    [
        ({"area": 0.2}, 0.003, "hills in the apparent area"),
        ({"area": 0.2}, 1e-6, "summits in contact"),
        ({}, 0.9, "p / (E* h')"),
        ({"hardness": 1e3}, 0.003, "stiffening by yielding"),
        ({"facts": replace(NORMAL, skewness=-1.2)}, 0.003, "skewness of -1.2"),
    ],
)
def test_a_law_outside_its_range_says_why(
    changes: dict[str, object], load: float, words: str
) -> None:
    """Number and limit of each reason."""
    reasons = at(case(**changes), load)["persson"].outside[0]
    assert any(words in one for one in reasons)


def test_few_contacts_follow_the_power_law_of_one_hill() -> None:
    """K ~ F^(1/(1+H)) below 18 contacts, F above; uncertain loads widen intervals."""
    joint = case(area=1.0)
    pressure = joint.modulus * joint.gradient * np.array([1e-7, 2e-7])
    stiffness = predict_measured(joint, pressure)[0].stiffness
    exponent = np.log(stiffness[1] / stiffness[0]) / np.log(2)
    # The number of contacts grows a little more slowly than the load.
    assert exponent == pytest.approx(1 / 1.8, abs=0.04)
    many = case()
    sure, unsure = (
        predict_measured(many, 1e4 * pressure[:1], sd)[0] for sd in (0.0, 0.3)
    )
    assert unsure.high[0] > 1.5 * sure.high[0]


def test_cumulants_of_independent_heights_add() -> None:
    """Two alike have a skewness smaller by 2^(1/2), a kurtosis by 2."""
    one = HeightFacts(-1.2, 1.0, 30.0, 1e-6)
    both = facts_of_both([one, one])
    assert_allclose(np.array([both.skewness, both.kurtosis]), [-1.2 / np.sqrt(2), 0.5])
    assert one.deviation is not None
    assert both.deviation is None or "skewness" in both.deviation
