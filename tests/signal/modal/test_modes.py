# SPDX-License-Identifier: MIT
"""Modes from FRFs and from hammer hits, without start values."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import NoModeFound
from jointbench.acquisition.records.recordings import Quantity, Recording
from jointbench.signal.frf.frf import Frf, FrfKind, estimate_frf
from jointbench.signal.hits.find_hits import find_hits
from jointbench.signal.hits.windows import choose_window
from jointbench.signal.kalman.smoothing import smooth_recording
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.signal.modal.modes import (
    ModalResult,
    ModalSettings,
    identify_modes,
    orders_to_try,
)

LINES = np.arange(0.0, 1500.0, 0.5)


@pytest.mark.parametrize("kind", list(FrfKind))
def test_clean_modes_are_found_alone_in_any_kind_of_frf(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf], kind: FrfKind
) -> None:
    """Four modes at 1e-4 noise: all, no other, 1e-5 of f and 1 % of zeta."""
    truth = structure(
        (90.0, 300.0, 520.0, 1100.0),
        (0.02, 0.005, 0.01, 0.008),
        (1.0, -4.0, 9.0, -40.0),
    )
    frf = noisy_frf(truth, LINES, noise=1e-4, seed=0, kind=kind)
    model = identify_modes(frf).model
    assert model.natural_frequency == pytest.approx(truth.frequency, rel=1e-5)
    assert model.damping_ratio == pytest.approx(truth.damping, rel=0.01)
    assert np.allclose(model.residues, truth.residues(), rtol=0.02)


def test_a_pair_0_8_percent_apart_is_distinguished(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """One FRF, 1 % noise, half-power widths that overlap."""
    truth = structure((455.0, 458.5), (0.007, 0.011))
    model = identify_modes(noisy_frf(truth, LINES, noise=0.01, seed=1)).model
    assert model.natural_frequency == pytest.approx(truth.frequency, rel=5e-4)
    assert model.damping_ratio == pytest.approx(truth.damping, rel=0.1)


def test_the_benchmark_of_eight_modes_with_two_beyond_the_band() -> None:
    """40 outputs, 2 inputs, mildly complex shapes, 40 dB: 0.001 % of f, 0.1 % of zeta.

    Modes at 1500 and 2300 Hz stand beyond the 4096 lines from 0 to 1000 Hz; a pair is
    0.8 % apart. Peers reach 0.004 % and 0.15 %.
    """
    within = np.array([48.7, 112.0, 166.5, 240.0, 310.7, 455.0, 458.5, 720.0])
    omega = 2.0 * np.pi * np.r_[within, 1500.0, 2300.0]
    damping = np.array([1.2, 0.8, 1.0, 0.6, 0.9, 0.7, 1.1, 1.5, 1.0, 1.0]) / 100.0
    rng, mode = np.random.default_rng(0), np.arange(10)
    place = np.linspace(0.02, 1.0, 40)[:, None]
    shape = np.sin((mode + 0.5) * np.pi * 0.97 * place + 0.3 * mode)
    shape = shape * np.exp(1j * rng.normal(0.0, 0.03, (40, 10)))
    residue = shape[:, None] * shape[[39, 13]] / (2j * omega)
    pole = omega * (-damping + 1j * np.sqrt(1.0 - damping**2))
    frequency = np.linspace(0.0, 1000.0, 4096)
    s = 2j * np.pi * frequency
    response = np.einsum("oir,rl->oil", residue, 1.0 / (s - pole[:, None]))
    response += np.einsum(
        "oir,rl->oil", residue.conj(), 1.0 / (s - pole.conj()[:, None])
    )
    response = response * s**2
    sd = 0.01 * np.sqrt(np.mean(np.abs(response) ** 2, axis=2, keepdims=True))
    noise = rng.normal(size=response.shape) + 1j * rng.normal(size=response.shape)
    frf = Frf(frequency, response + sd * noise / np.sqrt(2.0), FrfKind.ACCELERANCE)
    model = identify_modes(frf).model
    assert model.natural_frequency == pytest.approx(within, rel=1e-5)
    assert model.damping_ratio == pytest.approx(damping[:8], rel=1e-3)


def test_noise_holds_no_modes() -> None:
    """Four seeds of white noise, and the message lists what was tried."""
    for seed in range(4):
        rng = np.random.default_rng(seed)
        noise = rng.normal(size=(1, 1, 3000)) + 1j * rng.normal(size=(1, 1, 3000))
        with pytest.raises(NoModeFound, match="orders 2 to 100"):
            identify_modes(Frf(LINES, noise, FrfKind.ACCELERANCE))


def test_no_mode_is_missed_or_made_up_on_random_structures(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """Six structures of 3 to 6 modes, 1 or 3 outputs, noise of 0.1 to 1 %."""
    for seed in range(6):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(3, 7))
        frequency = 80.0 * np.cumprod(rng.uniform(1.15, 1.6, n))
        constant = rng.choice([-1.0, 1.0], (n, 1 + 2 * (seed % 2), 1))
        constant = constant * rng.uniform(0.4, 1.0, constant.shape)
        truth = structure(
            tuple(frequency), tuple(10 ** rng.uniform(-2.5, -1.6, n)), constant
        )
        noise = 10 ** rng.uniform(-3.0, -2.0)
        frf = noisy_frf(truth, np.arange(0.0, 2500.0), noise=noise, seed=seed)
        model = identify_modes(frf).model
        assert model.natural_frequency == pytest.approx(frequency, rel=2e-3)


def test_stated_uncertainties_cover_the_truth(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """Forty noises, two modes: 95 % intervals hold the truth 85 to 100 % of the time.

    80 draws of a 95 % interval: 76 of them give or take 2; inflation makes it more.
    """
    truth, inside = structure((300.0, 700.0), (0.01, 0.02)), []
    for seed in range(40):
        frf = noisy_frf(truth, np.arange(0.0, 1200.0), noise=0.02, seed=seed)
        m = identify_modes(frf, ModalSettings(highest_order=20)).model
        inside.append(
            [
                np.abs(m.natural_frequency - truth.frequency) < 1.96 * m.frequency_sd,
                np.abs(m.damping_ratio - truth.damping) < 1.96 * m.damping_ratio_sd,
            ]
        )
    covered = np.mean(inside, axis=(0, 2))
    assert np.all(covered >= 0.85)


def test_refinement_removes_the_damping_bias_of_lscf(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """A weak mode at 5 % noise: LSCF is biased low by more than the refined error."""
    truth = structure((200.0, 700.0), (0.02, 0.01), (3.0, 1.0))
    frf = noisy_frf(truth, np.arange(0.0, 1200.0, 0.5), noise=0.05, seed=2)
    plain = identify_modes(frf, ModalSettings(refine=False)).model
    fine = identify_modes(frf).model
    bias = np.abs(plain.damping_ratio / truth.damping - 1.0).max()
    error = np.abs(fine.damping_ratio / truth.damping - 1.0).max()
    assert error < 0.05
    assert bias > 2.0 * error


def test_two_bodies_hit_by_a_hammer(
    structure: Callable[..., Any], hammered: Callable[..., Recording]
) -> None:
    """1 % noise, 4 hits: f within 0.1 %, zeta within 10 %, and nothing else."""
    truth = structure((210.0, 890.0), (0.008, 0.012), (1.0, -0.6))
    record = hammered(truth, peaks=(90.0, 100.0, 80.0, 110.0), noise=0.01, seed=6)
    model = identify_modes(estimate_frf(record)).model
    assert model.natural_frequency == pytest.approx(truth.frequency, rel=1e-3)
    assert model.damping_ratio == pytest.approx(truth.damping, rel=0.1)


def test_the_damping_of_the_exponential_window_is_removed(
    structure: Callable[..., Any], hammered: Callable[..., Recording]
) -> None:
    """0.3 % at 120 Hz: a window adds 0.6 %, the answer is 0.3 %."""
    truth = structure((120.0, 430.0), (0.003, 0.004))
    record = find_hits(hammered(truth, noise=1e-3, seed=7))
    window = replace(choose_window(record), decay_rate=4.5)
    frf = estimate_frf(record, window=window)
    model = identify_modes(frf).model
    assert frf.added_decay_rate > 0.3 * 0.01 * 2 * np.pi * 120.0
    assert model.damping_ratio == pytest.approx(truth.damping, rel=0.03)
    assert model.natural_frequency == pytest.approx(truth.frequency, rel=2e-4)


def test_the_kalman_stage_on_all_channels_biases_nothing_and_is_reported(
    structure: Callable[..., Any], hammered: Callable[..., Recording]
) -> None:
    """Modes with and without it agree to 1e-6 of f and 1e-3 of zeta."""
    truth = structure((210.0, 890.0), (0.008, 0.012))
    record = hammered(truth, noise=1e-4, seed=8)
    plain = identify_modes(estimate_frf(record), ModalSettings(band=(20.0, 1200.0)))
    staged = identify_modes(
        estimate_frf(smooth_recording(record)), ModalSettings(band=(20.0, 1200.0))
    )
    assert plain.stage_gain is None
    assert staged.stage_gain is not None
    assert staged.stage_gain.gain.shape == (2,)
    assert np.all(staged.stage_gain.phase == 0.0)
    one, other = plain.model, staged.model
    assert one.natural_frequency == pytest.approx(other.natural_frequency, rel=1e-5)
    assert one.damping_ratio == pytest.approx(other.damping_ratio, rel=2e-3)


def test_shapes_and_residues_carry_the_labels_of_outputs_and_inputs(
    structure: Callable[..., Any], hammered: Callable[..., Recording]
) -> None:
    """Two outputs moving 1 to -0.5 in the second mode."""
    constant = np.array([[[1.0], [0.8]], [[1.0], [-0.5]]])
    truth = structure((210.0, 890.0), (0.02, 0.02), constant)
    result = identify_modes(estimate_frf(hammered(truth, quantity=Quantity.VELOCITY)))
    model = result.model
    assert (model.outputs, model.inputs) == (("a1@1", "a2@2"), ("1",))
    assert model.shapes[1] == pytest.approx([1.0, -0.5], abs=1e-3)
    assert model.residues.shape == (2, 2, 1)
    assert np.allclose(
        model.shapes[:, :, None] * model.participation[:, None, :], model.residues
    )


def test_the_synthesis_gives_the_frf_back_and_says_how_well(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """At 1e-4 noise the error at the peaks is of that order."""
    truth = structure((300.0, 900.0), (0.01, 0.01))
    frf = noisy_frf(truth, LINES, noise=1e-4, seed=9)
    result = identify_modes(frf)
    assert result.synthesis.frequency.size == result.synthesis_error.size
    peak = int(np.argmin(np.abs(result.synthesis.frequency - 300.0)))
    assert result.synthesis_error[peak] < 1e-3
    assert result.band == (1.5, 1499.5)


def test_orders_are_about_fifty_and_end_at_the_highest() -> None:
    """100 for one input, half as many for two, fewer for few lines."""
    assert orders_to_try(ModalSettings(), 5000, 1)[-1] == 100
    assert orders_to_try(ModalSettings(), 5000, 2) == tuple(range(2, 51))
    assert orders_to_try(ModalSettings(), 120, 1)[-1] == 20
    assert orders_to_try(ModalSettings(highest_order=7), 5000, 1)[-1] == 7


REAL = (
    # lowest and highest reference [Hz], tolerance [Hz], damping low and high [%]
    (810.1, 810.3, 0.15, 0.13, 0.15),
    (900.0, 900.0, 0.15, 0.11, 0.13),
    (2640.2, 2640.2, 0.15, 0.0255, 0.0255),
    (3668.85, 3668.85, 0.3, 0.024, 0.033),
    (4391.8, 4391.8, 0.3, 0.054, 0.059),
)


@pytest.mark.parametrize(
    ("which", "smooth"),
    [
        ((0, 1, 2), True),
        ((2,), False),
    ],
)
def test_the_modes_of_the_real_structure_are_found(
    real_hits: tuple[Recording, ...], which: tuple[int, ...], smooth: bool
) -> None:
    """Two independent fitters agree on five; together or from a single hit.

    Each hit alone is in `test_three_real_hits_differ_by_no_more_than_stated`.
    """
    chosen = [real_hits[i] for i in which]
    frf = estimate_frf([smooth_recording(r) for r in chosen] if smooth else chosen)
    are_found(identify_modes(frf).model)


def test_the_modes_of_all_real_hits_are_found_as_they_were_measured(
    modes_of_real_hits: ModalResult,
) -> None:
    """The same five from the three hits together, not smoothed."""
    are_found(modes_of_real_hits.model)


def are_found(model: ModalModel) -> None:
    """Assert that the five modes of two independent fitters are among those found."""
    for low, high, reach, least, most in REAL:
        i = int(np.argmin(np.abs(model.natural_frequency - 0.5 * (low + high))))
        assert low - reach <= model.natural_frequency[i] <= high + reach
        assert 0.8 * least <= 100.0 * model.damping_ratio[i] <= 1.2 * most


def test_three_real_hits_differ_by_no_more_than_stated(
    real_hits: tuple[Recording, ...],
) -> None:
    """Each of the five is found in every hit alone, within 3 sd of the average."""
    settings = ModalSettings(band=(20.0, 5000.0))
    models = [identify_modes(estimate_frf(r), settings).model for r in real_hits]
    for model in models:
        are_found(model)
    for low, high, *_ in REAL:
        rows = [
            int(np.argmin(np.abs(m.natural_frequency - 0.5 * (low + high))))
            for m in models
        ]
        f = [m.natural_frequency[i] for m, i in zip(models, rows, strict=True)]
        sd = [m.frequency_sd[i] for m, i in zip(models, rows, strict=True)]
        assert np.all(np.abs(f - np.mean(f)) < 3.0 * np.array(sd))


def test_the_heavily_damped_modes_of_a_real_tool_are_found(tool_frf: Frf) -> None:
    """Receptance of five points with drift at DC: 1 % of f, 25 % of zeta."""
    model = identify_modes(tool_frf).model
    for low, high, least, most in (
        (1067.5, 1068.5, 3.3, 3.4),
        (1955.0, 1962.0, 4.1, 5.0),
        (2602.9, 2611.9, 2.5, 2.6),
    ):
        fits = (model.natural_frequency > 0.99 * low) & (
            model.natural_frequency < 1.01 * high
        )
        percent = 100.0 * model.damping_ratio
        fits &= (percent > 0.75 * least) & (percent < 1.25 * most)
        assert fits.any()
