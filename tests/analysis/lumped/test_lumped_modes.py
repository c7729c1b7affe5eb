# SPDX-License-Identifier: MIT
import numpy as np
from numpy.testing import assert_allclose

from jointbench.analysis.lumped.lumped_matrices import mass_matrix, stiffness_matrix
from jointbench.analysis.lumped.lumped_model import Body, Link, LumpedModel
from jointbench.analysis.lumped.lumped_modes import solve_modes


def chain(c0=0.0, cj=0.0):
    return LumpedModel(
        (Body("base", 9.0), Body("top", 4.0)),
        (
            Link("ground", ("ground", "base"), 3e7, c0),
            Link("joint", ("base", "top"), 2e7, cj),
        ),
    )


def test_frequencies_of_the_undamped_chain_solve_its_quadratic():
    """m1 m2 w^4 - (k0 m2 + kj (m1 + m2)) w^2 + k0 kj = 0."""
    squares = np.sort(np.roots([36.0, -(3e7 * 4 + 2e7 * 13), 6e14]))
    found = solve_modes(chain()).natural_frequency
    assert_allclose(found, np.sqrt(squares) / (2 * np.pi), rtol=1e-12)


def test_undamped_shapes_are_mass_normalised_and_diagonalise_the_stiffness():
    """Shape^T M shape is one, shape^T K shape the square of the frequency."""
    modes = solve_modes(chain())
    shapes = modes.shapes
    omega = 2 * np.pi * modes.natural_frequency
    assert_allclose(shapes @ mass_matrix(chain()) @ shapes.T, np.eye(2), atol=1e-10)
    stiff = shapes @ stiffness_matrix(chain()) @ shapes.T
    assert_allclose(stiff, np.diag(omega**2), atol=1e-9 * omega.max() ** 2)


def test_damping_in_proportion_to_stiffness_gives_the_known_ratios():
    """C = b K: zeta_r = b w_r / 2, and the natural frequencies stay."""
    factor = 6e-6
    modes = solve_modes(chain(3e7 * factor, 2e7 * factor))
    omega = 2 * np.pi * solve_modes(chain()).natural_frequency
    assert_allclose(2 * np.pi * modes.natural_frequency, omega, rtol=1e-12)
    assert_allclose(modes.damping_ratio, factor * omega / 2, rtol=1e-10)


def test_a_free_pair_has_one_mode_on_its_reduced_mass():
    """The rigid-body motion is left out."""
    model = LumpedModel(
        (Body("a", 5.0), Body("b", 3.0)), (Link("j", ("a", "b"), 1e7, 50.0),)
    )
    modes = solve_modes(model)
    assert_allclose(2 * np.pi * modes.natural_frequency, [np.sqrt(1e7 * 8 / 15)])
    assert_allclose(modes.damping_ratio, [50 / (2 * np.sqrt(1e7 * 15 / 8))])


def test_an_overdamped_body_has_no_mode():
    """Damping ratio 2: two decays, no frequency."""
    model = LumpedModel((Body("m", 1.0),), (Link("k", ("ground", "m"), 1e4, 400.0),))
    assert solve_modes(model).poles.size == 0


def test_a_soft_mount_beside_a_stiff_link_keeps_its_mode():
    """100 kg on 1 kN/m, and a gram on 1 GN/m of it: 0.503 Hz is no rigid motion."""
    model = LumpedModel(
        (Body("machine", 100.0), Body("chip", 1e-3)),
        (
            Link("mount", ("ground", "machine"), 1e3, 2.0),
            Link("solder", ("machine", "chip"), 1e9),
        ),
    )
    modes = solve_modes(model)
    assert modes.poles.size == 2
    omega = np.sqrt(1e3 / 100.001)
    assert_allclose(2 * np.pi * modes.natural_frequency[0], omega, rtol=1e-5)
    assert_allclose(modes.damping_ratio[0], 2 / (2 * 100.001 * omega), rtol=1e-4)
