# SPDX-License-Identifier: MIT
"""Motion of lumped bodies by an adaptive integrator, all records at once.

Source:
    Hairer, Norsett and Wanner 1993, Solving Ordinary Differential Equations I, II.5
    (DOP853, as `scipy.integrate.solve_ivp` has it).
"""

from dataclasses import dataclass

import numpy as np
import scipy.fft
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.response.excitation import Excitation
from jointbench.analysis.gap.response.predict_records import undamped
from jointbench.analysis.gap.second_method.second_method_settings import (
    SECOND_METHOD,
)
from jointbench.analysis.gap.second_method.system import System


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Motion between the samples.

    Attributes:
        derivatives: displacement [m], velocity [m/s] and acceleration [m/s^2], shape
            (3, n_records, n_bodies, n_fine), `force_points` points per sample or more.
        evaluations: of the equations of motion.
    """

    derivatives: FloatArray
    evaluations: int


def force_between_samples(
    excitation: Excitation, beyond: int, points: int = SECOND_METHOD.force_points
) -> CubicSpline:
    """Return the band-limited force, a spline through its up-sampled points.

    Args:
        excitation: holds the forces, zero outside their hits.
        beyond: samples of silence after the record.
        points: per sample.

    Returns:
        Function of time [s] with values of shape (..., n_records).
    """
    n = excitation.growth.size
    samples = undamped(excitation.spectrum, excitation)
    spectrum = scipy.fft.rfft(samples, 2 * n, axis=1)
    fine = scipy.fft.irfft(spectrum, 2 * n * points, axis=1) * points
    count = (n + beyond) * points + 1
    time = np.arange(count) / (excitation.sample_rate * points)
    return CubicSpline(time, fine[:, :count].T)


def integrate_motion(
    system: System,
    excitation: Excitation,
    *,
    beyond: int = 0,
    tolerance: float,
    points: int = SECOND_METHOD.force_points,
) -> Motion:
    """Integrate all records from rest.

    Args:
        system: equations of motion.
        excitation: forces.
        beyond: samples to continue after the record.
        tolerance: local error over the size of the state [-].
        points: per sample, at least `force_points`; more where a force jumps.

    Raises:
        BadData: the integrator gave up, as it does where a law runs away.
    """
    records, width, n = len(system.mass), system.width, system.mass.shape[1]
    push = force_between_samples(excitation, beyond, points)
    count = (excitation.growth.size + beyond) * points
    time = np.arange(count) / (excitation.sample_rate * points)

    def rate(t: float, y: FloatArray) -> FloatArray:
        return system.rates(push(t), y.reshape(records, width)).ravel()

    # A law that runs away overflows before the integrator reports a failure.
    with np.errstate(over="ignore", invalid="ignore"):
        run = solve_ivp(
            rate,
            (0.0, time[-1]),
            np.zeros(records * width),
            t_eval=time,
            method="DOP853",
            rtol=tolerance,
            atol=tolerance * _sizes(system, push, time).ravel(),
            max_step=1.0 / excitation.sample_rate,
        )
    if not run.success or run.y.shape[1] != count:
        raise BadData(
            f"the second integrator stopped at {run.t[-1] if run.t.size else 0.0:g} s "
            f"of {time[-1]:g} s ({run.message}); check the effect's parameters"
        )
    state = run.y.T.reshape(count, records, width)
    rates = system.rates(push(time), state)
    parts = (state[..., :n], rates[..., :n], rates[..., n : 2 * n])
    return Motion(np.stack([p.transpose(1, 2, 0) for p in parts]), int(run.nfev))


def _sizes(system: System, push: CubicSpline, time: FloatArray) -> FloatArray:
    """Return how large each state gets, by order, shape (n_records, width)."""
    n = system.mass.shape[1]
    impulse = np.abs(push(time)).sum(axis=0) * (time[1] - time[0])
    speed = impulse * system.input.max(axis=1) + 1e-300
    fastest = np.sqrt(np.trace(system.stiffness, axis1=1, axis2=2))
    sizes = np.ones((len(system.mass), system.width))
    sizes[:, :n] = (speed / fastest)[:, None]
    sizes[:, n : 2 * n] = speed[:, None]
    return sizes
