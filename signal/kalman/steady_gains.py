# SPDX-License-Identifier: MIT
"""Gains of the Kalman stage, from filterpy's filter run until they converge.

The gains of a linear filter depend on its model, not on the samples. filterpy's filter
is stepped without samples once for each configuration; its gains and covariances are
kept, and the compiled loops of `recursion` apply them to every sample and channel.

filterpy keeps its state in public attributes of changing shape; here all inputs and
outputs are arrays of fixed shape. This is the only file that imports filterpy, and only
when gains are first needed, because the import takes about a second.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

# Relative change below which gains have converged.
_STILL = 1e-15
# Rounding may change the last digit for long; all else has converged by then.
_MOST = 50_000
# Configurations whose gains are kept; a session uses one or two.
_KEPT = 16


def gains(
    transition: FloatArray,
    process: FloatArray,
    observation: FloatArray,
    start: FloatArray,
    most: int = _MOST,
) -> tuple[FloatArray, FloatArray]:
    """Return filter and smoother gains until they converge.

    Args:
        transition: shape (n, n).
        process: covariance of the process noise, shape (n, n).
        observation: shape (n,); the measurement noise is 1.
        start: covariance before the first prediction, shape (n, n).
        most: samples after which to stop in any case.

    Returns:
        Filter gains, shape (m, n), and smoother gains, shape (m, n, n), m <= `most`,
        read-only; the last of each holds for all further samples.
    """
    # Records of about the same length share one run: its length is a power of two.
    reach = min(1 << max(most - 1, 0).bit_length(), _MOST)
    parts = (transition, process, observation, start)
    key = (np.asarray(part, np.float64).tobytes() for part in parts)
    filters, smoothers = _run(observation.size, reach, *key)
    return filters[:most], smoothers[:most]


@lru_cache(maxsize=_KEPT)
def _run(size: int, reach: int, *parts: bytes) -> tuple[FloatArray, FloatArray]:
    """Step filterpy's filter at most `reach` times; the key is the model's bytes."""
    kalman = _filter(size, *(np.frombuffer(part).reshape(-1, size) for part in parts))
    filters: list[FloatArray] = []
    smoothers: list[FloatArray] = []
    # A covariance that recurs bit for bit: rounding has entered a cycle.
    seen: set[bytes] = set()
    kalman.predict()
    for _ in range(reach):
        kalman.update(0.0)
        filters.append(kalman.K[:, 0].copy())
        covariance = kalman.P
        kalman.predict()
        # The gain of Rauch, Tung and Striebel, P F' / P(next); a solution of the
        # equations keeps digits that filterpy's inverse loses for slow trends.
        ahead = np.linalg.solve(kalman.P, kalman.F @ covariance).T
        smoothers.append(np.asarray(ahead, np.float64))
        settled = len(filters) > 1 and _still(filters) and _still(smoothers)
        if settled or kalman.P.tobytes() in seen:
            break
        seen.add(kalman.P.tobytes())
    found = np.array(filters), np.array(smoothers)
    for array in found:
        array.flags.writeable = False
    return found


def _filter(
    size: int,
    transition: FloatArray,
    process: FloatArray,
    observation: FloatArray,
    start: FloatArray,
) -> Any:
    """Return filterpy's filter of a model, before its first prediction."""
    from filterpy.kalman import KalmanFilter

    kalman = KalmanFilter(dim_x=size, dim_z=1)
    kalman.F, kalman.Q, kalman.H, kalman.P = transition, process, observation, start
    kalman.R = np.eye(1)
    return kalman


def _still(steps: list[FloatArray]) -> bool:
    moved = float(np.abs(steps[-1] - steps[-2]).max())
    return moved <= _STILL * float(np.abs(steps[-1]).max())
