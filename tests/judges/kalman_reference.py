# SPDX-License-Identifier: MIT
"""The Kalman models run by filterpy sample by sample: the reference for `kalman`.

The product takes its gains from filterpy and applies them in loops of its own; here
filterpy does all of it, missing samples and the smoother included.
"""

import numpy as np
from filterpy.common import Q_discrete_white_noise
from filterpy.kalman import KalmanFilter

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.signal.kalman.process_models import StateModel


def reference_process_noise() -> FloatArray:
    """Return filterpy's process noise for level and slope, one sample, variance 1."""
    return np.asarray(Q_discrete_white_noise(dim=2, dt=1.0, var=1.0), np.float64)


def reference_states(
    model: StateModel,
    samples: FloatArray,
    *,
    at_rest: bool = False,
    lost: BoolArray | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Filter and smooth one channel sample by sample in filterpy.

    Args:
        model: from `process_models.state_model`.
        samples: shape (n_samples,).
        at_rest: start from a state of zero instead of the first sample.
        lost: True for samples to predict only, shape (n_samples,); None for none.

    Returns:
        Filtered and smoothed states, each of shape (n_samples, n).
    """
    size = model.observation.size
    kalman = KalmanFilter(dim_x=size, dim_z=1)
    kalman.F = model.transition.copy()
    kalman.H = model.observation[None, :].copy()
    kalman.Q = model.process.copy()
    kalman.R = np.eye(1)
    kalman.P = model.start.copy()
    first = 0.0 if at_rest else samples[0]
    kalman.x = (first * model.observation)[:, None]
    gaps = np.zeros(samples.size, bool) if lost is None else lost
    states, covariances = [], []
    for sample, gap in zip(samples, gaps, strict=True):
        kalman.predict()
        kalman.update(None if gap else np.array([[sample]]))
        states.append(kalman.x.copy())
        covariances.append(kalman.P.copy())
    smoothed, *_ = kalman.rts_smoother(np.array(states), np.array(covariances))
    shape = (samples.size, size)
    return np.array(states).reshape(shape), np.asarray(smoothed).reshape(shape)
