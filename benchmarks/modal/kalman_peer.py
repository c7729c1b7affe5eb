# SPDX-License-Identifier: MIT
"""A peer of `amplitude_peers.py`: extended Kalman smoother of one decay.

State ln a, phase, frequency beside the carrier and ln decay rate; the last two walk at
random, by steps whose size is the likeliest of a few.
"""

import numpy as np
import numpy.typing as npt
import scipy.signal
from numba import njit

Floats = npt.NDArray[np.float64]
# Standard deviation of ln decay rate gained over one time constant; frequency walks by
# the same share of the half-power half width.
_WALKS = (0.03, 0.1, 0.3, 1.0)
_SAMPLES_A_PERIOD = 10.0


def kalman_smoother(
    samples: Floats, rate: float, frequency: float, ratio: float
) -> tuple[Floats, Floats, Floats]:
    """Return amplitude, frequency [Hz] and damping ratio along a decay.

    Args:
        samples: of one mode, band-passed.
        rate: [Hz].
        frequency: of the mode [Hz], roughly.
        ratio: its damping ratio, roughly.
    """
    skip = max(1, int(rate / (_SAMPLES_A_PERIOD * frequency)))
    used = np.ascontiguousarray(samples[::skip])
    step = skip / rate
    omega = 2 * np.pi * frequency
    analytic = scipy.signal.hilbert(used)
    at = max(2, round(1.0 / (frequency * step)))
    start = np.array(
        [np.log(np.abs(analytic[at]) + 1e-300), np.angle(analytic[at]), 0.0]
    )
    start = np.append(start, np.log(ratio * omega))
    noise = float(np.var(used[-used.size // 8 :])) + 1e-6 * float(np.var(used))
    best = None
    for walk in _WALKS:
        own = walk * np.sqrt(ratio * omega * step)
        steps = np.array([0.0, 0.0, own * ratio * omega, own]) ** 2
        found = _smoothed(used[at:], step, omega, start, (noise, steps))
        if best is None or found[0] > best[0]:
            best = found
    assert best is not None
    state = best[1]
    turn = omega + state[:, 2]
    return np.exp(state[:, 0]), turn / 2 / np.pi, np.exp(state[:, 3]) / turn


@njit(cache=False)
def _smoothed(samples, step, omega, start, noises):  # type: ignore[no-untyped-def]
    noise, walk = noises
    n = samples.size
    ahead, ahead_cov = np.zeros((n, 4)), np.zeros((n, 4, 4))
    known, known_cov = np.zeros((n, 4)), np.zeros((n, 4, 4))
    moves = np.zeros((n, 4, 4))
    rate = np.exp(start[3])
    state = start.copy()
    cov = np.diag(np.array([0.1, 0.1, (0.5 * rate) ** 2, 0.25]))
    likelihood = 0.0
    for i in range(n):
        move = np.eye(4)
        if i > 0:
            fall = np.exp(state[3]) * step
            move[0, 3], move[1, 2] = -fall, step
            state = state.copy()
            state[0] -= fall
            state[1] += (omega + state[2]) * step
            cov = move @ cov @ move.T + np.diag(walk)
        ahead[i], ahead_cov[i], moves[i] = state, cov, move
        size = np.exp(state[0])
        slope = np.array([size * np.cos(state[1]), -size * np.sin(state[1]), 0.0, 0.0])
        rest = samples[i] - slope[0]
        spread = slope @ cov @ slope + noise
        gain = cov @ slope / spread
        state = state + gain * rest
        left = np.eye(4) - np.outer(gain, slope)
        cov = left @ cov @ left.T + noise * np.outer(gain, gain)
        likelihood -= 0.5 * (np.log(spread) + rest**2 / spread)
        # A filter that diverged is no peer.
        if not (np.isfinite(cov).all() and np.isfinite(state).all() and spread > 0.0):
            return -np.inf, known[:0]
        known[i], known_cov[i] = state, cov
    for i in range(n - 2, -1, -1):
        back = known_cov[i] @ moves[i + 1].T @ np.linalg.inv(ahead_cov[i + 1])
        known[i] += back @ (known[i + 1] - ahead[i + 1])
    return likelihood, known
