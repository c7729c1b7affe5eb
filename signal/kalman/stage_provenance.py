# SPDX-License-Identifier: MIT
"""Gain and noise of the Kalman stage, read from a provenance without running it."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.provenance import Provenance
from jointbench.signal.kalman.process_models import (
    KalmanModel,
    KalmanSettings,
    StageGain,
    stage_gain,
)

KALMAN_STEP = "kalman_stage"
"""Name of the step of a provenance."""
NOISE_PREFIX = "noise_sd_"
"""Start of the keys of the estimated noise; the name of the channel follows."""


def stage_gain_of(provenance: Provenance, frequency: FloatArray) -> StageGain | None:
    """Return the gain of the Kalman stage in a provenance.

    Args:
        provenance: of an FRF or a recording.
        frequency: [Hz], shape (n,).

    Returns:
        The gain, or None if there was no such stage.
    """
    for done in provenance:
        if done.name == KALMAN_STEP:
            detail = dict(done.detail)
            settings = KalmanSettings(
                KalmanModel(str(detail["model"])),
                float(detail["cutoff"]),
                bool(detail["smooth"]),
                float(detail["frequency"]),
                float(detail["damping_ratio"]),
            )
            gain = stage_gain(settings, frequency, float(detail["sample_rate"]))
            return replace(gain, all_channels=bool(detail["all_channels"]))
    return None


def stage_noise_of(provenance: Provenance) -> dict[str, float]:
    """Return the noise that the Kalman stage estimated in each channel.

    Args:
        provenance: of an FRF or of recordings.

    Returns:
        Standard deviation by channel name [sample unit], rms over stages; empty
        without a stage.
    """
    seen: dict[str, list[float]] = {}
    for done in provenance:
        if done.name == KALMAN_STEP:
            for key, value in done.detail:
                if key.startswith(NOISE_PREFIX):
                    seen.setdefault(key.removeprefix(NOISE_PREFIX), []).append(
                        float(value)
                    )
    return {name: float(np.sqrt(np.mean(np.square(sds)))) for name, sds in seen.items()}
