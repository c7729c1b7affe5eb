# SPDX-License-Identifier: MIT
"""Hits on two plates of another library, integrated here: sliders at every node pair.

The matrices are those of `foreign_bodies`. The linear structure is reduced to its own
modes; sliders of an Iwan law act between all node pairs of a joint, and the motion is
integrated by the classical Runge-Kutta method of fourth order. Nothing of it is of
jointbench but the file that the hits are written to.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from foreign_bodies import PATCHES, FemBody, node_pairs, plates

from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.acquisition.records.session import JointSetup, new_session
from jointbench.acquisition.session_file.store import write_session

Array = np.ndarray
RATE, PARTS = 25_600, 4
"""Sample rate [Hz], and steps of the integration in a sample."""
QUIET, SAMPLES = 256, 3072
MODES = 160
SLIDERS = 24
FEET = ((0.02, 0.02), (0.34, 0.02), (0.34, 0.18), (0.02, 0.18))
POINTS = {
    "P1": ("upper", (0.07, 0.06, 0.036), (0.0, 0.0, -1.0)),
    "P2": ("upper", (0.23, 0.14, 0.036), (0.0, 0.0, -1.0)),
    "P3": ("upper", (0.33, 0.07, 0.028), (-1.0, 0.0, 0.0)),
    "P4": ("upper", (0.1, 0.18, 0.028), (0.0, -1.0, 0.0)),
}
SENSORS = {
    "a1": ("upper", (0.04, 0.03, 0.036), (0.0, 0.0, 1.0)),
    "a2": ("upper", (0.31, 0.16, 0.036), (0.0, 0.0, 1.0)),
    "a3": ("upper", (0.03, 0.13, 0.028), (1.0, 0.0, 0.0)),
    "a4": ("upper", (0.25, 0.02, 0.028), (0.0, 1.0, 0.0)),
    "a5": ("lower", (0.03, 0.17, 0.0), (0.0, 0.0, 1.0)),
    "a6": ("lower", (0.0, 0.08, 0.01), (1.0, 0.0, 0.0)),
}
LEVELS = (60.0, 250.0, 1000.0)
CONTACT = 3e-4
"""Duration of a contact [s]."""
NOISE = {"force": 0.02, "acceleration": 0.01}
NOMINAL = {"normal": 3e8, "tangential": 1.2e8, "normal_damping": 400.0}
NOMINAL |= {"tangential_damping": 200.0, "foot": 6e4, "foot_damping": 30.0}
NOMINAL |= {"damping_ratio": 0.004}
HIDDEN = ("none", "loose", "iwan", "thickness")


@dataclass(frozen=True)
class Truth:
    """What the plates are, beside their nominal values.

    Attributes:
        hide: one of `HIDDEN`.
        factors: on modulus of each plate; stiffness, damping of joints; of feet.
        joints: factor on stiffness and damping of each joint.
        ratio: damping ratio of each plate.
        slip: largest slip displacement of the Iwan law [m].
        share: of the tangential stiffness that its sliders hold.
        power: of their distribution.
        thicker: factor on the thickness of the upper plate.
    """

    hide: str
    factors: tuple[float, ...]
    joints: tuple[float, float]
    ratio: tuple[float, float]
    slip: float = 10e-6
    share: float = 0.6
    power: float = 1.5
    thicker: float = 1.0


def draw_truth(seed: int, hide: str) -> Truth:
    """Draw the plates as they are."""
    rng = np.random.default_rng(seed)
    sd = np.array([0.015, 0.015, 0.08, 0.25, 0.2, 0.25])
    factors = np.exp(sd * rng.standard_normal(sd.size))
    joints = np.exp(0.03 * rng.standard_normal(2))
    ratio = NOMINAL["damping_ratio"] * np.exp(0.25 * rng.standard_normal(2))
    found = Truth(hide, tuple(factors), tuple(joints), tuple(ratio))
    if hide == "loose":
        return replace(found, joints=(joints[0] * 0.25, joints[1]))
    if hide == "thickness":
        return replace(found, thicker=1.06)
    return found


@dataclass(frozen=True, eq=False)
class _System:
    """The structure in its own modes.

    Attributes:
        omega2: eigenvalues [1/s^2].
        damping: matrix, (n, n).
        shapes: of both plates, (n_freedoms, n).
        ports: relative motion of node pairs with sliders, (n_ports, n).
        held: stiffness of the sliders of each port [N/m].
    """

    omega2: Array
    damping: Array
    shapes: Array
    ports: Array
    held: Array


def _system(bodies: tuple[FemBody, FemBody], truth: Truth) -> _System:
    lower, upper = bodies
    first = 3 * len(lower.nodes)
    k = scipy.sparse.block_diag(
        [b.stiffness * f for b, f in zip(bodies, truth.factors, strict=False)], "csc"
    )
    m = scipy.sparse.block_diag([b.mass for b in bodies], "csc")
    loss = _body_damping(bodies, truth)
    damping: list[tuple[Array, Array]] = []
    ports, held = [], []
    for joint, factor in zip(PATCHES, truth.joints, strict=True):
        pairs = node_pairs(lower, upper, joint)
        for d in range(3):
            rows = _pair_rows(pairs.lower, pairs.upper, d, first, k.shape[0])
            word = "normal" if d == 2 else "tangential"
            stiff = factor * truth.factors[2] * NOMINAL[word] * pairs.share
            lossy = factor * truth.factors[3] * NOMINAL[f"{word}_damping"] * pairs.share
            k = k + rows.T @ (scipy.sparse.diags(stiff) @ rows)
            damping.append((rows, lossy))
            if truth.hide == "iwan" and joint == "left" and d < 2:
                ports.append(rows)
                held.append(truth.share * stiff)
    stands = lower.at(np.array([[x, y, 0.0] for x, y in FEET]))
    feet = scipy.sparse.kron(stands, np.eye(3))
    feet = scipy.sparse.hstack(
        [feet, scipy.sparse.csr_matrix((12, 3 * len(upper.nodes)))]
    )
    k = k + truth.factors[4] * NOMINAL["foot"] * feet.T @ feet
    damping.append((feet, np.full(12, truth.factors[5] * NOMINAL["foot_damping"])))
    values, shapes = scipy.sparse.linalg.eigsh(
        scipy.sparse.csc_matrix(k), MODES, m, sigma=-1e4
    )
    c = sum((w * r.T) @ r for r, w in ((rows @ shapes, one) for rows, one in damping))
    for row, size in loss:
        at = row @ shapes
        c = c + at.T @ (size[:, None] * at)
    none = np.zeros((0, MODES))
    return _System(
        values,
        c,
        shapes,
        np.concatenate([none, *(p @ shapes for p in ports)]),
        np.concatenate([np.zeros(0), *held]),
    )


def _body_damping(
    bodies: tuple[FemBody, FemBody], truth: Truth
) -> list[tuple[Array, Array]]:
    """Return rows and sizes of the modal damping of the free plates."""
    found = []
    sizes = [3 * len(b.nodes) for b in bodies]
    starts = np.concatenate([[0], np.cumsum(sizes)])
    for b, start, factor, ratio in zip(
        bodies, starts, truth.factors, truth.ratio, strict=False
    ):
        values, shapes = scipy.sparse.linalg.eigsh(
            b.stiffness * factor, 70, b.mass, sigma=-1e4
        )
        elastic = values > 1e3
        rows = np.zeros((int(elastic.sum()), starts[-1]))
        rows[:, start : start + 3 * len(b.nodes)] = (b.mass @ shapes[:, elastic]).T
        found.append((rows, 2 * ratio * np.sqrt(values[elastic])))
    return found


def _pair_rows(lower: Array, upper: Array, d: int, first: int, size: int):
    n = np.arange(lower.size)
    ones = np.ones(lower.size)
    data = np.concatenate([ones, -ones])
    columns = np.concatenate([first + 3 * upper + d, 3 * lower + d])
    return scipy.sparse.csr_matrix((data, (np.tile(n, 2), columns)), (n.size, size))


def _place_rows(
    bodies: tuple[FemBody, FemBody], name: str, place: Array, along: Array
) -> Array:
    """Return the row of a place along a direction, shape (n_freedoms,)."""
    rows = [np.zeros(3 * len(b.nodes)) for b in bodies]
    at = [b.name for b in bodies].index(name)
    values = bodies[at].at(np.array([place])).toarray()[0]
    rows[at] = np.outer(values, along).ravel()
    return np.concatenate(rows)


def _sliders(truth: Truth) -> tuple[Array, Array]:
    """Return slip displacements [m] and weights of an Iwan law at a node pair."""
    edges = np.linspace(0.0, 1.0, SLIDERS + 1)
    return truth.slip * 0.5 * (edges[1:] + edges[:-1]), np.diff(edges**truth.power)


def _integrated(
    system: _System, truth: Truth, inputs: Array, force: Array, read: Array
) -> Array:
    """Return accelerations of all hits, shape (n_hits, n_channels, n_samples).

    Args:
        system: in modes.
        truth: with the law.
        inputs: modal force of each hit per newton, shape (n, n_hits).
        force: at the steps [N], shape (n_hits, n_steps + 1) with two parts a step.
        read: rows of the sensors in modes, shape (n_channels, n).
    """
    h = 1.0 / (RATE * PARTS)
    n, hits = inputs.shape
    q, v = np.zeros((n, hits)), np.zeros((n, hits))
    slips, weights = _sliders(truth)
    stretch = np.zeros((slips.size, len(system.ports), hits))
    last = np.zeros((len(system.ports), hits))
    limit = slips[:, None, None]

    def clipped(q: Array) -> tuple[Array, Array]:
        r = system.ports @ q
        return r, np.clip(stretch + (r - last), -limit, limit)

    def accelerated(q: Array, v: Array, f: Array) -> Array:
        found = inputs * f - system.omega2[:, None] * q - system.damping @ v
        if len(system.ports):
            r, new = clipped(q)
            beyond = np.einsum("s,sph->ph", weights, new) - r
            found -= system.ports.T @ (system.held[:, None] * beyond)
        return found

    out = np.zeros((hits, len(read), force.shape[1] // (2 * PARTS)))
    for step in range((force.shape[1] - 1) // 2):
        f0, f1, f2 = force[:, 2 * step], force[:, 2 * step + 1], force[:, 2 * step + 2]
        a0 = accelerated(q, v, f0)
        if step % PARTS == 0:
            out[:, :, step // PARTS] = (read @ a0).T
        v1 = v + 0.5 * h * a0
        a1 = accelerated(q + 0.5 * h * v, v1, f1)
        v2 = v + 0.5 * h * a1
        a2 = accelerated(q + 0.5 * h * v1, v2, f1)
        v3 = v + h * a2
        a3 = accelerated(q + h * v2, v3, f2)
        q = q + h / 6 * (v + 2 * v1 + 2 * v2 + v3)
        v = v + h / 6 * (a0 + 2 * a1 + 2 * a2 + a3)
        if len(system.ports):
            last, stretch = clipped(q)
    return out


def make_session(path: Path, truth: Truth, seed: int, repeats: int = 2) -> dict:
    """Strike the plates and write a session.

    Returns:
        Facts: largest relative motion of the joint [m], natural frequencies [Hz].
    """
    rng = np.random.default_rng([seed, 1])
    bodies = plates((0.02, 0.016 * truth.thicker))
    system = _system(bodies, truth)
    read = np.array(
        [_place_rows(bodies, *one) for one in _moved(SENSORS, truth).values()]
    )
    plan = [(p, level) for p in POINTS for level in LEVELS for _ in range(repeats)]
    inputs, pulses = [], []
    for name, level in plan:
        body, place, direction = _moved(POINTS, truth)[name]
        aim, tilt = 1e-3 * rng.standard_normal(3), 0.017 * rng.standard_normal(3)
        along = np.asarray(direction)
        aim -= along * (along @ aim)
        turned = along + tilt
        row = _place_rows(bodies, body, place + aim, turned / np.linalg.norm(turned))
        inputs.append(row @ system.shapes)
        pulses.append(_pulse(level * np.exp(0.1 * rng.standard_normal()), rng))
    force = np.array(pulses)
    moved = _integrated(system, truth, np.array(inputs).T, force, read @ system.shapes)
    samples = np.concatenate(
        [force[:, None, : 2 * PARTS * (SAMPLES - QUIET) : 2 * PARTS], moved], 1
    )
    samples = np.pad(samples, ((0, 0), (0, 0), (QUIET, 0)))
    samples[:, 0] += NOISE["force"] * rng.standard_normal(samples[:, 0].shape)
    samples[:, 1:] += NOISE["acceleration"] * rng.standard_normal(samples[:, 1:].shape)
    channels = (
        Channel("force", Quantity.FORCE, unit="N"),
        *(Channel(name, Quantity.ACCELERATION, unit="m/s^2") for name in SENSORS),
    )
    recordings = [
        Recording(
            f"r{k:03d}",
            one,
            float(RATE),
            (replace(channels[0], point=plan[k][0]), *channels[1:]),
            start_time=10.0 * k,
        )
        for k, one in enumerate(samples)
    ]
    session = new_session(
        source="benchmarks/gap/foreign_campaign.py",
        simulated=True,
        recordings=recordings,
        joint=JointSetup(preload=8000.0),
    )
    write_session(session, path)
    return {
        "frequencies": (np.sqrt(np.maximum(system.omega2[:20], 0)) / 2 / np.pi)
        .round(1)
        .tolist()
    }


def _moved(places: dict, truth: Truth) -> dict:
    """Return places on plates as they are: those above the interface rise with it."""
    return {
        name: (
            body,
            (x, y, 0.02 + (z - 0.02) * truth.thicker) if body == "upper" else (x, y, z),
            along,
        )
        for name, (body, (x, y, z), along) in places.items()
    }


def _pulse(peak: float, rng: np.random.Generator) -> Array:
    """Return the force of a hit at half steps [N], shape (2 n_steps + 1,)."""
    count = 2 * PARTS * (SAMPLES - QUIET) + 1
    t = np.arange(count) / (2 * PARTS * RATE)
    length = CONTACT * np.exp(0.05 * rng.standard_normal())
    inside = (t > 1e-4) & (t < 1e-4 + length)
    shape = np.sin(np.pi * (t - 1e-4) / length) ** 2
    return peak * np.where(inside, shape, 0.0)
