# SPDX-License-Identifier: MIT
"""The lowest modes of a small dense matrix."""

import numpy as np
import pytest

from jointbench.analysis.structures.reduction.dense_modes import lowest_dense_modes

SIZE, COUNT, SHIFT = 240, 20, 1e6


@pytest.mark.parametrize("repeats", [1, 4])
def test_a_guess_without_any_wanted_mode_still_finds_them(repeats: int) -> None:
    random = np.random.default_rng(3)
    level = np.sort(np.repeat(10.0 ** random.uniform(0, 12, SIZE // repeats), repeats))
    vector = np.linalg.qr(random.standard_normal((SIZE, SIZE)))[0]
    matrix = (vector * level) @ vector.T
    # As of a symmetric machine at one set of joints: other modes are lowest at another.
    guess = vector[:, SIZE // 2 : SIZE // 2 + COUNT]
    found, shapes = lowest_dense_modes(0.5 * (matrix + matrix.T), SHIFT, COUNT, guess)
    np.testing.assert_allclose(found + SHIFT, level[:COUNT] + SHIFT, rtol=1e-6)
    np.testing.assert_allclose(shapes.T @ shapes, np.eye(COUNT), atol=1e-10)
