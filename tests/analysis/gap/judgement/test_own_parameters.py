# SPDX-License-Identifier: MIT
"""Parts of the records that need separate parameters."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from jointbench.analysis.gap.judgement.own_parameters import most_unlike
from jointbench.analysis.gap.residuals.fit_records import Blocks, Fit

RECORDS, CHANNELS, SAMPLES = 6, 2, 400
SHAPE = (RECORDS, CHANNELS, SAMPLES)
LEVELS = ("30 N", "30 N", "100 N", "100 N", "300 N", "300 N")


def shaken() -> tuple[np.ndarray, np.ndarray]:
    """Return two decaying slopes, and white noise as the residual of a minimum."""
    time = np.arange(SAMPLES)
    tones = [np.exp(-time / 90) * np.cos(w * time) for w in (0.2, 0.5)]
    slopes = np.stack([np.tile(t, RECORDS * CHANNELS) for t in tones], axis=1)
    noise = np.random.default_rng(3).standard_normal(slopes.shape[0])
    return slopes, noise


def worst(slopes: np.ndarray, residual: np.ndarray, allowed: float = 0.0) -> Any:
    """Fit the residual by the slopes, and divide the rest."""
    left = residual - slopes @ np.linalg.lstsq(slopes, residual, rcond=None)[0]
    group = np.repeat(np.arange(RECORDS), CHANNELS * SAMPLES)
    labels = tuple({"level": level} for level in LEVELS)
    bench: Any = SimpleNamespace(blocks=Blocks(group, labels, group.size, SHAPE))
    ones = np.ones(2)
    fit = Fit(ones, 2, (), left, slopes, float(left @ left), 0 * ones, ones)
    return most_unlike(bench, fit, allowed)


def test_white_noise_needs_no_separate_parameters() -> None:
    """Twelve divisions of noise show no significant difference."""
    assert worst(*shaken()).chance > 1e-3


@pytest.mark.parametrize(
    ("rows", "view"),
    [
        (np.isin(np.arange(RECORDS), (4, 5))[:, None, None], "level"),
        ((np.arange(CHANNELS) == 1)[None, :, None], "output"),
        ((np.arange(SAMPLES) < 50)[None, None, :], "time"),
    ],
)
def test_a_part_with_another_response_is_named(rows: np.ndarray, view: str) -> None:
    """Two sd along a slope, in one part only, are found in the view with that part."""
    slopes, noise = shaken()
    part = np.broadcast_to(rows, SHAPE).reshape(-1)
    unlike = worst(slopes, noise + 2.0 * part * slopes[:, 0])
    assert unlike.chance < 1e-6
    assert view in unlike.view


def test_a_line_of_the_spectrum_is_found() -> None:
    """A hum of half the noise's sd, with another phase in every record."""
    slopes, noise = shaken()
    phase = np.random.default_rng(5).uniform(0, 2 * np.pi, RECORDS * CHANNELS)
    hum = 0.5 * np.sin(1.3 * np.arange(SAMPLES)[None, :] + phase[:, None])
    unlike = worst(slopes, noise + hum.ravel())
    assert unlike.view == "line of the spectrum"
    assert unlike.chance < 1e-20


def test_the_model_error_of_a_law_is_allowed() -> None:
    """With an allowance of the size of the residual there is no finding."""
    slopes, noise = shaken()
    part = np.broadcast_to((np.arange(CHANNELS) == 1)[None, :, None], SHAPE).reshape(-1)
    data = noise + 2.0 * part * slopes[:, 0]
    found = worst(slopes, data)
    assert worst(slopes, data, allowed=found.excess).chance > 1e-3
