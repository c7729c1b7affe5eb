# SPDX-License-Identifier: MIT
"""A bank of oscillators that predicts a response at missing samples.

Each oscillator has the frequency and damping of a mode and is driven by white noise. As
a filter it would bias damping (a third of it at low signal to noise), so it is used
only to predict the samples lost in a drop-out. All good samples stay as recorded.

Source:
    Harvey, Forecasting, Structural Time Series Models and the Kalman Filter (1989),
    sec. 2.3.4 and 3.4.7 (missing observations); Rauch, Tung and Striebel (1965).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.recordings import Recording, response_rows
from jointbench.acquisition.records.stored_samples import remembered
from jointbench.signal.kalman.process_models import StateModel
from jointbench.signal.kalman.still_samples import (
    MOVING,
    StillSamples,
    runs_of,
    stands_still,
)

# Largest share of lost samples that can be filled in.
_MOST_LOST = 0.3
_LEAST_NOISE = 1e-9
# Pieces of the spectrum searched for noise, and how many hold only noise.
_PIECES, _QUIET = 400, 0.1
# Half-power half-widths either side of a resonance used for its strength.
_HALF_WIDTHS = 3.0
# A gap is filled from this many decays of the slowest oscillator on either side.
_DECAYS = 2.0
_MOST_AROUND = 4000


def bank_model(
    samples: FloatArray,
    frequency: FloatArray,
    damping_ratio: FloatArray,
    sample_rate: float,
) -> tuple[StateModel, float]:
    """Fit the strength of each oscillator to the spectrum of a response.

    Args:
        samples: shape (n_samples,).
        frequency: of the oscillators [Hz], shape (n,).
        damping_ratio: [-], shape (n,).
        sample_rate: [Hz].

    Returns:
        The bank in units of the measurement noise, and that noise's variance [sample
        unit squared].
    """
    turn = 2.0 * np.pi * frequency / sample_rate
    decay = np.exp(-damping_ratio * turn)
    size = 2 * frequency.size
    transition = np.zeros((size, size))
    for i, (angle, left) in enumerate(zip(turn, decay, strict=True)):
        cosine, sine = left * np.cos(angle), left * np.sin(angle)
        transition[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [
            [cosine, sine],
            [-sine, cosine],
        ]
    power, noise = _strengths(samples, turn, decay)
    push = np.repeat(power / noise, 2)
    start = np.diag(push / (1.0 - np.repeat(decay, 2) ** 2))
    observation = np.tile([1.0, 0.0], frequency.size)
    return StateModel(transition, np.diag(push), observation, start), noise


def find_dropouts(recording: Recording) -> BoolArray:
    """Find where a channel is constant although it varies elsewhere.

    Args:
        recording: any channels; a force at rest at zero does not count as varying.

    Returns:
        True for lost samples, shape (n_channels, n_samples).
    """
    lost = np.zeros(recording.samples.shape, bool)
    for row in response_rows(recording):
        for begin, past in _lost_spans(recording.samples[row]):
            lost[row, begin:past] = True
    return lost


@remembered
def has_dropouts(recording: Recording) -> bool:
    """Return whether `find_dropouts` finds a lost sample, read block by block."""
    return any(stands_still(recording.samples, r) for r in response_rows(recording))


def _lost_spans(samples: FloatArray) -> list[tuple[int, int]]:
    """Return first and one past the last of each run of lost samples of a channel."""
    still = samples[1:] == samples[:-1]
    if not still.any() or np.mean(~still) < MOVING:
        return []
    runs = runs_of(still)
    counted = StillSamples(still.size)
    counted.feed(still)
    least = counted.least()
    # The first of equal samples may be the last good one; zero is not.
    return [
        (int(first) + int(samples[first] != 0.0), int(last) + 1)
        for first, last in runs
        if last - first >= least
    ]


def repair_dropouts(
    recording: Recording,
    frequency: Sequence[float] | FloatArray,
    damping_ratio: Sequence[float] | FloatArray,
    *,
    lost: BoolArray | None = None,
) -> Recording:
    """Fill lost samples with the prediction of a bank of oscillators.

    Args:
        recording: any; forces are not changed.
        frequency: of the modes in the responses [Hz], shape (n,).
        damping_ratio: of the modes [-], shape (n,).
        lost: True for lost samples, shape (n_channels, n_samples); None to find them.

    Returns:
        The recording with the same good samples, and a step that records how many were
        filled in each channel.

    Raises:
        BadData: a channel has lost more than 30 % of its samples.
        UsageError: frequencies not between 0 and half the sample rate.
    """
    own, ratio = (
        np.asarray(frequency, np.float64),
        np.asarray(damping_ratio, np.float64),
    )
    _require_inside(own, ratio, recording.sample_rate)
    if lost is None and not has_dropouts(recording):
        return recording
    missing = find_dropouts(recording) if lost is None else lost
    samples, filled = recording.samples.copy(), {}
    for row in response_rows(recording):
        count = int(np.count_nonzero(missing[row]))
        if count == 0:
            continue
        name = recording.channels[row].name
        if count > _MOST_LOST * samples.shape[1]:
            raise BadData(
                f"recording {recording.name!r}: channel {name!r} has lost {count} of "
                f"{samples.shape[1]} samples; measure again"
            )
        guess = track(samples[row], missing[row], own, ratio, recording.sample_rate)
        samples[row, missing[row]] = guess[missing[row]]
        filled[f"filled_{name}"] = count
    if not filled:
        return recording
    done = step("repair_dropouts", oscillators=own.size, **filled)
    return replace(recording, samples=samples, provenance=(*recording.provenance, done))


def track(
    samples: FloatArray,
    lost: BoolArray,
    frequency: FloatArray,
    damping_ratio: FloatArray,
    sample_rate: float,
) -> FloatArray:
    """Return a response with the bank's estimate at lost samples.

    Args:
        samples: shape (n_samples,); values at lost samples are ignored.
        lost: shape (n_samples,).
        frequency: of the oscillators [Hz], shape (n,).
        damping_ratio: of the oscillators [-], shape (n,).
        sample_rate: [Hz].

    Returns:
        Smoothed response around the lost samples, as recorded elsewhere, shape
        (n_samples,).
    """
    known = np.where(lost, 0.0, samples)
    model, _ = bank_model(known, frequency, damping_ratio, sample_rate)
    # Samples further off than a few decays do not affect a gap.
    slowest = float(np.min(damping_ratio * frequency)) * 2.0 * np.pi / sample_rate
    around = int(min(_MOST_AROUND, np.ceil(_DECAYS / max(slowest, 1e-12))))
    result = samples.copy()
    for first, last in _stretches(lost, around):
        states = smooth_with_gaps(model, known[first:last], lost[first:last])
        result[first:last] = states @ model.observation
    return result


def _stretches(lost: BoolArray, around: int) -> list[tuple[int, int]]:
    """Return stretches of samples around the gaps, joined where they overlap."""
    joined: list[tuple[int, int]] = []
    for i in np.flatnonzero(lost):
        first, last = max(0, int(i) - around), min(lost.size, int(i) + around + 1)
        if joined and first <= joined[-1][1]:
            joined[-1] = (joined[-1][0], last)
        else:
            joined.append((first, last))
    return joined


def smooth_with_gaps(
    model: StateModel, samples: FloatArray, lost: BoolArray
) -> FloatArray:
    """Run filter and smoother over samples of which some are lost.

    Args:
        model: measurement noise 1.
        samples: shape (n_samples,).
        lost: samples to predict only, shape (n_samples,).

    Returns:
        Smoothed states, shape (n_samples, n).
    """
    transition, observation = model.transition, model.observation
    n_samples, n = samples.size, observation.size
    states, spread = np.zeros((n_samples, n)), np.zeros((n_samples, n, n))
    ahead = np.zeros((n_samples, n, n))
    state, covariance, eye = np.zeros(n), model.start, np.eye(n)
    for i in range(n_samples):
        state = transition @ state
        covariance = transition @ covariance @ transition.T + model.process
        ahead[i] = covariance
        if not lost[i]:
            crossed = covariance @ observation
            gain = crossed / (observation @ crossed + 1.0)
            state = state + gain * (samples[i] - observation @ state)
            kept = eye - np.outer(gain, observation)
            covariance = kept @ covariance @ kept.T + np.outer(gain, gain)
        states[i], spread[i] = state, covariance
    back = np.linalg.solve(ahead[1:], transition @ spread[:-1]).transpose(0, 2, 1)
    for i in range(n_samples - 2, -1, -1):
        states[i] += back[i] @ (states[i + 1] - transition @ states[i])
    return states


def _require_inside(
    frequency: FloatArray, damping_ratio: FloatArray, sample_rate: float
) -> None:
    inside = (frequency > 0.0) & (frequency < 0.5 * sample_rate)
    if (
        frequency.size == 0
        or damping_ratio.shape != frequency.shape
        or not inside.all()
    ):
        raise UsageError(
            f"{frequency.size} frequencies and {damping_ratio.size} damping ratios for "
            f"the oscillators; give as many of each, 0 to {0.5 * sample_rate:g} Hz"
        )


def _strengths(
    samples: FloatArray, turn: FloatArray, decay: FloatArray
) -> tuple[FloatArray, float]:
    """Fit the excitation of each oscillator, and white noise, to the periodogram.

    Only lines near a resonance are used for its excitation: the skirts of an impact
        response differ from those under random excitation, and would be taken for noise
        or for a neighbour. The noise is that of the quietest tenth of the band.
    """
    spectrum = np.abs(scipy.fft.rfft(samples)) ** 2 / samples.size
    angle = 2.0 * np.pi * np.arange(spectrum.size) / samples.size
    pieces = np.array_split(spectrum[1:], min(_PIECES, spectrum.size - 1))
    total = float(np.mean(samples**2)) + np.finfo(float).tiny
    quiet = float(np.quantile([piece.mean() for piece in pieces], _QUIET))
    noise = max(quiet, _LEAST_NOISE * total)
    reach = np.maximum(_HALF_WIDTHS * -np.log(decay), 2.0 * angle[1])
    level, design = np.empty(turn.size), np.empty((turn.size, turn.size))
    for i, (own, width) in enumerate(zip(turn, reach, strict=True)):
        around = np.abs(angle - own) <= width
        z = np.exp(1j * angle[around])
        level[i] = spectrum[around].mean()
        for j, root in enumerate(decay * np.exp(1j * turn)):
            both = np.abs(z - root) ** -2 + np.abs(z - root.conjugate()) ** -2
            design[i, j] = 0.5 * both.mean()
    level = np.maximum(level, np.finfo(float).tiny)
    from scipy.optimize import nnls  # slow to import; only this model needs it

    found = nnls(design / level[:, None], np.ones(turn.size))[0]
    return np.maximum(found, _LEAST_NOISE * noise), noise
