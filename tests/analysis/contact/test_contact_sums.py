# SPDX-License-Identifier: MIT
"""The closed form of the joint sums against quadrature of the asperity laws."""

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from jointbench.analysis.contact.asperity import (
    asperity_load,
    asperity_stiffness,
    log_critical_area,
)
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.joint_sums import joint_sums, power_integral
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import CONTACT_MODELS, contact_model
from jointbench.analysis.contact.solve import solve_largest_area

STEEL = ContactMaterial(115e9, 2.3e9, 0.29, friction_factor=0.93)


def surface_of(model, offset, roughness=1e-9, hardness=STEEL.hardness):
    """Return one surface whose dimension is `offset` above the model's lowest."""
    low = contact_model(model).topography.lowest_dimension
    return FractalSurface(
        np.array(low + offset), np.array(roughness), np.array(hardness)
    )


def summed_by_quadrature(law, model, surface, log_largest):
    """Integrate `law` over the contact-area distribution, regime by regime."""
    record = contact_model(model)
    e = float(surface.dimension) - record.topography.lowest_dimension
    q = (1 + e) / 2
    log_critical = float(log_critical_area(record, surface, STEEL))

    def integrand(log_area):
        value = float(law(record, surface, STEEL, np.array(log_area)))
        return value * q * math.exp(q * (log_largest - log_area))

    # The plastic tail falls as a^((1-e)/2): e^-40 of it lies below the lowest limit.
    bounds = [log_critical - math.log(ratio) / e for ratio in (110.0, 6.0, 1.0)]
    lowest = min(bounds[0], log_largest) - 80 / (1 - e)
    limits = [lowest, *(min(bound, log_largest) for bound in bounds), log_largest]
    return [
        quad(integrand, low, high, epsabs=0, epsrel=1e-11, limit=200)[0]
        if high > low
        else 0.0
        for low, high in pairwise(limits)
    ]


@pytest.mark.parametrize("model", CONTACT_MODELS)
@pytest.mark.parametrize("seed", range(4))
def test_closed_form_equals_the_integral_over_the_contacts(model, seed):
    """Random surfaces, largest areas on both sides of the regime bounds."""
    random = np.random.default_rng(seed)
    surface = surface_of(
        model, random.uniform(0.2, 0.85), 10 ** random.uniform(-11, -7)
    )
    record = contact_model(model)
    e = float(surface.dimension) - record.topography.lowest_dimension
    for ratio in (300.0, 30.0, 3.0, 0.2):
        log_largest = float(log_critical_area(record, surface, STEEL))
        log_largest -= math.log(ratio) / e
        sums = joint_sums(record, surface, STEEL, np.array(log_largest))
        loads = summed_by_quadrature(asperity_load, model, surface, log_largest)
        slopes = summed_by_quadrature(asperity_stiffness, model, surface, log_largest)
        assert_allclose(sums.load, loads, rtol=1e-8)
        assert_allclose(sums.stiffness, slopes, rtol=1e-8)


@pytest.mark.parametrize("model", CONTACT_MODELS)
def test_load_and_stiffness_are_continuous_where_regimes_meet(model):
    """The laws jump at a bound, their integrals do not."""
    surface, record = surface_of(model, 0.5), contact_model(model)
    critical = log_critical_area(record, surface, STEEL)
    for ratio in (110.0, 6.0, 1.0):
        bound = critical - math.log(ratio) / 0.5
        below = joint_sums(record, surface, STEEL, bound - 1e-9)
        above = joint_sums(record, surface, STEEL, bound + 1e-9)
        assert_allclose(below.load.sum(), above.load.sum(), rtol=1e-8)
        scale = above.stiffness.sum() + record.topography.shape * STEEL.hardness
        assert abs(above.stiffness.sum() - below.stiffness.sum()) < 1e-8 * scale


@pytest.mark.parametrize(
    ("model", "offset"),
    [("ke_2d", 0.5), ("ke_2d", 20 / 37), ("ke_3d", 0.5), ("ke_3d", 20 / 37)],
)
def test_load_is_smooth_through_the_removable_singularities(model, offset):
    """Where an exponent of the closed form is zero, both neighbours agree with it."""
    critical = log_critical_area(contact_model(model), surface_of(model, offset), STEEL)
    # On either side by 1e-9; their mean differs from the middle by 1e-18 only.
    left, middle, right = (
        joint_sums(
            contact_model(model), surface_of(model, offset + shift), STEEL, critical + 8
        ).load
        for shift in (-1e-9, 0.0, 1e-9)
    )
    assert_allclose(middle, (left + right) / 2, rtol=1e-12)


@pytest.mark.parametrize("exponent", [0.0, 1e-12, -1e-7, 2e-6, -0.3, 0.7, 3.0])
def test_power_integral_equals_quadrature_for_any_exponent(exponent):
    """Also at and next to exponent zero, where the plain formula is 0/0."""
    low, high = math.log(1e-3), math.log(7.0)
    wanted = quad(lambda t: math.exp(exponent * t), low, high, epsabs=0, epsrel=1e-13)[
        0
    ]
    found = power_integral(np.array(exponent), np.array(low), np.array(high))
    assert_allclose(found, wanted, rtol=1e-12)


@pytest.mark.parametrize("model", CONTACT_MODELS)
def test_the_inverse_returns_the_area_whose_load_was_given(model):
    """From 1 mN to 1 MN, over the whole range of dimensions, at once."""
    record = contact_model(model)
    low = record.topography.lowest_dimension
    surface = FractalSurface(
        low + np.linspace(0.02, 0.98, 25)[:, None], np.array(1e-8), np.array(2.3e9)
    )
    load = np.logspace(-3, 6, 19)
    solved = solve_largest_area(record, surface, STEEL, load)
    sums = joint_sums(record, surface, STEEL, solved)
    assert solved.shape == (25, 19)
    assert_allclose(sums.load.sum(axis=0), np.broadcast_to(load, (25, 19)), rtol=1e-11)


def test_many_joints_at_once_equal_one_joint_at_a_time():
    """Dimension, roughness and preload broadcast."""
    record = contact_model("ke_3d_modified")
    dimension, roughness = np.array([[2.3], [2.6]]), np.array([1e-10, 1e-9, 1e-8])
    load = np.array(700.0)
    many = FractalSurface(dimension, roughness, np.array(2e9))
    together = solve_largest_area(record, many, STEEL, load)
    for i in range(2):
        for j in range(3):
            one = FractalSurface(dimension[i, 0], roughness[j], np.array(2e9))
            alone = solve_largest_area(record, one, STEEL, load)
            assert_allclose(together[i, j], alone, rtol=1e-13)
