# SPDX-License-Identifier: MIT
"""Process models of the Kalman stage, and the gain of filters built on them."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.kalman.steady_gains import gains

# Default cutoff of the smoother (gain one half), as a share of the sample rate.
_CUTOFF_SHARE = 0.25


class KalmanModel(StrEnum):
    """Process model of a signal."""

    LEVEL_SLOPE = "level_slope"
    OSCILLATOR = "oscillator"


@dataclass(frozen=True, slots=True)
class KalmanSettings:
    """The Kalman stage.

    Attributes:
        model: local linear trend, or one damped oscillator driven by noise.
        cutoff: where the smoother halves a signal [Hz]; None for a quarter of the
            sample rate. For the oscillator: where its skirt has a gain of one half,
                above `frequency`.
        smooth: fixed-interval smoother (zero phase) or, if False, the causal filter.
        frequency: of the oscillator [Hz].
        damping_ratio: of the oscillator [-].
    """

    model: KalmanModel = KalmanModel.LEVEL_SLOPE
    cutoff: float | None = None
    smooth: bool = True
    frequency: float = 0.0
    damping_ratio: float = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class StateModel:
    """A linear model in units of samples, measurement noise 1.

    Attributes:
        transition: state from one sample to the next, shape (n, n).
        process: covariance of the process noise, shape (n, n).
        observation: the sample as a combination of the state, shape (n,).
        start: covariance of the first state, shape (n, n).
    """

    transition: FloatArray
    process: FloatArray
    observation: FloatArray
    start: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "transition", "process", "observation", "start")


@dataclass(frozen=True, slots=True, eq=False)
class StageGain:
    """Gain of the stage for a stationary signal.

    Attributes:
        frequency: [Hz], shape (n,).
        gain: amplitude [-], shape (n,).
        phase: [rad], shape (n,); 0 for the smoother.
        settings: the stage.
        all_channels: True if force and response were filtered alike, so that it cancels
            in the FRF; False if the FRF must be divided by it.
    """

    frequency: FloatArray
    gain: FloatArray
    phase: FloatArray
    settings: KalmanSettings
    all_channels: bool = True

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "gain", "phase")


def state_model(settings: KalmanSettings, sample_rate: float) -> StateModel:
    """Return the state model of the settings.

    Args:
        settings: the stage.
        sample_rate: [Hz].

    Returns:
        Level and slope a sample (white acceleration, constant within a sample), or the
        two phases of a decaying oscillator; process noise set by the cutoff.

    Raises:
        UsageError: a cutoff or frequency outside 0 to half the sample rate.
    """
    cutoff = stage_cutoff(settings, sample_rate)
    if settings.model is KalmanModel.LEVEL_SLOPE:
        transition = np.array([[1.0, 1.0], [0.0, 1.0]])
        shape = np.array([[0.25, 0.5], [0.5, 1.0]])
    else:
        turn = 2.0 * np.pi * settings.frequency / sample_rate
        decay = np.exp(-settings.damping_ratio * turn)
        cosine, sine = decay * np.cos(turn), decay * np.sin(turn)
        transition = np.array([[cosine, sine], [-sine, cosine]])
        shape = np.eye(2)
    observation = np.array([1.0, 0.0])
    unit = StateModel(transition, shape, observation, np.eye(2))
    process = shape / _signal_power(unit, np.array([cutoff / sample_rate]))[0]
    return StateModel(transition, process, observation, np.eye(2) + process)


def stage_gain(
    settings: KalmanSettings, frequency: FloatArray, sample_rate: float
) -> StageGain:
    """Return the gain of the stage away from the ends of a record.

    Args:
        settings: the stage.
        frequency: [Hz], shape (n,).
        sample_rate: [Hz].

    Returns:
        Amplitude and phase at each frequency. The smoother's is that of Wiener's
        filter, S / (S + 1), with S the power of the modelled signal over the noise.
    """
    model, turns = state_model(settings, sample_rate), frequency / sample_rate
    if settings.smooth:
        power = _signal_power(model, turns)
        return StageGain(frequency, power / (power + 1.0), 0.0 * power, settings)
    gain = gains(model.transition, model.process, model.observation, model.start)[0][-1]
    closed = model.transition - np.outer(gain, model.observation @ model.transition)
    delay = np.exp(2j * np.pi * turns)[:, None, None]
    state = np.linalg.solve(np.eye(2) - closed / delay, gain[None, :, None])
    response = state[:, :, 0] @ model.observation
    return StageGain(frequency, np.abs(response), np.angle(response), settings)


def stage_cutoff(settings: KalmanSettings, sample_rate: float) -> float:
    """Return the cutoff of the settings, default included [Hz].

    Raises:
        UsageError: a cutoff or frequency outside 0 to half the sample rate.
    """
    cutoff = settings.cutoff
    if cutoff is None:
        cutoff = _CUTOFF_SHARE * sample_rate
    for name, value in (("cutoff", cutoff), ("frequency", settings.frequency)):
        if not 0.0 <= value < 0.5 * sample_rate or (name == "cutoff" and value == 0.0):
            raise UsageError(
                f"Kalman {name} {value:g} Hz is outside 0 to {0.5 * sample_rate:g} "
                "Hz, half the sample rate; choose one inside"
            )
    return cutoff


def _signal_power(model: StateModel, turns: FloatArray) -> FloatArray:
    """Return the power of the modelled signal over white noise of variance 1.

    Args:
        model: its process noise drives the signal.
        turns: frequency over sample rate, shape (n,).
    """
    z = np.exp(2j * np.pi * np.where(turns == 0.0, 1e-9, turns))[:, None, None]
    transfer = np.linalg.solve(
        np.swapaxes(z * np.eye(2) - model.transition, 1, 2),
        np.broadcast_to(model.observation[:, None], (turns.size, 2, 1)),
    )[:, :, 0]
    power = np.einsum("fi,ij,fj->f", transfer, model.process, transfer.conj())
    return np.asarray(power.real)
