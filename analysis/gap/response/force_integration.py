# SPDX-License-Identifier: MIT
"""Compiled time integration of the nonlinear forces at all ports of a linear model.

A port is the relative motion across a joint. Only the difference between the motion
with and without the nonlinear forces is integrated, so that force laws of amplitude 0
leave the linear response unchanged to the last bit. The compliance between the ports is
a sum of modes, each integrated exactly for forces that are linear within the step
(first-order hold). The forces at the end of a step, at all ports at once, are computed
from the motion predicted with extrapolated forces, whose error is of the order dt^2/m
of a second difference and far below the noise; dry friction is solved for.

All functions called in a step are inlined: passing arrays would take longer than the
step itself. LLVM inlines them, so that each is typed and compiled once for all versions
(docs/decisions/0174).
"""

from typing import NamedTuple

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.analysis.gap.response.dry_friction import balance_friction
from jointbench.analysis.gap.response.law_forces import (
    BEFORE,
    COULOMB,
    CURVES,
    DEFECT,
    EARLIER,
    EXTRAPOLATED,
    FORCE,
    GUESS,
    LANES,
    LAST,
    LAW,
    LEAN,
    MOTION,
    ONE_SIDED,
    OWN,
    PACE,
    PORT,
    SHIFT,
    SLIDERS,
    SPEED,
    SPREAD,
    TWO_SIDED,
    IntegrationLaws,
    force_of_real_joint,
    force_without_memory,
)
from jointbench.analysis.gap.response.mode_steps import (
    add_speed_one_port,
    add_speed_ports,
    correct_one_port,
    correct_ports,
    mode_size,
    predict_one_port,
    predict_ports,
    resting_state,
)
from jointbench.analysis.gap.response.slider_integration import (
    Bank,
    Sliders,
    bank_forces,
)

VERSIONS = ((1,), (1, 2))
"""Arguments that choose the compiled version, since the length of a tuple is a constant
for the compiler: one port, or several ports."""


@compiled(fastmath=True, forceinline=True)
def _begin_step(
    w: FloatArray,
    f: FloatArray,
    ports: IntArray,
    several: bool,
    displacement: FloatArray,
    step: int,
    first: int,
) -> None:
    """Set the linear motions, and the forces as extrapolated from the last steps."""
    for q in range(displacement.shape[0] if several else 1):
        for k in range(LANES):
            at = q * PORT + k
            w[at + GUESS] = 0.0
            w[at + DEFECT] = 0.0
            w[at + LEAN] = 0.0
            w[at + SHIFT] = 0.0
            w[at + SPREAD] = 0.0
            w[at + LAST] = w[at + BEFORE]
            w[at + BEFORE] = w[at + MOTION]
            w[at + MOTION] = displacement[q, step, first + k]
    for a in range(ports.size):
        port = ports[a] * PORT if several else 0
        for k in range(LANES):
            at = a * LAW + k
            f[at + EXTRAPOLATED] = 2.0 * f[at + OWN] - f[at + EARLIER]
            f[at + EARLIER] = f[at + OWN]
            w[port + GUESS + k] += f[at + EXTRAPOLATED]


@compiled(fastmath=True, forceinline=True)
def _predict(w: FloatArray, n_modes: int, n_ports: int, several: bool) -> None:
    """Advance the modes with the extrapolated forces; add them to the motions."""
    if several:
        predict_ports(w, n_modes, n_ports)
    else:
        predict_one_port(w, n_modes)


@compiled(fastmath=True, forceinline=True)
def _set_speeds(
    w: FloatArray,
    n_modes: int,
    several: bool,
    velocity: FloatArray,
    step: int,
    first: int,
) -> None:
    """Set the speeds: the linear ones, and those of the modes."""
    n_ports = velocity.shape[0] if several else 1
    for q in range(n_ports):
        for k in range(LANES):
            w[q * PORT + SPEED + k] = velocity[q, step, first + k]
    if several:
        add_speed_ports(w, n_modes, n_ports)
    else:
        add_speed_one_port(w, n_modes)


@compiled(fastmath=True, forceinline=True)
def _end_step(
    w: FloatArray,
    f: FloatArray,
    ports: IntArray,
    several: bool,
    out: FloatArray,
    step: int,
    first: int,
) -> None:
    """Sum the forces of each port; leave their difference from the estimate."""
    n_ports = out.shape[0] if several else 1
    for q in range(n_ports):
        for k in range(LANES):
            w[q * PORT + FORCE + k] = 0.0
    for a in range(ports.size):
        port = ports[a] * PORT if several else 0
        for k in range(LANES):
            w[port + FORCE + k] += f[a * LAW + OWN + k]
    for q in range(n_ports):
        for k in range(LANES):
            at = q * PORT + k
            out[q, step, first + k] = w[at + FORCE]
            w[at + GUESS] = w[at + FORCE] - w[at + GUESS]


@compiled(fastmath=True, forceinline=True)
def _add_to_samples(
    w: FloatArray, several: bool, out: FloatArray, step: int, first: int
) -> None:
    """Add to the samples what a force does that jumps or bends within a step.

    A band-limited response shows the first moments of the force over the step. Three
    samples carry those that the samples at the ends of the step lack.

    Source:
        Euler and Maclaurin: sums of samples and integrals, at a jump between samples.
    """
    n_ports = out.shape[0] if several else 1
    for q in range(n_ports):
        for k in range(LANES):
            at = q * PORT + k
            mean, shift = w[at + DEFECT], w[at + SHIFT]
            far = 0.5 * (w[at + SPREAD] - 0.25 * mean)
            half, lean = 0.5 * (mean - far), shift + 1.5 * far
            out[q, step, first + k] += half + lean
            if step > 1:
                out[q, step - 1, first + k] += half - lean
                out[q, step - 2, first + k] += far


@compiled(fastmath=True, forceinline=True)
def _keep_pace(
    w: FloatArray,
    n_modes: int,
    several: bool,
    velocity: FloatArray,
    step: int,
    first: int,
) -> None:
    """Store the speeds at the end of a step, after the modes were corrected."""
    _set_speeds(w, n_modes, several, velocity, step, first)
    for p in range(velocity.shape[0] if several else 1):
        for k in range(LANES):
            w[p * PORT + PACE + k] = w[p * PORT + SPEED + k]


@compiled(fastmath=True, error_model="numpy")
def _integrate_lanes(
    displacement: FloatArray,
    velocity: FloatArray,
    w: FloatArray,
    laws: IntegrationLaws,
    needs_velocity: bool,
    first: int,
    version: tuple[int, ...],
    out: FloatArray,
) -> None:
    """Integrate as many records as there are lanes, beginning at `first`."""
    several = len(version) > 1
    n_ports = displacement.shape[0] if several else 1
    n_laws = laws.kinds.size
    coupled = w.size - (n_ports * n_ports * LANES if several else 0)
    n_modes = (coupled - n_ports * PORT) // mode_size(n_ports)
    states = np.zeros((LANES, laws.slips.size, 2))
    active = np.zeros((n_laws, LANES), dtype=np.int64)
    # Unpacked once: each access to a tuple changes a reference count.
    kinds, ports, p, ends, slips, weights, tables, tops, curves, band_limited = laws
    sliders, f = Sliders(slips, 1.0 / slips, weights), np.zeros(n_laws * LAW)
    rubbing = (kinds == COULOMB).any()
    bent = (kinds == ONE_SIDED).any() or (kinds == TWO_SIDED).any()
    uneven = band_limited and (rubbing or bent)
    for step in range(displacement.shape[1]):
        _begin_step(w, f, ports, several, displacement, step, first)
        _predict(w, n_modes, n_ports, several)
        if needs_velocity:
            _set_speeds(w, n_modes, several, velocity, step, first)
        for a in range(n_laws):
            port = ports[a] * PORT if several else 0
            if kinds[a] == SLIDERS:
                bank = Bank(
                    law=a,
                    first=ends[a],
                    beyond=ends[a + 1],
                    lanes=LANES,
                    now=port + MOTION,
                    last=port + BEFORE,
                    earlier=port + LAST,
                    force=a * LAW + OWN,
                )
                bank_forces(bank, w, f, states, active, sliders, tables, tops)
            elif kinds[a] > CURVES:
                force_of_real_joint(a, port, w, f, kinds, p)
            else:
                force_without_memory(a, port, w, f, kinds, p, curves)
        if rubbing:
            balance_friction(w, f, kinds, ports, p, coupled, n_ports)
        _end_step(w, f, ports, several, out, step, first)
        if uneven:
            _add_to_samples(w, several, out, step, first)
        if several:
            correct_ports(w, n_modes, n_ports, uneven)
        else:
            correct_one_port(w, n_modes, uneven)
        if rubbing:
            _keep_pace(w, n_modes, several, velocity, step, first)


class LaneModes(NamedTuple):
    """Modes between ports, scaled for the time integration.

    Attributes:
        poles: [rad/s], one of each conjugate pair, shape (n_modes, n_records).
        gains: of each mode [m/N rad/s], doubled for a pair, same shape.
        inputs: drive by each port [-], shape (n_modes, n_ports, n_records).
        shapes: motion of each port [-], same shape.
    """

    poles: ComplexArray
    gains: ComplexArray
    inputs: ComplexArray
    shapes: ComplexArray


@compiled(nogil=True, error_model="numpy")
def integrate_forces(
    displacement: FloatArray,
    velocity: FloatArray,
    modes: LaneModes,
    dt: float,
    laws: IntegrationLaws,
    needs_velocity: bool,
    version: tuple[int, ...],
) -> FloatArray:
    """Integrate the forces at all ports along their coupled motion.

    Args:
        displacement: linear motion of the ports [m], shape (n_ports, n_steps,
            n_columns): one column per record, and zero columns up to a multiple of
            `LANES`.
        velocity: its rate [m/s], same shape; ignored unless needed.
        modes: between the ports.
        dt: step [s].
        laws: that act together.
        needs_velocity: True if one of them depends on the velocity.
        version: one of `VERSIONS`.

    Returns:
        Force of the laws of each port together [N], shape (n_ports, n_steps,
        n_columns).
    """
    poles, gains, inputs, shapes = modes
    n_modes, n_ports, n_records = inputs.shape
    out = np.empty(displacement.shape)
    for first in range(0, displacement.shape[2], LANES):
        count = min(LANES, n_records - first)
        own_poles = np.full((n_modes, LANES), -1.0 + 0.0j)
        own_gains = np.zeros((n_modes, LANES), dtype=np.complex128)
        own_inputs = np.zeros((n_modes, n_ports, LANES), dtype=np.complex128)
        own_shapes = np.zeros((n_modes, n_ports, LANES), dtype=np.complex128)
        # Copied in a loop: the shape check of a slice takes seconds to compile.
        for m in range(n_modes):
            for k in range(count):
                own_poles[m, k] = poles[m, first + k]
                own_gains[m, k] = gains[m, first + k]
                for q in range(n_ports):
                    own_inputs[m, q, k] = inputs[m, q, first + k]
                    own_shapes[m, q, k] = shapes[m, q, first + k]
        w = resting_state(own_poles, own_gains, own_inputs, own_shapes, dt)
        _integrate_lanes(
            displacement, velocity, w, laws, needs_velocity, first, version, out
        )
    return out
