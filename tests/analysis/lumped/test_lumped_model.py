# SPDX-License-Identifier: MIT
import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.lumped.lumped_matrices import (
    damping_matrix,
    mass_matrix,
    predict_frf,
    stiffness_matrix,
)
from jointbench.analysis.lumped.lumped_model import Body, Link, LumpedModel
from jointbench.analysis.lumped.lumped_modes import solve_modes
from jointbench.signal.frf.frf import FrfKind

CHAIN = LumpedModel(
    (Body("base", 9.0), Body("top", 4.0)),
    (
        Link("ground", ("ground", "base"), 3e7, 200.0),
        Link("joint", ("base", "top"), 2e7, 120.0),
    ),
)


def test_matrices_of_a_chain_are_the_textbook_ones():
    """Each link adds to the diagonal of both its ends and couples them."""
    assert_allclose(mass_matrix(CHAIN), np.diag([9.0, 4.0]))
    assert_allclose(stiffness_matrix(CHAIN), [[5e7, -2e7], [-2e7, 2e7]])
    assert_allclose(damping_matrix(CHAIN), [[320.0, -120.0], [-120.0, 120.0]])


@pytest.mark.parametrize(
    ("kind", "factor"),
    [
        (FrfKind.RECEPTANCE, lambda s: 1.0),
        (FrfKind.MOBILITY, lambda s: s),
        (FrfKind.ACCELERANCE, lambda s: s**2),
    ],
)
def test_frf_of_one_body_is_the_closed_form(kind, factor):
    """1/(k - m w^2 + j w c), differentiated as often as the kind says."""
    model = LumpedModel((Body("m", 2.0),), (Link("k", ("ground", "m"), 8e6, 30.0),))
    frequency = np.array([0.0, 100.0, 318.3, 900.0])
    s = 2j * np.pi * frequency
    wanted = factor(s) / (2.0 * s**2 + 30.0 * s + 8e6)
    found = predict_frf(model, frequency, kind=kind)
    assert_allclose(found.response[0, 0], wanted, rtol=1e-12)
    assert found.kind is kind


def test_frf_is_the_sum_over_the_modes():
    """Receptance from mass-normalised complex shapes equals the matrix inverse."""
    frequency = np.linspace(1.0, 800.0, 40)
    s = 2j * np.pi * frequency
    modes = solve_modes(CHAIN)
    total = np.zeros((2, 2, 40), complex)
    for pole, shape in zip(modes.poles, modes.shapes, strict=True):
        residue = np.outer(shape, shape) / (2j * pole.imag)
        total += residue[..., None] / (s - pole)
        total += residue.conj()[..., None] / (s - pole.conj())
    found = predict_frf(CHAIN, frequency, kind=FrfKind.RECEPTANCE).response
    assert_allclose(found, total, rtol=1e-9, atol=1e-12 * np.abs(total).max())


def test_frf_is_labelled_and_ordered_by_the_bodies_asked_for():
    """Two outputs, one input: the rows follow the request."""
    frequency = np.array([50.0, 60.0])
    full = predict_frf(CHAIN, frequency)
    part = predict_frf(CHAIN, frequency, outputs=("top", "base"), inputs=("base",))
    assert part.outputs == ("top", "base")
    assert part.inputs == ("base",)
    assert_allclose(part.response[:, 0], full.response[::-1, 0])


def test_a_body_that_does_not_exist_is_refused_by_name():
    """The message lists the bodies."""
    with pytest.raises(UsageError, match=r"'lid'.*base"):
        predict_frf(CHAIN, np.array([1.0]), inputs=("lid",))


@pytest.mark.parametrize(
    ("bodies", "links", "match"),
    [
        ((Body("a", 1.0), Body("a", 2.0)), (), "unique"),
        ((Body("ground", 1.0),), (), "ground"),
        ((Body("a", 0.0),), (), "mass"),
        ((Body("a", 1.0),), (Link("k", ("a", "a"), 1.0),), "two different"),
        ((Body("a", 1.0),), (Link("k", ("a", "b"), 1.0),), "two different"),
        ((Body("a", 1.0),), (Link("k", ("a", "ground"), -1.0),), "stiffness"),
        ((Body("a", 1.0),), (Link("k", ("a", "ground"), 1.0, np.nan),), "damping"),
        ((Body("a", 1.0),), (Link("k", ("a", "ground"), 1e300),), "at most 1e"),
    ],
)
def test_a_model_that_cannot_be_built_is_refused(bodies, links, match):
    """Names, ends, masses and stiffnesses are checked once."""
    with pytest.raises(UsageError, match=match):
        LumpedModel(bodies, links)


@pytest.mark.parametrize("mass", [1e-300, 1e300])
def test_a_mass_no_body_has_is_refused(mass):
    """Its eigenvalues would overflow."""
    with pytest.raises(UsageError, match=r"mass of body 'a'.*1e-09 to 1e\+09 kg"):
        LumpedModel((Body("a", mass),), (Link("k", ("a", "ground"), 1.0),))
