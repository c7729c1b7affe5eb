# SPDX-License-Identifier: MIT
"""Which modes of a fit the FRF needs."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal import mode_significance
from jointbench.signal.modal.frf_lines import lines_of
from jointbench.signal.modal.line_noise import roughness
from jointbench.signal.modal.mode_significance import needed

LINES = np.arange(20.0, 1000.0, 1.0)
NONE = np.empty(0, complex)


@pytest.mark.parametrize("size", [0.0, 2e-5, 1e-3, 1.0])
def test_a_few_frfs_decide_as_all_do(
    structure: Callable[..., Any],
    noisy_frf: Callable[..., Frf],
    monkeypatch: pytest.MonkeyPatch,
    size: float,
) -> None:
    """Thirty FRFs, a second mode that all need, a few need, or none needs."""
    shapes = np.random.default_rng(1).normal(size=(2, 30, 1))
    constant = shapes * np.array([1.0, size])[:, None, None]
    truth = structure((300.0, 600.0), (0.01, 0.01), constant)
    lines = lines_of(noisy_frf(truth, LINES, noise=0.02, seed=2), LINES > 0.0)
    noise = roughness(lines.response)
    given = (lines, truth.poles, np.zeros(2, bool), noise, noise, NONE)
    quick = needed(*given)
    monkeypatch.setattr(mode_significance, "_FIRST_FRFS", 1000)
    assert quick.tolist() == needed(*given).tolist()
    assert quick.size == (2 if size > 1e-4 else 1)


def test_of_two_candidates_at_one_mode_one_is_left(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """Either of them alone is hardly needed; both were dropped once."""
    truth = structure((300.0, 600.0), (0.01, 0.01))
    lines = lines_of(noisy_frf(truth, LINES, noise=0.01, seed=2), LINES > 0.0)
    poles = np.append(truth.poles, truth.poles * (1.0 + 1e-6))
    noise = roughness(lines.response)
    left = needed(lines, poles, np.zeros(4, bool), noise, noise, NONE)
    assert sorted(left % 2) == [0, 1]
