# SPDX-License-Identifier: MIT
"""Harmonics of a joint's force are no modes."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.frf.linearity import Linearity
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.signal.modal.modes import identify_modes
from jointbench.signal.modal.response_harmonics import (
    Harmonic,
    possible_harmonics,
    without_growing_harmonics,
    without_vague_harmonics,
)

LINES = np.arange(1.0, 400.0, 0.5)
OMEGA = 2.0 * np.pi * np.array([80.0, 131.0, 240.2])
POLES = OMEGA * (-np.array([0.004, 0.006, 0.003]) + 1j)
SIZES = np.array([1.0, 0.4, 4e-4])


def modelled(growth: float) -> tuple[ModalModel, Frf, Linearity]:
    """Return two modes and a peak at three times the first, and how it grows."""
    s = 2j * np.pi * LINES
    own = 1.0 / (s - POLES[:, None]) - 1.0 / (s - POLES.conj()[:, None])
    terms = s**2 * SIZES[:, None] / (2j * OMEGA[:, None]) * own
    rng = np.random.default_rng(0)
    error = rng.normal(size=(2, LINES.size)) * 1e-5
    response = (terms.sum(axis=0) + error[0] + 1j * error[1])[None, None]
    frf = Frf(LINES, response, FrfKind.ACCELERANCE)
    change = np.abs(growth * terms[2]) / np.abs(response[0, 0])
    linearity = Linearity(change, LINES, 0.0, 1.0, 0.5, (0.1, 3.0), 8)
    return identify_modes(frf).model, frf, linearity


def test_place_decay_and_size_are_those_of_a_third_harmonic() -> None:
    """The peak at 240.2 Hz may be one; nearly as large as a mode it may not."""
    model, _, _ = modelled(0.0)
    assert possible_harmonics(model) == (Harmonic(2, 0, 3),)
    larger = replace(
        model, residues=model.residues * np.array([1, 1, 100])[:, None, None]
    )
    assert possible_harmonics(larger) == ()
    kept = replace(model, by_hand=np.array([False, False, True]))
    assert possible_harmonics(kept) == ()


@pytest.mark.parametrize(("growth", "modes"), [(0.0, 3), (0.7, 2), (1.4, 2), (20.0, 3)])
def test_a_peak_that_grows_with_the_level_is_left_out(
    growth: float, modes: int
) -> None:
    """Linear, quadratic and cubic growth; 20 times the peak is another's change."""
    model, frf, linearity = modelled(growth)
    left, words = without_growing_harmonics(model, ("another",), frf, linearity)
    assert left.natural_frequency.size == modes
    assert len(words) == 1 + 3 - modes
    if modes < 3:
        assert "Hz is at 3.00" in words[0]


def test_without_levels_it_stays_unless_its_damping_is_unknown() -> None:
    """A remark states what it may be, in both cases."""
    model, frf, _ = modelled(0.0)
    left, words = without_vague_harmonics(model)
    assert left.natural_frequency.size == 3
    assert "hit softly and hard" in words[0]
    assert without_growing_harmonics(model, words, frf, None) == (model, words)
    sd = model.damping_ratio_sd.copy()
    sd[2] = 0.4 * model.damping_ratio[2]
    left, words = without_vague_harmonics(replace(model, damping_ratio_sd=sd))
    assert left.natural_frequency.size == 2
    assert "left out" in words[0]
