"""Joints near the lower end of the fractal dimension, against unbounded exponents."""

import numpy as np
import pytest
from contact_cases import joint_case
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.inverse import log_largest_of_stiffness
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import CONTACT_MODELS
from jointbench.analysis.contact.predict import ContactVerdict, predict_contact

mpmath = pytest.importorskip("mpmath", reason="an oracle of the tests only")

CAST_IRON = ContactMaterial(effective_modulus=69.3e9, hardness=2.265e9)
# Harder than any solid: kappa > pi, so that contacts stay elastic as e falls.
ELASTIC = ContactMaterial(effective_modulus=69.3e9, hardness=2e11)
EXCESSES = (1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 3e-3, 6.6e-3, 8e-3, 0.02, 0.3)
# (coefficient, exponent) of the load by regime, plastic last; eq. of Kogut and Etsion.
STAGES = ((1.40, 1.263, 110, 6), (1.03, 1.425, 6, 1), (1.0, 1.5, 1, None))


def exact(model, e, roughness, material, log_largest):
    """Return loads and stiffnesses by regime with the critical area for a unit.

    That is how the papers write the sums; a hundred digits and exponents without bound
    make the plain differences of powers exact.
    """
    mp = mpmath.mp
    plane, share = model.topography.name == "profile", mp.mpf(1)
    g = mp.pi**2 if plane else mp.pi
    if model.interaction.value != "none":
        share = mp.findroot(lambda x: 16 * x**3 / (9 * g) - (1 - x) ** 2, 0.7)
    ratio = mp.mpf(material.hardness) / material.effective_modulus
    kappa = {
        "hardness": mp.pi * ratio / 2,
        "friction": 33 * mp.pi * ratio / mp.mpf("2.8") / 40,
    }.get(model.yielding.value)
    if kappa is None:
        kappa = mp.pi * (mp.mpf(0.454) + mp.mpf(0.41) * material.poisson) * ratio / 2
    height = mp.mpf(roughness) ** e
    if not plane:
        height *= 2 ** ((5 - 3 * e) / 2) * mp.sqrt(mp.log(mp.mpf(1.5)))
        height *= mp.pi ** ((e - 1) / 2)
    critical = (height**2 * g / kappa**2) ** (1 / e)
    q, largest = (1 + e) / 2, mp.exp(mp.mpf(log_largest)) / critical
    pressure = 4 * mp.mpf(material.effective_modulus) * kappa * critical / (3 * g)
    slope = 4 * mp.mpf(material.effective_modulus) * mp.sqrt(critical / g) / 3

    def power(s, low, high):
        low, high = min(low, largest), min(high, largest)
        return (high**s - low**s) / s * q * largest**q

    edge = min(mp.mpf(110) ** (-1 / e), largest)
    if model.name == "mb_2d":
        edge = min(mp.mpf(1), largest)
    flow = mp.mpf(material.hardness) * critical * (1 if plane else 2)
    loads = [flow * q * largest**q * edge ** (1 - q) / (1 - q)]
    stiffnesses = [mp.mpf(0)]
    for coefficient, m, upper, lower in STAGES:
        if model.name == "mb_2d" and lower is not None:
            loads, stiffnesses = [*loads, mp.mpf(0)], [*stiffnesses, mp.mpf(0)]
            continue
        factor = mp.mpf(coefficient) * (share**1.5 if lower is None else 1)
        low = mp.mpf(upper) ** (-1 / e)
        high = largest if lower is None else mp.mpf(lower) ** (-1 / e)
        loads.append(factor * pressure * power(q - m * e, low, high))
        stiffnesses.append(factor * m * slope * power((1 - mp.mpf(m)) * e, low, high))
    return loads, stiffnesses


@pytest.mark.parametrize("material", [CAST_IRON, ELASTIC], ids=["iron", "elastic"])
@pytest.mark.parametrize("name", CONTACT_MODELS)
def test_load_and_stiffness_hold_however_near_the_dimension_is_to_its_end(
    name, material
):
    """Every sum equals the papers' form in unbounded arithmetic, and the load is met.

    Where contacts are elastic a stiffness is (1 - m) e into the power of an area, so
    what is left of 16 digits is checked to 1e-9.
    """
    model = CONTACT_MODELS[name]
    with mpmath.workdps(100):
        for excess in EXCESSES:
            dimension = model.topography.lowest_dimension + excess
            sums = contact_curve(
                model,
                dimension=dimension,
                roughness=1e-9,
                material=material,
                preload=4000.0,
            )
            e = mpmath.mpf(dimension) - model.topography.lowest_dimension
            log_largest = float(np.log(sums.largest_area))
            loads, stiffnesses = exact(model, e, 1e-9, material, log_largest)
            total = float(sum(stiffnesses))
            assert_allclose(float(sum(loads)), 4000.0, rtol=1e-9)
            assert_allclose(sums.load.sum(), 4000.0, rtol=1e-9)
            assert_allclose(sums.stiffness.sum(), total, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("name", CONTACT_MODELS)
def test_no_joint_of_metal_near_the_lower_end_is_called_usable(name):
    """Below 0.0066 the stiffness was up to 1e15 N/m; every contact is plastic there."""
    model = CONTACT_MODELS[name]
    for excess in (1e-9, 1e-4, 1e-3, 0.0066, 0.0067):
        state = predict_contact(
            joint_case(
                name,
                dimension=model.topography.lowest_dimension + excess,
                roughness=1e-9,
                material=CAST_IRON,
                preload=4000.0,
            )
        )
        assert state.normal_stiffness == 0.0
        assert state.tangential_stiffness == 0.0
        assert state.verdict is ContactVerdict.FULLY_PLASTIC
        assert any("is below the critical area, 10^" in line for line in state.reasons)


def test_a_stiffness_that_no_contact_area_gives_is_refused_on_the_way_back():
    """Contacts of half the Earth's area are still plastic at D = 1.001."""
    surface = FractalSurface(np.array(1.001), np.array(1e-9), np.array(2.265e9))
    with pytest.raises(BadData, match="all contacts stay fully plastic"):
        log_largest_of_stiffness(CONTACT_MODELS["modified_2d"], surface, CAST_IRON, 3e7)
