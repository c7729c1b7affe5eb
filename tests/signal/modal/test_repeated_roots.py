# SPDX-License-Identifier: MIT
"""Two modes at one frequency: both reported, or the second remarked on."""

import numpy as np
import pytest
from hammered_structures import Bench, Strike, Structure, square_membrane, strike

from jointbench.signal.frf.frf import Frf, FrfKind, estimate_frf
from jointbench.signal.modal.frf_lines import lines_of
from jointbench.signal.modal.mode_selection import fit_modes
from jointbench.signal.modal.modes import ModalResult, ModalSettings, identify_modes
from jointbench.signal.modal.residual_search.second_modes import (
    FrfSides,
    peak_members,
    second_modes,
    without_third,
)

SETTINGS = ModalSettings(band=(15.0, 150.0), highest_order=20)
LINES = np.arange(0.0, 200.0, 0.25)
POLE = 2.0 * np.pi * 100.0 * (-0.01 + 1j * np.sqrt(1.0 - 1e-4))


def struck_membrane(seed: int) -> tuple[Structure, ModalResult]:
    """Return a square net and its modes up to 150 Hz, from two references."""
    rng = np.random.default_rng(seed)
    net = square_membrane(5, 80.0, 0.006, 0.0, 8, rng)
    strikes = [Strike(point, (6, 7), ("a1", "a2")) for point in range(6)]
    measured = strike(net, strikes, Bench(hits=2), rng)
    return net, identify_modes(estimate_frf(measured.recordings), SETTINGS)


def pair_of(second: float, *, noise: float = 1e-3) -> Frf:
    """Return the FRF of two modes at one pole, the second of a given size."""
    rng = np.random.default_rng(4)
    shapes = rng.normal(size=(2, 6))
    residue = np.outer(shapes[0], (1.0, 0.4)) + second * np.outer(shapes[1], (-0.4, 1))
    s = 2j * np.pi * LINES
    own = 1.0 / (s - POLE) - 1.0 / (s - POLE.conjugate())
    exact = residue[:, :, None] * own * s**2 / 2j
    size = noise * np.abs(exact).max()
    error = rng.normal(size=exact.shape) + 1j * rng.normal(size=exact.shape)
    return Frf(LINES, exact + size * error, FrfKind.ACCELERANCE)


@pytest.mark.parametrize("seed", [1, 2])
def test_both_modes_of_a_square_net_are_found(seed: int) -> None:
    """(1, 2) and (2, 1) at one pole: both, within five standard deviations."""
    net, result = struck_membrane(seed)
    truth = net.poles()[0]
    truth = truth[np.abs(truth) < 2.0 * np.pi * 140.0]
    model = result.model
    assert model.natural_frequency.size == truth.size == 3
    error = model.natural_frequency - np.abs(truth) / (2.0 * np.pi)
    assert np.all(np.abs(error) < 5.0 * model.frequency_sd + 1e-4)
    error = model.damping_ratio + truth.real / np.abs(truth)
    assert np.all(np.abs(error) < 5.0 * model.damping_ratio_sd + 1e-6)


def test_shapes_of_a_pair_span_those_of_the_modes() -> None:
    """One pole leaves the two shapes free within their plane, not outside it."""
    model = identify_modes(pair_of(0.5), SETTINGS).model
    assert model.natural_frequency == pytest.approx([100.0, 100.0], rel=1e-4)
    shapes = np.random.default_rng(4).normal(size=(2, 6))
    plane = np.linalg.qr(shapes.T)[0]
    inside = np.linalg.norm(model.shapes @ plane, axis=1)
    assert inside == pytest.approx(np.linalg.norm(model.shapes, axis=1), rel=1e-3)


def test_two_pairs_within_a_width_are_four_modes() -> None:
    """At 100 and at 100.8 Hz, half-power width 2 Hz: within 4 sd and 0.1 Hz."""
    rng = np.random.default_rng(8)
    shapes, references = rng.normal(size=(4, 6)), rng.normal(size=(4, 2))
    poles = np.repeat([POLE, 1.008 * POLE], 2)
    s = 2j * np.pi * LINES
    own = 1.0 / (s - poles[:, None]) - 1.0 / (s - poles.conj()[:, None])
    exact = np.einsum("mo,mi,ml->oil", shapes, references, own * s**2 / 2j)
    error = rng.normal(size=(2, *exact.shape))
    noisy = exact + 1e-3 * np.abs(exact).max() * (error[0] + 1j * error[1])
    model = identify_modes(Frf(LINES, noisy, FrfKind.ACCELERANCE), SETTINGS).model
    error = model.natural_frequency - np.abs(poles) / (2.0 * np.pi)
    assert np.all(np.abs(error) < np.minimum(4.0 * model.frequency_sd, 0.1))


@pytest.mark.parametrize(("away", "gone"), [(0.06, [1]), (0.3, [])])
def test_a_third_mode_at_the_pole_of_a_pair_goes(away: float, gone: list[int]) -> None:
    """Two references cannot show it: left out within a tenth of a half-power width."""
    inside = (LINES > 15.0) & (LINES < 150.0)
    lines = lines_of(pair_of(0.5), inside)
    poles = np.array([POLE, POLE - 1j * away * POLE.real])
    fitted = fit_modes(lines, poles, None, held=np.ones(2, bool), refine=False)
    sides = FrfSides(lines, fitted.poles, fitted.fit, fitted.variance, None, 6, 2)
    found = second_modes(sides, peak_members(lines, fitted.poles.pole, 0))
    alone = without_third(sides, found)
    assert found.members.tolist() == [0, 1]
    assert alone.replaced.tolist() == gone
    assert alone.accepted == bool(gone)
    assert alone.left < 1.05


def test_a_single_mode_stays_one_without_a_remark() -> None:
    """Rank one within noise: nothing is added, nothing is remarked on."""
    result = identify_modes(pair_of(0.0), SETTINGS)
    assert result.model.natural_frequency.size == 1
    assert result.remarks == ()


def test_a_weak_second_mode_is_reported_or_remarked_on() -> None:
    """From a tenth of the first down to the noise, never passed over."""
    for second in (0.1, 0.03, 0.015):
        result = identify_modes(pair_of(second), SETTINGS)
        found = result.model.natural_frequency.size
        assert found == 2 or any("100" in words for words in result.remarks)


@pytest.mark.parametrize("third", [0.0, 0.7])
def test_a_pair_before_two_references_leaves_room_for_a_third(third: float) -> None:
    """Its rank is used up, whether a third mode is at that frequency or not."""
    rng = np.random.default_rng(6)
    shapes = rng.normal(size=(3, 6))
    references = np.array([(1.0, 0.4), (-0.4, 1.0), (0.7, -0.7)])
    size = np.array([1.0, 0.8, third])
    residue = np.einsum("m,mo,mi->oi", size, shapes, references)
    s = 2j * np.pi * LINES
    own = 1.0 / (s - POLE) - 1.0 / (s - POLE.conjugate())
    exact = residue[:, :, None] * own * s**2 / 2j
    error = rng.normal(size=(2, *exact.shape))
    noisy = exact + 1e-3 * np.abs(exact).max() * (error[0] + 1j * error[1])
    result = identify_modes(Frf(LINES, noisy, FrfKind.ACCELERANCE), SETTINGS)
    assert result.model.natural_frequency == pytest.approx([100.0, 100.0], rel=1e-3)
    used = [one for one in result.remarks if "as many as 2 references" in one]
    assert len(used) == 1 and used[0].startswith("modes 1, 2 at ")


def test_one_mode_before_two_references_is_not_remarked_on() -> None:
    """A single mode leaves a column of the residue free for a second one."""
    result = identify_modes(pair_of(0.0), SETTINGS)
    assert result.model.natural_frequency.size == 1
    assert not result.remarks
