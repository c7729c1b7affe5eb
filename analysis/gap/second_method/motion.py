# SPDX-License-Identifier: MIT
"""Motion of lumped bodies by an adaptive integrator, all records at once.

Source:
    Hairer, Norsett and Wanner 1993, Solving Ordinary Differential Equations I, II.5
    (DOP853); Petzold 1983, SIAM J. Sci. Stat. Comput. 4, 136 (LSODA); both as
    `scipy.integrate.solve_ivp` has them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

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
    pushed = _evaluated(push)
    count = (excitation.growth.size + beyond) * points
    time = np.arange(count) / (excitation.sample_rate * points)

    def rate(t: float, y: FloatArray) -> FloatArray:
        return system.rates(pushed(t), y.reshape(records, width)).ravel()

    sizes = _sizes(system, push, time).ravel()
    end, sample = _end_of_hits(push, time), 1.0 / excitation.sample_rate
    free = SECOND_METHOD.free_steps if records == 1 else 1.0
    method = _Method(records == 1, tolerance, sizes)
    hit = method.run(rate, np.zeros(records * width), time[: end + 1], sample)
    rest = method.run(rate, hit.y[:, -1], time[end:], free * sample)
    state = np.concatenate([hit.y[:, :-1], rest.y], axis=1).T
    state = state.reshape(count, records, width)
    rates = system.rates(push(time), state)
    parts = (state[..., :n], rates[..., :n], rates[..., n : 2 * n])
    return Motion(
        np.stack([p.transpose(1, 2, 0) for p in parts]), int(hit.nfev + rest.nfev)
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Method:
    """An adaptive integrator with its tolerance.

    A multistep method needs half the evaluations of a law with reversals; with many
    records, the reversals of each one would limit its order and step.

    Attributes:
        multistep: True for one record.
        tolerance: local error over the size of the state [-].
        sizes: of the states, shape (n,).
    """

    multistep: bool
    tolerance: float
    sizes: FloatArray

    def run(
        self,
        rate: Callable[[float, FloatArray], FloatArray],
        start: FloatArray,
        time: FloatArray,
        longest: float,
    ) -> Any:
        """Integrate.

        Args:
            rate: of the state.
            start: state at the first time, shape (n,).
            time: at which states are wanted [s], shape (n_times,).
            longest: step [s].

        Returns:
            What `solve_ivp` returns.

        Raises:
            BadData: the integrator gave up.
        """
        # A law that runs away overflows before the integrator reports a failure.
        with np.errstate(over="ignore", invalid="ignore"):
            run = solve_ivp(
                rate,
                (time[0], time[-1]),
                start,
                t_eval=time,
                method="LSODA" if self.multistep else "DOP853",
                rtol=self.tolerance,
                atol=self.tolerance * self.sizes,
                max_step=longest,
            )
        if not run.success or run.y.shape[1] != time.size:
            at = float(run.t[-1]) if run.t.size else 0.0
            raise BadData(
                f"the second integrator stopped at {at:g} s of {time[-1]:g} s "
                f"({run.message}); check the effect's parameters"
            )
        return run


def _evaluated(spline: CubicSpline) -> Callable[[float], FloatArray]:
    """Return a spline of evenly spaced points as a function of one time.

    The spline itself checks its arguments, which takes longer than the sum.
    """
    start, step = float(spline.x[0]), float(spline.x[1] - spline.x[0])
    pieces = np.ascontiguousarray(np.moveaxis(spline.c, 1, 0))
    last = len(pieces) - 1
    # Plain numbers: with one record an array of one takes ten times as long.
    rows = pieces[:, :, 0].tolist() if pieces.shape[2] == 1 else pieces

    def value(t: float) -> FloatArray:
        at = min(max(int((t - start) / step), 0), last)
        a, b, c, d = rows[at]
        away = t - start - at * step
        return np.atleast_1d(((a * away + b) * away + c) * away + d)

    return value


def _end_of_hits(push: CubicSpline, time: FloatArray) -> int:
    """Return the index of the time from which no force acts any more.

    While a force acts, a step may not pass over it; later the tolerance limits it.
    """
    force = np.abs(push(time)).max(axis=1)
    acting = np.flatnonzero(force > SECOND_METHOD.least_force * force.max())
    return int(np.clip(acting[-1] + 1 if acting.size else 1, 1, time.size - 2))


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
