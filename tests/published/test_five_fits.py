"""The five structure-function fits printed in Appl. Sci. 2025, 15, 9040."""

import numpy as np
import pytest

from jointbench.signal.fractal.fractal_fit import fractal_from_line

# Slope and intercept (base 10) of the five lines below Fig. 7.
LINES = (
    (0.738, -15.149),
    (0.903, -12.050),
    (1.083, -9.771),
    (0.6741, -16.12),
    (1.198, -7.781),
)


def test_the_five_lines_give_the_printed_dimension_and_roughness() -> None:
    """With C as printed: D = 1.5404, and the arithmetic mean G = 9.497e-12 m."""
    found = [fractal_from_line(*line, constant="as-printed") for line in LINES]
    assert np.mean([one.dimension for one in found]) == pytest.approx(1.54039, abs=1e-6)
    roughness = np.mean([one.roughness for one in found])
    assert roughness == pytest.approx(9.4986e-12, rel=1e-4)


def test_one_profile_supplies_most_of_the_printed_mean() -> None:
    """The five G span a factor above 100: an arithmetic mean is not informative."""
    found = [fractal_from_line(*line, constant="as-printed") for line in LINES]
    values = np.array([one.roughness for one in found])
    assert values.max() / values.min() > 100
    assert values.max() / values.sum() > 0.8


def test_the_corrected_constant_gives_a_smaller_roughness() -> None:
    """C as printed lacks (2 pi)^(4-2D), which inflates G by (2 pi)^((2-D)/(D-1))."""
    for slope, intercept in LINES:
        printed = fractal_from_line(slope, intercept, constant="as-printed")
        corrected = fractal_from_line(slope, intercept, constant="corrected")
        power = (2 - printed.dimension) / (printed.dimension - 1)
        assert printed.roughness / corrected.roughness == pytest.approx(
            (2 * np.pi) ** power, rel=1e-9
        )
