"""The ratio of accelerometer to hammer on a known mass, from made-up hits."""

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import NoHitFound
from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.signal.hits.ratio_calibration import calibrate_ratio

RATE, LENGTH, TRIGGER = 51_200.0, 4096, 256
CHANNELS = (
    Channel("force", Quantity.FORCE),
    Channel("a1", Quantity.ACCELERATION, "1", sensitivity=1e-3),
)


def on_a_mass(
    ratios: tuple[float, ...], *, mass: float = 4.0, bending: float = 0.0
) -> Recording:
    """Return half-sine hits on a mass, each indicated by a ratio of its own.

    Args:
        ratios: indicated over true acceleration, one a hit.
        mass: [kg].
        bending: acceleration by the force's second derivative, which rises as
            frequency squared [s^2], as the foot of a bending mode does.
    """
    pulse = np.zeros(LENGTH)
    pulse[TRIGGER : TRIGGER + 24] = 150.0 * np.sin(np.pi * np.arange(24) / 24) ** 2
    curved = np.gradient(np.gradient(pulse)) * RATE**2
    rows = [
        np.stack((pulse, ratio * (pulse - bending * curved) / mass)) for ratio in ratios
    ]
    hits = tuple(
        Hit(
            k * LENGTH,
            k * LENGTH + TRIGGER,
            (k + 1) * LENGTH,
            "1",
            150.0,
            Verdict.OK,
            0.0,
            "",
        )
        for k in range(len(ratios))
    )
    return Recording("mass", np.hstack(rows), RATE, CHANNELS, hits=hits)


def test_the_ratio_is_indicated_over_true_accelerance() -> None:
    """Indicated 3 % high on 4 kg; the only doubt is that of the mass, 1 g."""
    (found,) = calibrate_ratio([on_a_mass((1.03,) * 4)], mass=4.0, mass_sd=1e-3)
    assert found.ratio == pytest.approx(1.03, rel=1e-9)
    assert found.standard_uncertainty == pytest.approx(1.03 * 2.5e-4, rel=1e-3)
    assert found.expanded == pytest.approx(1.96 * 1.03 * 2.5e-4, rel=1e-3)
    assert found.passed


def test_scatter_of_the_hits_is_the_scatter_of_their_mean() -> None:
    """Four hits at 1 +- 0.002: s = 0.00231, of the mean 0.001155; t(3) = 3.18."""
    recording = on_a_mass((0.998, 1.002, 0.998, 1.002))
    (found,) = calibrate_ratio([recording], mass=4.0, mass_sd=0.0)
    assert found.repeatability == pytest.approx(0.001155, rel=1e-3)
    assert found.expanded == pytest.approx(3.182 * 0.001155, rel=1e-3)


def test_a_mass_that_bends_is_distinguished_from_a_rigid_one() -> None:
    """A ratio that rises by 8 % over the band fails, and is in the uncertainty."""
    recording = on_a_mass((1.0,) * 3, bending=3e-10)
    (found,) = calibrate_ratio([recording], mass=4.0, mass_sd=0.0)
    assert not found.passed
    assert found.standard_uncertainty == pytest.approx(
        found.ratio * found.flatness / np.sqrt(12), rel=1e-3
    )


def test_the_interval_holds_the_truth_as_often_as_it_says() -> None:
    """Five hits of 0.5 % scatter, 400 times: 95 % within three binomial sigmas."""
    rng = np.random.default_rng(3)
    inside = 0
    for _ in range(400):
        ratios = tuple((1.01 * (1 + 0.005 * rng.standard_normal(5))).tolist())
        (found,) = calibrate_ratio([on_a_mass(ratios)], mass=4.0, mass_sd=0.0)
        inside += abs(found.ratio - 1.01) < found.expanded
    assert abs(inside / 400 - 0.95) < 3 * np.sqrt(0.95 * 0.05 / 400)


def test_two_hits_are_too_few() -> None:
    """A scatter needs three."""
    with pytest.raises(NoHitFound, match="needs three"):
        calibrate_ratio([on_a_mass((1.0, 1.0))], mass=4.0, mass_sd=0.0)
