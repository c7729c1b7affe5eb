# SPDX-License-Identifier: MIT
"""The damped transform: noise at the band end, and independence of records."""

import gap_bench as made
import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.response import excitation as forward
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.gap.response.excitation import Excitation, prepare_excitation
from jointbench.analysis.gap.response.predict_records import respond

SAMPLES = 1024
CAMPAIGN = made.quiet_campaign(samples=SAMPLES)
BENCH = make_bench(CAMPAIGN)
FORCE_NOISE = 0.1
DELAY = ("delay", "channel:a1", [20e-6])


def excitation_of(force: FloatArray) -> Excitation:
    """Return hits on the second body, prepared."""
    records = len(force)
    still = HitConditions(np.ones(records), np.zeros(records))
    return prepare_excitation(force, np.ones(records, dtype=int), made.RATE, still)


def response_to(
    force: FloatArray, effect: tuple[str, str, list[float]], oversampling: int = 4
) -> FloatArray:
    """Return the response to hits on the second body with an effect."""
    actions = BENCH.actions([made.term_of(BENCH, *effect)])
    theta = BENCH.theta(np.zeros(6))
    return respond(
        CAMPAIGN.model,
        theta,
        excitation_of(force),
        actions,
        oversampling=oversampling,
    )


def ring_of(monkeypatch: pytest.MonkeyPatch, *, faded: float) -> float:
    """Return the ringing of hit noise in the last quarter of a delayed record.

    The reference is a transform of six lengths, whose damping amplifies no noise.
    """
    rng = np.random.default_rng(3)
    force = CAMPAIGN.force[2:3].copy()
    force[:, 80:200] += FORCE_NOISE * rng.standard_normal(120)
    with monkeypatch.context() as patched:
        patched.setattr(forward, "FADED", faded)
        short = response_to(force, DELAY)
        patched.setattr(forward, "PADDED", 6.0)
        patched.setattr(forward, "DAMPING_EXPONENT", 24.0)
        error = np.abs(short - response_to(force, DELAY))
    return float(error[..., 3 * SAMPLES // 4 : -64].max())


def test_noise_at_the_end_of_the_band_does_not_ring(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Less than a tenth of the ringing without the taper, in a short record."""
    direct = FORCE_NOISE / made.NOMINAL["m2"]
    plain = ring_of(monkeypatch, faded=1e-9)
    faded = ring_of(monkeypatch, faded=forward.FADED)
    assert plain > 0.1 * direct
    assert 0.0 < faded < 0.1 * plain


@pytest.mark.parametrize(
    "effect",
    [
        ("gap", "link:joint", [2e7, 2e-6]),
        ("jenkins", "link:joint", [2e7, 1e-6, 14.0]),
        ("coulomb", "link:joint", [5.0, 1e-4]),
    ],
)
def test_the_response_of_a_record_does_not_depend_on_other_records(
    effect: tuple[str, str, list[float]],
) -> None:
    """Eleven records fill eight lanes once, and a part of them again."""
    level = np.linspace(0.2, 1.0, 11)
    force = level[:, None] * CAMPAIGN.force[2]
    together = response_to(force, effect)
    for k in (0, 7, 8, 10):
        alone = response_to(force[k : k + 1], effect)[0]
        assert np.abs(together[k] - alone).max() < 1e-9 * np.abs(alone).max()
