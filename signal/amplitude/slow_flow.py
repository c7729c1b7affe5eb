# SPDX-License-Identifier: MIT
"""Decays of one mode whose frequency and damping depend on its amplitude.

With L = ln a: dL/dt = -zeta(L) omega(L) and dtheta/dt = omega(L). Time and phase are
integrals over L, the same for all hits: a hit is a place to start on one master decay.
Here ln omega and ln zeta are sums of basis functions; the derivatives of the signal
with respect to their coefficients are integrals of the same kind.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.signal.amplitude.curve_basis import CurveBasis


@dataclass(frozen=True, slots=True, eq=False)
class MasterDecay:
    """One mode's decay from the top of the grid down, tabulated over L.

    Attributes:
        grid: of L, shape (n,).
        omega: [rad/s], shape (n,).
        zeta: decay rate over omega [-], shape (n,).
        slope: d ln omega / dL [-], shape (n,).
        tau: time from the top [s], shape (n,).
        phase: beyond that of the centre frequency, from the top [rad], shape (n,).
        values: basis functions, shape (n, n_functions).
        inner_time: integrals of B / (zeta omega) from the top [s], same shape.
        inner_phase: integrals of B / zeta from the top [-], same shape.
        centre: frequency at which exp(L) is the amplitude of the response [rad/s].
        power: derivatives of the response (2 for acceleration).
    """

    grid: FloatArray
    omega: FloatArray
    zeta: FloatArray
    slope: FloatArray
    tau: FloatArray
    phase: FloatArray
    values: FloatArray
    inner_time: FloatArray
    inner_phase: FloatArray
    centre: float
    power: int


def master_decay(
    basis: CurveBasis,
    log_omega: FloatArray,
    log_zeta: FloatArray,
    centre: float,
    power: int,
) -> MasterDecay:
    """Tabulate the decay of a mode.

    Args:
        basis: functions of L.
        log_omega: coefficients of ln(omega / centre), shape (n_functions,).
        log_zeta: coefficients of ln zeta, shape (n_functions,).
        centre: frequency whose phase is left out [rad/s].
        power: derivatives of the response.
    """
    relative = basis.values @ log_omega
    omega = centre * np.exp(relative)
    zeta = np.exp(basis.values @ log_zeta)
    step = float(basis.grid[1] - basis.grid[0])
    rate = 1.0 / (zeta * omega)
    return MasterDecay(
        grid=basis.grid,
        omega=omega,
        zeta=zeta,
        slope=np.gradient(relative, step),
        tau=_from_top(rate, step),
        phase=_from_top(rate * (omega - centre), step),
        values=basis.values,
        inner_time=_from_top(basis.values * rate[:, None], step),
        inner_phase=_from_top(basis.values / zeta[:, None], step),
        centre=centre,
        power=power,
    )


def _from_top(integrand: FloatArray, step: float) -> FloatArray:
    """Integrate from the top of the grid down to each point (trapezoidal rule)."""
    panel = 0.5 * step * (integrand[1:] + integrand[:-1])
    total = np.zeros_like(integrand)
    total[:-1] = np.cumsum(panel[::-1], axis=0)[::-1]
    return total


def decay_signal(
    decay: MasterDecay, start: float, phase: float, time: FloatArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return one hit's signal at the centre frequency and its derivatives.

    Args:
        decay: of the mode.
        start: L at time 0.
        phase: at time 0 [rad].
        time: [s], ascending, shape (n,).

    Returns:
        Signal, shape (n,), and derivatives with respect to the coefficients of
        ln omega, of ln zeta, to `start` and to `phase`, shape (n, 2 n_functions + 2).
    """
    signal = np.empty(time.size, complex)
    change = np.empty((time.size, 2 * decay.values.shape[1] + 2), complex)
    _trace(  # type: ignore[no-untyped-call]
        (decay.grid, decay.omega, decay.zeta, decay.slope, decay.tau, decay.phase),
        (decay.values, decay.inner_time, decay.inner_phase),
        (float(decay.power), decay.centre, start, phase),
        time,
        signal,
        change,
    )
    return signal, change


@compiled(nogil=True, error_model="numpy")
def _trace(  # type: ignore[no-untyped-def]
    curves,
    tables,
    numbers,
    time,
    signal,
    change,
):
    """Follow one decay; see `decay_signal`."""
    grid, omega, zeta, slope, tau, theta = curves
    values, inner_time, inner_phase = tables
    power, centre, start, phase = numbers
    last, size = grid.size - 1, values.shape[1]
    step = grid[1] - grid[0]
    place = min(max((start - grid[0]) / step, 0.0), last - 1e-9)
    i = int(place)
    u = place - i
    tau0 = tau[i] + u * (tau[i + 1] - tau[i])
    theta0 = theta[i] + u * (theta[i + 1] - theta[i])
    zeta0 = zeta[i] + u * (zeta[i + 1] - zeta[i])
    rate0 = zeta0 * (omega[i] + u * (omega[i + 1] - omega[i]))
    time0 = inner_time[i] + u * (inner_time[i + 1] - inner_time[i])
    phase0 = inner_phase[i] + u * (inner_phase[i + 1] - inner_phase[i])
    for n in range(time.size):
        wanted = tau0 + time[n]
        while i > 0 and tau[i] < wanted:
            i -= 1
        u = min(max((tau[i] - wanted) / (tau[i] - tau[i + 1]), 0.0), 1.0)
        level = grid[i] + u * step
        w = omega[i] + u * (omega[i + 1] - omega[i])
        z = zeta[i] + u * (zeta[i + 1] - zeta[i])
        s = slope[i] + u * (slope[i + 1] - slope[i])
        angle = theta[i] + u * (theta[i + 1] - theta[i]) - theta0 + phase
        size_now = np.exp(level + power * np.log(w / centre))
        value = size_now * np.exp(1j * angle)
        signal[n] = value
        by_level = value * (1.0 + power * s)
        rate = z * w
        for j in range(size):
            b = values[i, j] + u * (values[i + 1, j] - values[i, j])
            t = inner_time[i, j] + u * (inner_time[i + 1, j] - inner_time[i, j])
            p = inner_phase[i, j] + u * (inner_phase[i + 1, j] - inner_phase[i, j])
            dl = -rate * (t - time0[j])
            change[n, j] = by_level * dl - 1j * value * dl / z + value * power * b
            turn = -dl / z - (p - phase0[j])
            change[n, size + j] = by_level * dl + 1j * value * turn
        by_start = rate / rate0
        turn = 1.0 / zeta0 - by_start / z
        change[n, 2 * size] = by_level * by_start + 1j * value * turn
        change[n, 2 * size + 1] = 1j * value
