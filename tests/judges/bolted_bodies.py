"""Two bolted bodies integrated step by step: judge of the closed responses.

The modes are random but consistent numbers: the equations do not ask where a table
comes from. Springs, dampers and sliders act in modal coordinates, and
`scipy.integrate.solve_ivp` integrates them with small steps.
"""

import itertools

import numpy as np
import scipy.integrate
import scipy.interpolate
import scipy.signal

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.structure_response.common_filter import CommonFilter
from jointbench.analysis.gap.structure_response.hit_campaign import HitRecords
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import (
    HitPoint,
    JointedBodies,
    MassPlace,
    NominalBench,
)
from jointbench.analysis.gap.structure_response.port_laws import LawForm, PortLaws

RATE = 32_768.0
"""Of the raw force [Hz]."""
FILTER = CommonFilter(scipy.signal.firwin(41, 4500.0, fs=RATE), 2)
PARTS = 4
"""Intervals per sample, after each of which the sliders remember where they stuck."""
BOLTS, FEET, CHANNELS, ELASTIC = 4, 4, 3, 4


NOMINAL = NominalBench(
    stiffness=np.array([3e6, 4e6, 8e6]),
    damping=np.array([60.0, 60.0, 90.0]),
    stiffness_sd=0.1,
    damping_sd=0.3,
    bolt_sd=0.03,
    foot=(4e4, 40.0),
    foot_sd=(0.2, 0.3),
    loss=(0.004, 0.3),
    modulus_sd=0.02,
    mass_sd=0.001,
    aim_sd=1e-3,
    tilt_sd=0.02,
    torque_reference=40.0,
    bolt_places=np.zeros((0, 2)),
)
"""Nominal values of joints of them."""


def random_bodies(
    seed: int = 1, rigid: tuple[bool, bool, bool] = (False,) * 3
) -> JointedBodies:
    """Return two bodies with six rigid and four elastic modes each."""
    rng = np.random.default_rng(seed)
    n = 2 * (6 + ELASTIC)
    free = np.concatenate([np.zeros(6), 2 * np.pi * rng.uniform(300, 1500, ELASTIC)])
    body = np.repeat([0, 1], n // 2)
    on = [np.where(body == k, 1.0, 0.0) for k in (0, 1)]
    shapes = 0.3 * rng.standard_normal((BOLTS, 3, n))
    hit = 0.3 * rng.standard_normal((3, n)) * on[1]
    place = MassPlace("P1", hit, hit[2:])
    point = HitPoint(
        "P1",
        np.array([0.0, 0.0, -1.0]),
        np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        hit,
        3.0 * rng.standard_normal((2, 3, n)) * on[1],
    )
    return JointedBodies(
        bodies=("bottom", "top"),
        body=body,
        omega=np.concatenate([free, 1.1 * free]),
        bolts=shapes * (on[1] - on[0]),
        feet=0.3 * rng.standard_normal((FEET, 3, n)) * on[0],
        channels=tuple(f"A{k}" for k in range(CHANNELS)),
        sensors=0.3 * rng.standard_normal((CHANNELS, n)),
        points=(point,),
        places=(place,),
        rigid=rigid,
        across=np.zeros((0, 2, n)),
    )


def smooth_hits(count: int = 440, peak: float = 500.0) -> HitRecords:
    """Return two hits of a smooth pulse; the responses are zero."""
    t = np.arange(count) / RATE
    pulse = peak * np.exp(-0.5 * ((t - 2e-3) / 2.5e-4) ** 2)
    raw = np.stack([pulse, 0.5 * pulse])
    force = FILTER(raw)
    return HitRecords(
        names=("r0", "r1"),
        sample_rate=RATE / FILTER.step,
        force=force,
        response=np.zeros((2, CHANNELS, force.shape[1])),
        noise=np.ones((2, CHANNELS)),
        point=np.array([0, 0]),
        torque=np.array([20.0, 80.0]),
        level=np.array([peak, 0.5 * peak]),
        lead=8,
        band=3000.0,
        raw_force=raw,
        filter=FILTER,
    )


def integrated(
    bodies: JointedBodies, state: JointState, force: FloatArray, column: FloatArray
) -> FloatArray:
    """Return the filtered accelerations at the sensors, (n_channels, n_samples).

    Args:
        bodies: without rigid directions.
        state: with or without sliders and rigid masses.
        force: raw, of one hit [N], shape (n_raw,).
        column: of the force in modes, shape (n_modes,).
    """
    n = bodies.omega.size
    omega = bodies.omega * np.sqrt(state.modulus)[bodies.body]
    mass, ground = np.diag(state.mass[bodies.body]), np.zeros((n, n))
    for one in state.attached:
        place = one.rows(bodies)
        mass += one.mass * place.T @ place
        ground += one.stiffness * place.T @ place
    inverse = np.linalg.inv(mass)
    stiff = state.mass[bodies.body] * omega**2
    lossy = state.mass[bodies.body] * 2 * state.loss[bodies.body] * omega
    rows = bodies.bolts.reshape(-1, n)
    k = np.repeat(state.bolt, 3) / np.tile(state.compliance, len(state.bolt))
    c = np.repeat(state.bolt, 3) * np.tile(state.damping, len(state.bolt))
    feet = bodies.feet.reshape(-1, n)
    foot = state.foot[0] * np.repeat(state.foot_factor, 3)
    sensors = bodies.sensors if state.sensors is None else state.sensors
    sliding = [law for law in state.laws if law.kind == LawForm.FRICTION]
    others = [law for law in state.laws if law.kind != LawForm.FRICTION]
    ports = np.array([p for law in sliding for p in law.ports], dtype=int)
    slips = np.array([law.slips for law in sliding for _ in law.ports])
    weights = np.array([law.weights for law in sliding for _ in law.ports])
    sizes = np.array([law.size for law in sliding for _ in law.ports])
    gradual = np.array(
        [
            np.arange(law.slips.size) >= law.slips.size - law.gradual
            for law in sliding
            for _ in law.ports
        ],
        dtype=bool,
    ).reshape(slips.shape)
    held = sizes * k[ports]
    elastic, lossy_joint = np.diag(k), np.diag(c)
    if state.rocking is not None:
        own = np.ix_(*2 * [np.arange(2, len(k), 3)])
        coupled = np.linalg.inv(np.linalg.inv(elastic[own]) + state.rocking)
        elastic[own] = coupled
        lossy_joint[own] = state.compliance[2] * state.damping[2] * coupled
    elastic[ports, ports] -= held
    times = np.arange(force.size) / RATE
    spline = scipy.interpolate.CubicSpline(times, force)

    def held_force(
        motion: FloatArray, memory: FloatArray, bent: FloatArray
    ) -> FloatArray:
        stretch = np.clip(memory + motion[:, None], -slips, slips)
        stretch = np.where(gradual, slips * bent, stretch)
        return np.asarray(held * np.sum(stretch * weights, axis=1))

    def rates(t: float, y: FloatArray, memory: FloatArray) -> FloatArray:
        q, v, bent = y[:n], y[n : 2 * n], y[2 * n :].reshape(slips.shape)
        joint = elastic @ (rows @ q) + lossy_joint @ (rows @ v)
        bending = np.zeros_like(slips)
        if sliding:
            joint[ports] += held_force(rows[ports] @ q, memory, bent)
            # Bouc and Wen with an exponent of 2 and elastic unloading.
            speed = (rows[ports] @ v)[:, None]
            held_back = 0.5 * np.abs(bent) * (np.abs(bent) + bent * np.sign(speed))
            bending = np.where(gradual, speed / slips * (1.0 - held_back), 0.0)
        for law in others:
            own = rows[list(law.ports)]
            joint[list(law.ports)] += _force(law, own @ q, own @ v)
        push = column * float(spline(t)) - joint @ rows
        push -= (foot * (feet @ q) + state.foot[1] * (feet @ v)) @ feet + ground @ q
        moved = inverse @ (push - stiff * q - lossy * v)
        return np.concatenate([v, moved, bending.ravel()])

    # Sliders remember where they stuck: between two samples the motion hardly turns.
    y, memory = np.zeros(2 * n + slips.size), np.zeros_like(slips)
    moved = [rates(0.0, y, memory)[n : 2 * n]]
    fine = np.linspace(0.0, times[-1], PARTS * (times.size - 1) + 1)
    for start, end in itertools.pairwise(fine):
        y = scipy.integrate.solve_ivp(
            rates, (start, end), y, args=(memory,), rtol=1e-7, atol=1e-13
        ).y[:, -1]
        if sliding:
            motion = (rows[ports] @ y[:n])[:, None]
            memory = np.clip(memory + motion, -slips, slips) - motion
        moved.append(rates(end, y, memory)[n : 2 * n])
    # A stop has a kink, whose spectrum would fold back without a filter.
    fine_motion = sensors @ np.array(moved).T
    return FILTER(
        scipy.signal.resample_poly(
            fine_motion, 1, PARTS, axis=1, window=("kaiser", 10.0)
        )
    )


def _force(law: PortLaws, motion: FloatArray, speed: FloatArray) -> FloatArray:
    """Return the force of a law without memory, shape (n_ports,)."""
    forces = {
        LawForm.STOP: np.maximum(motion - law.gap, 0.0),
        LawForm.CUBIC: motion**3,
        LawForm.QUADRATIC: motion**2,
        LawForm.SQUARE_DAMPING: speed * np.abs(speed),
    }
    return np.asarray(law.size * forces[law.kind])
