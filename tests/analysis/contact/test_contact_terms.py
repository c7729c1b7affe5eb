# SPDX-License-Identifier: MIT
"""Terms put in and taken out, the ways back, partial slip and damping."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from contact_cases import joint_case
from numpy.testing import assert_allclose
from scipy.integrate import quad

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.asperity import interference
from jointbench.analysis.contact.asperity_laws import REGIMES, Regime
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.damping import (
    DampingChoice,
    EnergyForm,
    LossConvention,
    damping_coefficient,
    damping_ratio,
    loss_factor,
)
from jointbench.analysis.contact.energy import joint_energy, recovered_share
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.inverse import approach_stiffness, preload_of
from jointbench.analysis.contact.joint_sums import joint_sums
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import CONTACT_MODELS, contact_model
from jointbench.analysis.contact.model_terms import ContactTerm, model_terms, with_term
from jointbench.analysis.contact.models import Interaction, Mode
from jointbench.analysis.contact.predict import ContactVerdict, predict_contact
from jointbench.analysis.contact.printed_formulas import printed_warnings
from jointbench.analysis.contact.solve import solve_largest_area
from jointbench.analysis.contact.tangential import sticking_share

IRON = ContactMaterial(69.3e9, 2.265e9, 0.25)


def surface_at(model, e=0.5, roughness=1e-9):
    """Return a surface `e` above the model's lowest dimension."""
    dimension = model.topography.lowest_dimension + e
    return FractalSurface(np.array(dimension), np.array(roughness), np.array(2.265e9))


@pytest.mark.parametrize("name", CONTACT_MODELS)
@pytest.mark.parametrize("term", ContactTerm)
def test_a_term_taken_out_and_put_back_leaves_the_model_as_it_was(name, term):
    """What acts is what was asked for, and nothing else changes."""
    model = contact_model(name)
    there = term in model_terms(model)
    other = with_term(model, term, present=not there)
    assert (term in model_terms(other)) is not there
    assert model_terms(other) ^ model_terms(model) == {term}
    if (
        term is not ContactTerm.FRICTION
    ):  # its absence has one criterion, its models two
        assert with_term(other, term, present=there) == model
    assert with_term(model, term, present=there) is model


@pytest.mark.parametrize("term", ContactTerm)
def test_a_load_is_carried_whatever_term_is_missing(term):
    """The search for the largest area holds for every combination."""
    model = contact_model("friction_3d")
    model = with_term(model, term, present=term not in model_terms(model))
    load = np.logspace(-2, 5, 8)
    surface = surface_at(model)
    solved = solve_largest_area(model, surface, IRON, load)
    found = joint_sums(model, surface, IRON, solved).load.sum(axis=0)
    assert_allclose(found, load, rtol=1e-11)


@pytest.mark.parametrize(
    ("term", "regime"),
    [
        (ContactTerm.ELASTIC, Regime.ELASTIC),
        (ContactTerm.PLASTIC, Regime.PLASTIC),
    ],
)
def test_a_missing_regime_bears_nothing(term, regime):
    """Neither load nor stiffness."""
    model = with_term(contact_model("ke_3d"), term, present=False)
    sums = contact_curve(
        model, dimension=2.5, roughness=1e-9, material=IRON, preload=1e3
    )
    number = REGIMES.index(regime)
    assert sums.load[number] == sums.stiffness[number] == 0


@pytest.mark.parametrize("name", CONTACT_MODELS)
def test_preload_is_found_back_from_stiffness_and_from_real_area(name):
    """There and back over four decades of load."""
    model = contact_model(name)
    surface = surface_at(model)
    load = np.logspace(0, 4, 5)
    sums = contact_curve(
        model,
        dimension=surface.dimension,
        roughness=1e-9,
        material=IRON,
        preload=load,
    )
    stiffness = sums.stiffness.sum(axis=0)
    by_stiffness = preload_of(model, surface, IRON, stiffness=stiffness)
    by_area = preload_of(model, surface, IRON, real_area=sums.real_area)
    assert_allclose(by_stiffness, load, rtol=1e-9)
    assert_allclose(by_area, load, rtol=1e-9)


@pytest.mark.parametrize(
    "bad", [{}, {"stiffness": 0.0}, {"real_area": -1.0}, {"stiffness": math.nan}]
)
def test_a_way_back_from_nothing_is_refused(bad):
    """One of the two, positive."""
    model = contact_model("ke_3d")
    with pytest.raises(BadData):
        preload_of(model, surface_at(model), IRON, **bad)


def test_approach_stiffness_is_the_slope_of_load_by_the_largest_interference():
    """A difference quotient over neighbouring loads."""
    model = contact_model("ke_3d_modified")
    surface = surface_at(model)
    load = 1e3 * np.array([0.9999, 1.0, 1.0001])
    sums = contact_curve(
        model, dimension=2.5, roughness=1e-9, material=IRON, preload=load
    )
    depth = interference(model, surface, sums.largest_area)
    slope = (load[2] - load[0]) / (depth[2] - depth[0])
    found = approach_stiffness(model, surface, IRON, sums)
    assert_allclose(found[1], slope, rtol=1e-6)


def test_a_tangential_load_softens_until_the_joint_slides():
    """(1 - T/(mu P))^(1/3), then nothing, and the verdict's reasons state it."""
    options = {
        "dimension": 2.5,
        "roughness": 1e-10,
        "material": IRON,
        "preload": 1e3,
        "friction": 0.2,
    }
    stuck = predict_contact(joint_case("ke_3d", **options)).tangential_stiffness
    partly = predict_contact(joint_case("ke_3d", tangential_load=100.0, **options))
    slides = predict_contact(joint_case("ke_3d", tangential_load=201.0, **options))
    assert_allclose(partly.tangential_stiffness / stuck, 0.5 ** (1 / 3))
    assert slides.tangential_stiffness == 0
    assert any("slides" in reason for reason in slides.reasons)


@pytest.mark.parametrize("bad", [(-1.0, 1.0, 0.3), (0.1, 0.0, 0.3), (0.1, 1.0, 0.0)])
def test_impossible_friction_is_refused(bad):
    """Load, preload and coefficient in turn."""
    with pytest.raises(BadData):
        sticking_share(*bad)


def energy_by_quadrature(model, surface, log_largest):
    """Sum loading, recovered and lost energy of single contacts, Hertz below yield."""
    e = float(surface.dimension) - model.topography.lowest_dimension
    g, q = model.topography.shape, (1 + e) / 2
    kappa = math.pi * (0.454 + 0.41 * IRON.poisson) * 2.265e9 / (2 * 69.3e9)
    flow = model.plastic.pressure_factor * 2.265e9 * g / (4 / 3 * 69.3e9 * kappa)
    unit_depth = float(interference(model, surface, np.array(1.0)))
    log_critical = (2 * math.log(unit_depth) + math.log(g) - 2 * math.log(kappa)) / e
    laws = [(0.0, 1.0, 1.5), (1.0, 1.03, 1.425), (6.0, 1.40, 1.263), (110.0, flow, 1.0)]

    def one(s):
        work = 0.0
        for (low, c, p), high in zip(laws, (1.0, 6.0, 110.0, math.inf), strict=True):
            if s > low:
                top = min(s, high)
                work += c * (top ** (p + 1) - low ** (p + 1)) / (p + 1)
                load = c * s**p
        back = work if s <= 1 else load * s * float(recovered_share(np.array(s)))
        return work, back, max(work - back, 0.0)

    def integrand(log_area, which):
        s = math.exp(e * (log_critical - log_area))
        area = math.exp(log_area)
        depth = unit_depth * math.exp((1 - e) / 2 * log_area) / s
        load = 4 / 3 * 69.3e9 * kappa * area / g / s
        weight = q * math.exp(q * (float(log_largest) - log_area))
        return one(s)[which] * load * depth * weight

    edges = [log_critical - math.log(b) / e for b in (1e30, 1e6, 110, 6, 1.2, 1.0)]
    edges = [min(x, float(log_largest)) for x in edges] + [float(log_largest)]
    kink = log_critical - math.log(1.2480) / e
    edges = sorted({*edges, min(kink, float(log_largest))})
    return [
        sum(
            quad(integrand, a, b, args=(i,), epsabs=0, epsrel=1e-11, limit=300)[0]
            for a, b in pairwise(edges)
        )
        for i in range(3)
    ]


@pytest.mark.parametrize("name", ["ke_2d", "ke_3d"])
@pytest.mark.parametrize("e", [0.35, 0.5])
@pytest.mark.parametrize("ratio", [1e-3, 0.5, 30.0])
def test_energies_equal_quadrature_of_single_contacts(name, e, ratio):
    """Loading and recovered to 1e-8; what is lost to the kink where loss begins."""
    model = contact_model(name)
    surface = surface_at(model, e)
    kappa = math.pi * (0.454 + 0.41 * IRON.poisson) * 2.265e9 / (2 * 69.3e9)
    unit = float(interference(model, surface, np.array(1.0)))
    log_critical = 2 * math.log(unit) + math.log(model.topography.shape)
    log_critical = (log_critical - 2 * math.log(kappa)) / e
    log_largest = np.array(log_critical - math.log(ratio) / e)
    found = joint_energy(model, surface, IRON, log_largest)
    wanted = energy_by_quadrature(model, surface, log_largest)
    assert_allclose(found.loading.sum(), wanted[0], rtol=1e-8)
    assert_allclose(found.recovered.sum(), wanted[1], rtol=1e-8)
    assert_allclose(found.dissipated.sum(), wanted[2], rtol=1e-6)


def test_elastic_contacts_lose_nothing_and_all_others_something():
    """By regime."""
    model = contact_model("ke_3d")
    energy = joint_energy(model, surface_at(model), IRON, np.log(1e-8))
    assert energy.dissipated[-1] == 0
    assert np.all(energy.dissipated[:-1] > 0)
    assert np.all(energy.dissipated <= energy.loading)


def test_both_conventions_of_the_loss_factor_differ_by_two_pi_of_the_stored_share():
    """W_d/W_e against W_d/(2 pi (W_e + W_d)), for both forms of the energies."""
    model = contact_model("ke_3d")
    arguments = (model, surface_at(model), IRON, np.log(1e-8))
    for form in EnergyForm:
        ratio = loss_factor(*arguments, form=form)
        other = loss_factor(*arguments, form=form, convention=LossConvention.PER_RADIAN)
        assert_allclose(other, ratio / (1 + ratio) / (2 * math.pi))


def test_damping_by_mass_is_that_at_the_frequency_of_mass_and_stiffness():
    """The form eta sqrt(M K) is eta K/omega at omega = sqrt(K/M)."""
    factor, stiffness = np.array(0.1), np.array(2.8e7)
    natural = math.sqrt(2.8e7 / 19.5) / (2 * math.pi)
    by_mass = damping_coefficient(factor, stiffness, DampingChoice(mass=19.5))
    by_line = damping_coefficient(factor, stiffness, DampingChoice(frequency=natural))
    assert_allclose(by_mass, by_line)
    assert_allclose(damping_ratio(float(by_mass), 2.8e7, 19.5), 0.05)


@pytest.mark.parametrize("bad", [{}, {"mass": 1.0, "frequency": 1.0}, {"mass": -1.0}])
def test_damping_needs_one_of_mass_and_frequency(bad):
    """Neither, both, negative."""
    with pytest.raises(BadData):
        DampingChoice(**bad)


def test_damping_of_a_joint_is_there_when_it_is_asked_for():
    """Loss factor times sqrt(M K)."""
    state = predict_contact(
        joint_case(
            "ke_3d",
            dimension=2.5,
            roughness=1e-9,
            material=IRON,
            preload=1e3,
            damping=DampingChoice(mass=10.0),
        )
    )
    wanted = state.loss_factor * math.sqrt(10.0 * state.normal_stiffness)
    assert_allclose(state.damping, wanted)


@pytest.mark.parametrize("name", CONTACT_MODELS)
def test_every_model_is_there_as_printed_and_names_its_faults(name):
    """Another number than corrected, with at least one fault and its size."""
    low = contact_model(name).topography.lowest_dimension
    options = {
        "dimension": low + 0.5,
        "roughness": 1e-9,
        "material": IRON,
        "preload": 1e3,
    }
    mended = predict_contact(joint_case(name, **options))
    printed = predict_contact(joint_case(name, mode="as-printed", **options))
    assert printed.mode is Mode.AS_PRINTED
    assert abs(printed.normal_stiffness / mended.normal_stiffness - 1) > 1e-3
    faults = printed_warnings(name, **options)
    assert faults
    assert set(faults) <= set(printed.reasons)
    assert all("times" in fault for fault in faults)


def test_a_printed_formula_without_a_value_is_refused():
    """Eq. (28) and its kin divide by zero at some dimensions; (27) at 309/184."""
    with pytest.raises(BadData, match="mode 'corrected'"):
        predict_contact(
            joint_case(
                "modified_2d",
                mode="as-printed",
                dimension=20 / 17,
                roughness=1e-9,
                material=IRON,
                preload=1e3,
            )
        )


def test_printed_interaction_has_a_stiffness_that_is_no_slope_of_its_load():
    """0.866 E sqrt(a) against 1.5 P/delta of eq. (18)."""
    model = contact_model("ke_3d_modified", "as-printed")
    surface = surface_at(model, 0.5, 1e-10)
    sums = joint_sums(model, surface, IRON, np.log(1e-4))
    plain = replace(model, interaction=Interaction.NONE)
    hertz = joint_sums(plain, surface, IRON, np.log(1e-4))
    stiff = sums.stiffness[-1] / hertz.stiffness[-1]
    assert_allclose(stiff, math.sqrt(3) / 2 / (2 / math.sqrt(math.pi)), rtol=1e-12)
    assert_allclose(sums.load[-1] / hertz.load[-1], 0.5463, rtol=1e-3)


def test_verdicts_do_not_depend_on_the_mode():
    """A plastic joint is plastic in both."""
    options = {"dimension": 2.05, "roughness": 1e-9, "material": IRON, "preload": 1e3}
    for mode in Mode:
        state = predict_contact(joint_case("ke_3d", mode=mode, **options))
        assert state.verdict is ContactVerdict.FULLY_PLASTIC
