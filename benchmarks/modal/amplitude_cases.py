# SPDX-License-Identifier: MIT
"""Random structures with a joint, struck at four levels: cases for `amplitude.py`."""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy.linalg

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))
from jointed_masses import (
    SAMPLE_RATE,
    Floats,
    Joint,
    Structure,
    chain,
    micro_slip,
    strike,
    with_joint,
)

from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)

LEVELS = np.repeat(np.geomspace(1 / 30, 1.0, 4), 2)
LAWS = ("micro-slip", "jenkins", "cubic", "quadratic damping", "clearance")
_DURATION, _LEAD = 2.0, 0.01
_MOST_CHANNELS = 3


@dataclass(frozen=True)
class Case:
    """One structure, struck.

    Attributes:
        structure: with its joint.
        mode: whose curve is asked for.
        joint_amplitude: that the hardest hit would reach in that mode [m].
        masses: with an accelerometer.
        recording: force and accelerations, hits judged.
        law: of the joint.
    """

    structure: Structure
    mode: int
    joint_amplitude: float
    masses: tuple[int, ...]
    recording: Recording
    law: str


def jointed(
    rng: np.random.Generator, bodies: int, law: str, softening: float
) -> tuple[Structure, int, float]:
    """Return a random chain with a joint, the mode it works on, and its amplitude.

    Args:
        rng: source of the draw.
        bodies: number of masses.
        law: one of `LAWS`.
        softening: change of frequency at the hardest hit [-]; for quadratic damping
            the added damping ratio.
    """
    while True:
        base = chain(rng, bodies)
        omega, shapes = base.modes()
        stretch = np.abs(base.direction @ shapes * shapes[0]) / omega
        mode = int(np.argmax(stretch))
        size = float(stretch[mode])
        share = float(abs(base.direction @ shapes[:, mode]))
        lost = 2.0 * softening * omega[mode] ** 2 / share**2
        joint = _joint(rng, law, lost, size, omega[mode])
        spring = base.direction @ base.stiffness @ base.direction
        stuck = joint.slider_stiffness.sum()
        if stuck < 0.8 * spring:
            return with_joint(base, joint, float(stuck)), mode, size


def _joint(
    rng: np.random.Generator, law: str, lost: float, size: float, omega: float
) -> Joint:
    if law == "micro-slip":
        return micro_slip(lost, size, float(rng.uniform(0.4, 1.2)))
    if law == "jenkins":
        slip = size * rng.uniform(0.15, 0.5)
        return Joint(
            slider_stiffness=np.array([1.3 * lost]),
            slider_force=np.array([1.3 * lost * slip]),
        )
    if law == "cubic":
        return Joint(cubic=float(rng.choice([-1, 1])) * lost / (0.75 * size**2))
    if law == "quadratic damping":
        return Joint(quadratic_damping=lost / (8 / (3 * np.pi) * size * omega**2))
    if law == "clearance":
        return Joint(clearance=0.3 * size, stop_stiffness=1.5 * lost)
    return Joint()


def record(
    rng: np.random.Generator,
    structure: Structure,
    *,
    decibel: float,
    scatter: float = 0.0,
    levels: Floats = LEVELS,
    masses: tuple[int, ...] | None = None,
) -> tuple[Recording, tuple[int, ...]]:
    """Strike a structure at several levels and record it with noise.

    Args:
        rng: source of levels, noise and aim.
        structure: to strike.
        decibel: rms of the hardest hit over the noise [dB].
        scatter: rms of the share of each hit that goes to the next mass [-].
        levels: impulses [N s].
        masses: with an accelerometer; None for the first three.
    """
    n = structure.mass.size
    masses = masses or tuple(range(min(n, _MOST_CHANNELS)))
    forces, answers = [], []
    for level in levels:
        impulse = float(level * rng.uniform(0.9, 1.1))
        width = float(rng.uniform(1.0e-3, 1.5e-3))
        off = float(rng.normal(0.0, scatter)) if scatter else 0.0
        force, answer = strike(
            structure, impulse, where=0, width=width, duration=_DURATION, aside=off
        )
        forces.append(force)
        answers.append(answer[list(masses)])
    samples = np.concatenate(
        (np.array(forces)[None], np.array(answers).transpose(1, 0, 2))
    ).reshape(1 + len(masses), -1)
    size = len(forces[0])
    loud = samples[1:, -size:].std()
    samples[1:] += rng.normal(0.0, loud * 10 ** (-decibel / 20), samples[1:].shape)
    samples[0] += rng.normal(0.0, 1e-4 * samples[0].max(), samples[0].shape)
    channels = [Channel("hammer", Quantity.FORCE, "1")]
    channels += [
        Channel(f"a{m + 1}", Quantity.ACCELERATION, f"{m + 1}") for m in masses
    ]
    return _with_hits(samples, size, tuple(channels)), masses


def _with_hits(samples: Floats, size: int, channels: tuple[Channel, ...]) -> Recording:
    trigger = round(_LEAD * SAMPLE_RATE) + 1
    hits = tuple(
        Hit(
            start=first,
            trigger=first + trigger,
            stop=first + size,
            point="1",
            peak_force=float(samples[0, first : first + size].max()),
            verdict=Verdict.OK,
            measure=0.0,
            reason="simulated",
        )
        for first in range(0, samples.shape[1], size)
    )
    return Recording("simulated", samples, SAMPLE_RATE, channels, hits=hits)


def draw(
    seed: int, *, law: str, softening: float, decibel: float, bodies: int | None = None
) -> Case:
    """Return a random case; the same seed gives the same one."""
    rng = np.random.default_rng(seed)
    bodies = bodies or int(rng.integers(2, 7))
    structure, mode, size = jointed(rng, bodies, law, softening)
    recording, masses = record(rng, structure, decibel=decibel)
    return Case(structure, mode, size, masses, recording, law)


def pair_draw(seed: int, *, law: str, softening: float, decibel: float) -> Case:
    """Return two oscillators 3 to 8 % apart with one joint between them.

    Args:
        seed: of the draw.
        law: of the joint.
        softening: change of frequency that the joint's largest motion would cause in
            the mode that it works on most [-].
        decibel: rms of the hardest hit over the noise [dB].
    """
    rng = np.random.default_rng(seed)
    mass = np.array([1.0, rng.uniform(0.5, 1.5)])
    own = mass * (2 * np.pi * 80.0) ** 2
    # Tuned apart by `detuned`, the link brings the modes to the wanted distance.
    wanted, link = float(rng.uniform(0.03, 0.08)), 0.005 * own[0]
    arm = np.array([1.0, -1.0])
    detuned = np.linspace(0.0, 0.12, 601)
    apart = [
        _distance(mass, own * [1.0, (1.0 + d) ** 2], link, arm)[0] for d in detuned
    ]
    at = int(np.argmin(np.abs(np.array(apart) - wanted)))
    stiffness = own * [1.0, (1.0 + detuned[at]) ** 2]
    _, omega, shapes = _distance(mass, stiffness, link, arm)
    base, ratio = np.diag(mass) @ shapes, rng.uniform(0.003, 0.008, 2)
    structure = Structure(
        mass,
        np.diag(stiffness) + link * np.outer(arm, arm),
        base @ np.diag(2 * ratio * omega) @ base.T,
        arm,
        Joint(),
    )
    stretch = np.abs(arm @ shapes * shapes[0]) / omega
    mode, size = int(np.argmax(stretch)), float(stretch.sum())
    lost = 2.0 * softening * omega[mode] ** 2 / float(arm @ shapes[:, mode]) ** 2
    joint = _joint(rng, law, lost, size, omega[mode])
    stuck = with_joint(structure, joint, float(joint.slider_stiffness.sum()))
    recording, masses = record(rng, stuck, decibel=decibel)
    return Case(stuck, mode, size, masses, recording, law)


def _distance(
    mass: Floats, own: Floats, link: float, arm: Floats
) -> tuple[float, Floats, Floats]:
    """Return the relative distance of two modes, their omega [rad/s] and shapes."""
    matrix = np.diag(own) + link * np.outer(arm, arm)
    squared, shapes = scipy.linalg.eigh(matrix, np.diag(mass))
    omega = np.sqrt(squared)
    return float(omega[1] / omega[0] - 1.0), omega, shapes


def linear_draw(seed: int) -> tuple[Recording, int]:
    """Return a linear structure: close modes, masses unseen, 1 % aim scatter.

    Returns:
        The recording, and how many modes lie below 600 Hz.
    """
    rng = np.random.default_rng(seed)
    bodies = int(rng.integers(2, 7))
    structure = chain(rng, bodies)
    if rng.random() < 0.5:
        structure = with_absorber(rng, structure)
    recording, _ = record(
        rng,
        structure,
        decibel=float(rng.choice([40.0, 60.0, 80.0])),
        scatter=0.01,
        masses=(0,) if rng.random() < 0.3 else None,
    )
    return recording, int(np.sum(structure.modes()[0] < 2 * np.pi * 600))


def with_absorber(rng: np.random.Generator, structure: Structure) -> Structure:
    """Hang a small mass onto a chain, tuned close to its first mode: a close pair."""
    omega = structure.modes()[0][0]
    n = structure.mass.size
    mass = float(10 ** rng.uniform(-4, -2))
    tuned = omega * (1.0 + float(rng.uniform(-0.02, 0.02)))
    spring, ratio = mass * tuned**2, float(rng.uniform(0.003, 0.008))
    arm = np.zeros(n + 1)
    arm[int(rng.integers(n))], arm[n] = 1.0, -1.0
    stiffness, damping = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    stiffness[:n, :n], damping[:n, :n] = structure.stiffness, structure.damping
    stiffness += spring * np.outer(arm, arm)
    damping += 2 * ratio * tuned * mass * np.outer(arm, arm)
    return replace(
        structure,
        mass=np.append(structure.mass, mass),
        stiffness=stiffness,
        damping=damping,
        direction=np.append(structure.direction, 0.0),
    )
