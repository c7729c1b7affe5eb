# SPDX-License-Identifier: MIT
"""Choices made by hand."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.manual_selection import Choices
from jointbench.signal.modal.modes import ModalSettings, identify_modes

LINES = np.arange(0.0, 1200.0)


@pytest.fixture
def frf(structure: Callable[..., Any], noisy_frf: Callable[..., Frf]) -> Frf:
    """Two modes at 1 % noise."""
    truth = structure((300.0, 700.0), (0.01, 0.02))
    return noisy_frf(truth, LINES, noise=0.01, seed=0)


def test_a_mode_dropped_by_hand_is_gone_and_the_record_says_so(frf: Frf) -> None:
    """One of two, named within 1 % of its frequency."""
    model = identify_modes(
        frf, ModalSettings(highest_order=20, choices=Choices(drop=(302.0,)))
    ).model
    assert model.natural_frequency == pytest.approx([700.0], rel=0.01)
    assert dict(model.provenance[-1].detail)["dropped_by_hand"] == "302 Hz"


def test_a_mode_kept_by_hand_is_marked(frf: Frf) -> None:
    """The other one is automatic."""
    model = identify_modes(
        frf, ModalSettings(highest_order=20, choices=Choices(keep=(700.0,)))
    ).model
    assert model.by_hand.tolist() == [False, True]
    assert dict(model.provenance[-1].detail)["kept_by_hand"] == "700 Hz"


def test_a_frequency_without_a_pole_is_refused_with_the_nearest(frf: Frf) -> None:
    """500 Hz lies between both."""
    settings = ModalSettings(highest_order=20, choices=Choices(drop=(500.0,)))
    with pytest.raises(UsageError, match=r"within 1 % of 500 Hz to drop; nearest: \d"):
        identify_modes(frf, settings)
