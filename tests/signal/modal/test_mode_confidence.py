# SPDX-License-Identifier: MIT
"""How modes are rated, and how large the systematic part of their uncertainty is."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.signal.modal.mode_ranking import Grade, rate_modes
from jointbench.signal.modal.modes import ModalResult, ModalSettings, identify_modes


@pytest.fixture
def model(structure: Callable[..., Any], noisy_frf: Callable[..., Frf]) -> ModalModel:
    """Return three modes with the evidence that a test gives them."""
    truth = structure((200.0, 400.0, 600.0), (0.01, 0.01, 0.01))
    frf = noisy_frf(truth, np.arange(0.0, 800.0), noise=0.01, seed=1)
    found = identify_modes(frf, ModalSettings(highest_order=20)).model
    return replace(
        found,
        natural_frequency=np.array([200.0, 400.0, 600.0]),
        frequency_sd=np.array([0.2, 0.4, 0.6]),
        damping_ratio=np.array([0.01, 0.01, 0.2]),
        damping_ratio_sd=np.array([0.0001, 0.001, 0.002]),
        residual_ratio=np.array([100.0, 1.0, 4.0]),
        stable_orders=np.array([40, 10, 45], np.int64),
    )


def test_the_systematic_part_is_what_noise_does_not_explain(model: ModalModel) -> None:
    """Sd sqrt(1 - 1/residual_ratio): nearly all at a ratio of 100, 0 at 1."""
    rated = rate_modes(model, 50)
    assert rated.frequency_error == pytest.approx(
        [0.2 * np.sqrt(0.99), 0.0, 0.6 * np.sqrt(0.75)]
    )
    assert rated.damping_error[0] == pytest.approx(0.0001 * np.sqrt(0.99))


def test_confidence_is_share_of_orders_times_precision_of_damping(
    model: ModalModel,
) -> None:
    """40 of 50 orders and 1 % of damping: 0.8 x 0.97; 10 of 50 and 10 %: 0.2 x 0.7."""
    rated = rate_modes(model, 50)
    assert rated.confidence == pytest.approx([0.8 * 0.97, 0.2 * 0.7, 0.9 * 0.97])
    assert rated.rank.tolist() == [2, 3, 1]


def test_few_orders_are_doubtful_and_a_broad_pole_is_never_sure(
    model: ModalModel,
) -> None:
    """20 % of the orders; twenty times the usual damping."""
    rated = rate_modes(model, 50)
    assert rated.grades == (Grade.SURE, Grade.DOUBTFUL, Grade.FAIR)
    assert rated.broad.tolist() == [False, False, True]


def test_the_strong_modes_of_real_hits_are_sure(
    modes_of_real_hits: ModalResult,
) -> None:
    """The five that two independent fitters found rank among the upper half."""
    result = modes_of_real_hits
    found, rated = (
        result.model,
        rate_modes(result.model, result.stabilisation.orders.size),
    )
    for frequency in (810.2, 900.0, 2640.2, 3668.85, 4391.8):
        near = int(np.argmin(np.abs(found.natural_frequency - frequency)))
        assert rated.grades[near] is Grade.SURE
        assert rated.rank[near] <= found.natural_frequency.size // 2
    assert Grade.DOUBTFUL in rated.grades
