# SPDX-License-Identifier: MIT
"""Compiled loops of the Kalman stage, sample by sample.

A Kalman filter processes one sample at a time: about 90 us in Python, below 0.1 us
    compiled. The gains come from `steady_gains`.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.compiled import compiled


@compiled()
def _forward_two(
    transition: FloatArray,
    observation: FloatArray,
    gain: FloatArray,
    start: FloatArray,
    samples: FloatArray,
    states: FloatArray,
    innovations: FloatArray,
) -> None:
    """Do the same for one channel of two states, which stay in registers."""
    first, second = start[0], start[1]
    t00, t01, t10, t11 = (
        transition[0, 0],
        transition[0, 1],
        transition[1, 0],
        transition[1, 1],
    )
    last = gain.shape[0] - 1
    for i in range(samples.size):
        one, other = t00 * first + t01 * second, t10 * first + t11 * second
        innovation = samples[i] - observation[0] * one - observation[1] * other
        row = min(i, last)
        first, second = (
            one + gain[row, 0] * innovation,
            other + gain[row, 1] * innovation,
        )
        states[i, 0], states[i, 1], innovations[i] = first, second, innovation


@compiled()
def forward(
    transition: FloatArray,
    observation: FloatArray,
    gain: FloatArray,
    start: FloatArray,
    samples: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Predict and update through all samples of all channels.

    Args:
        transition: shape (n, n).
        observation: shape (n,).
        gain: filter gains, shape (m, n).
        start: first state of each channel, shape (n_channels, n).
        samples: shape (n_channels, n_samples).

    Returns:
        States, shape (n_channels, n_samples, n), and innovations, shape
        (n_channels, n_samples).
    """
    n_channels, n_samples = samples.shape
    n, last = observation.size, gain.shape[0] - 1
    states = np.empty((n_channels, n_samples, n))
    innovations = np.empty((n_channels, n_samples))
    for c in range(n_channels):
        if n == 2:
            _forward_two(
                transition,
                observation,
                gain,
                start[c],
                samples[c],
                states[c],
                innovations[c],
            )
            continue
        before = start[c]
        for i in range(n_samples):
            state, innovation = states[c, i], samples[c, i]
            for a in range(n):
                state[a] = 0.0
                for b in range(n):
                    state[a] += transition[a, b] * before[b]
                innovation -= observation[a] * state[a]
            for a in range(n):
                state[a] += gain[min(i, last), a] * innovation
            innovations[c, i] = innovation
            before = state
    return states, innovations


@compiled()
def _backward_two(
    transition: FloatArray,
    smoother: FloatArray,
    states: FloatArray,
    smoothed: FloatArray,
) -> None:
    """Do the same for one channel of two states, which stay in registers."""
    t00, t01, t10, t11 = (
        transition[0, 0],
        transition[0, 1],
        transition[1, 0],
        transition[1, 1],
    )
    last, end = smoother.shape[0] - 1, states.shape[0] - 1
    first, second = smoothed[end, 0], smoothed[end, 1]
    for i in range(end - 1, -1, -1):
        one, other, row = states[i, 0], states[i, 1], min(i, last)
        first -= t00 * one + t01 * other
        second -= t10 * one + t11 * other
        first, second = (
            one + smoother[row, 0, 0] * first + smoother[row, 0, 1] * second,
            other + smoother[row, 1, 0] * first + smoother[row, 1, 1] * second,
        )
        smoothed[i, 0], smoothed[i, 1] = first, second


@compiled()
def backward(
    transition: FloatArray, smoother: FloatArray, states: FloatArray
) -> FloatArray:
    """Smooth filtered states from the last sample to the first.

    Args:
        transition: shape (n, n).
        smoother: smoother gains, shape (m, n, n).
        states: filtered states, shape (n_channels, n_samples, n).

    Returns:
        Smoothed states, same shape.
    """
    n_channels, n_samples, n = states.shape
    smoothed, last, ahead = states.copy(), smoother.shape[0] - 1, np.empty(n)
    for c in range(n_channels):
        if n == 2:
            _backward_two(transition, smoother, states[c], smoothed[c])
            continue
        for i in range(n_samples - 2, -1, -1):
            for a in range(n):
                ahead[a] = smoothed[c, i + 1, a]
                for b in range(n):
                    ahead[a] -= transition[a, b] * states[c, i, b]
            for a in range(n):
                for b in range(n):
                    smoothed[c, i, a] += smoother[min(i, last), a, b] * ahead[b]
    return smoothed
