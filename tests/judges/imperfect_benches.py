"""Hammer campaigns on a bench that no model of two rigid bodies describes exactly.

The truth has two absorbers that the model lacks, other masses than the nominal ones,
gains of channels and hit points that are off, hits that scatter by channel with heavy
tails, and a joint law that is a mixture. Time integration by Newmark's method of
average acceleration with a fixed point for the joint force; sliders keep their own
state. The engine knows neither the integrator nor the scatter.

Source:
    Newmark 1959, J. Eng. Mech. Div. ASCE 85, 67 (beta = 1/4, gamma = 1/2).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.signal
from imperfect_laws import OUTSIDE, Floats, Law, law_of, newmark

from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.two_body_model import two_body_model

RATE = 16384.0
SAMPLES = 2048
STEPS = 8
"""Steps of the time integration per sample."""
SPREAD = {"m1": 0.003, "m2": 0.003, "k0": 0.05, "c0": 0.2, "kj": 0.1, "cj": 0.3}
FAMILY = {
    "cubic_stiffness": "stiffness",
    "quadratic_stiffness": "stiffness",
    "gap": "contact",
    "jenkins": "friction",
    "iwan": "friction",
    "bouc_wen": "friction",
    "coulomb": "friction",
    "quadratic_damping": "damping",
}
_CONDITIONS = (
    *((1, level, 1.0) for level in (30.0, 100.0, 300.0, 1000.0)),
    *((0, level, 1.0) for level in (100.0, 300.0, 1000.0)),
    *((1, 300.0, ratio) for ratio in (0.5, 2.0)),
    (0, 300.0, 2.0),
)
"""Hit body, level [N] and preload over the reference."""
_REPEATED = (1, 2, 3, 5, 6, 7)
"""Conditions that are measured twice."""
_LARGEST = 1.0
"""Largest wanted change of the records relative to the response; it saturates at the
square root of 2."""
_SIZED = (0, 1, 2, 3, 5)
"""Hits by which the size of a law is set."""


@dataclass(frozen=True)
class Imperfection:
    """How far the truth is from the model.

    Attributes:
        absorber: range of the mass of each absorber over that of its body [-].
        mass: sd of the relative error of the masses [-].
        gain: sd of the relative gain error of channels and of hit points [-].
        scatter: sd of the relative gain of each hit and channel [-].
        noise: of each acceleration [m/s^2].
    """

    absorber: tuple[float, float] = (0.002, 0.01)
    mass: float = 0.01
    gain: float = 0.01
    scatter: float = 0.005
    noise: float = 0.05


@dataclass(frozen=True)
class ImperfectBench:
    """A campaign and its truth.

    Attributes:
        campaign: what the engine is given.
        names: main and second law; empty where only model error is present.
        sizes: of the laws, the largest force over that of the linear spring [-].
        visible: change by the law over that by the model error, both rms over all
            records relative to the response [-].
    """

    campaign: Campaign
    names: tuple[str, ...]
    sizes: tuple[float, ...]
    visible: float

    @property
    def family(self) -> str:
        """Family of the main law; none where there is no law or it has no family."""
        known = FAMILY | OUTSIDE
        return known[self.names[0]] or "none" if self.names else "none"


@dataclass(frozen=True)
class _Truth:
    """Masses, matrices and the errors of a specimen."""

    mass: Floats
    stiffness: Floats
    damping: Floats
    direction: Floats


def _assembled(values: Mapping[str, float], absorbers: Floats) -> _Truth:
    """Return the matrices of two bodies with absorbers (body, m, k, c) on them."""
    n = 2 + len(absorbers)
    mass = np.concatenate([[values["m1"], values["m2"]], absorbers[:, 1]])
    stiffness, damping = np.zeros((n, n)), np.zeros((n, n))
    joint = np.zeros(n)
    joint[:2] = -1.0, 1.0
    ends = [np.eye(n)[0], joint]
    links = [(values["k0"], values["c0"]), (values["kj"], values["cj"])]
    for i, (body, _, k, c) in enumerate(absorbers):
        ends.append(np.eye(n)[2 + i] - np.eye(n)[int(body)])
        links.append((k, c))
    for end, (k, c) in zip(ends, links, strict=True):
        stiffness += k * np.outer(end, end)
        damping += c * np.outer(end, end)
    return _Truth(mass, stiffness, damping, joint)


def _pulse(level: float, width: float, start: float) -> Floats:
    """Return a hammer force at every step [N]: a power of a half sine."""
    time = np.arange(SAMPLES * STEPS) / (RATE * STEPS)
    phase = np.clip((time - start) / width, 0.0, 1.0)
    return np.asarray(level * np.sin(np.pi * phase) ** 1.7)


_FILTER = scipy.signal.firwin(
    64 * STEPS + 1, 0.46 * RATE, window=("kaiser", 9.0), fs=RATE * STEPS
)


def _recorded(fine: Floats) -> Floats:
    """Return a channel after a linear-phase anti-alias filter, without its delay."""
    filtered = scipy.signal.fftconvolve(fine, _FILTER[None, :], axes=1)
    half = (_FILTER.size - 1) // 2
    return np.asarray(filtered[:, half : half + fine.shape[1] : STEPS])


def largest_motion(truth: _Truth) -> tuple[float, float]:
    """Return the largest elongation [m] and its rate [m/s] at 1000 N, without a law."""
    law = Law()
    a = newmark(
        truth.mass,
        truth.damping,
        truth.stiffness,
        truth.direction,
        0.0,
        _pulse(1000.0, 1e-3, 0.008),
        1,
        1 / (RATE * STEPS),
        (law.numbers, law.sliders, law.hysteresis),
    )
    dt = 1 / (RATE * STEPS)
    v = np.cumsum(truth.direction @ a) * dt
    early = slice(0, v.size // 3)
    return float(np.abs(np.cumsum(v) * dt)[early].max()), float(np.abs(v[early]).max())


def make_bench_with_errors(
    seed: int,
    names: tuple[str, ...] = (),
    *,
    visible: float = 1.0,
    imperfection: Imperfection = Imperfection(),
) -> ImperfectBench:
    """Draw a bench and hammer it.

    Args:
        seed: of all draws.
        names: main law, and perhaps a second one of 8 to 25 % of its change.
        visible: wanted change by the laws over that by the model error [-].
        imperfection: of the truth against the model.
    """
    rng = np.random.default_rng([seed, 2025])
    nominal = {
        "m1": rng.uniform(6.5, 12.0),
        "m2": rng.uniform(3.0, 6.0),
        "k0": rng.uniform(1.6e7, 3.2e7),
        "c0": rng.uniform(200.0, 400.0),
        "kj": rng.uniform(4.0e7, 9.0e7),
        "cj": rng.uniform(150.0, 320.0),
    }
    errors = {k: SPREAD[k] * rng.standard_normal() for k in nominal}
    errors |= {k: imperfection.mass * rng.standard_normal() for k in ("m1", "m2")}
    real = {k: v * float(np.exp(errors[k])) for k, v in nominal.items()}
    absorbers = np.array([_absorber(real, imperfection, rng) for _ in range(2)])
    truth, hits = _assembled(real, absorbers), _hits(rng)
    plain = _struck(truth, Law(), hits)[1]
    ideal = dict(real, m1=nominal["m1"], m2=nominal["m2"])
    perfect = _struck(_assembled(ideal, np.zeros((0, 4))), Law(), hits)[1]
    error = _rms(plain - perfect * (1.0 + imperfection.gain), plain)
    motion = largest_motion(truth)
    shapes = [int(s) for s in rng.integers(2**31, size=2)]
    share = float(rng.uniform(0.08, 0.25))

    def struck(sizes: list[float], some: _Hits) -> tuple[Floats, Floats]:
        law = Law()
        for name, shape, size in zip(names, shapes, sizes, strict=False):
            drawn = np.random.default_rng(shape)
            law = law + law_of(name, size, motion, real["kj"], drawn)
        own = dict(real, kj=real["kj"] - law.stuck)
        return _struck(_assembled(own, absorbers), law, some)

    few = hits.only(_SIZED)
    sizes = [0.0] * len(names)
    for k in range(len(names)):
        wanted = min(error * visible, _LARGEST) * (share if k else 1.0)
        sizes[k] = _size_for(
            wanted, k, sizes, lambda sizes: struck(sizes, few)[1], plain[list(_SIZED)]
        )
    force, response = struck(sizes, hits)
    while not np.isfinite(response).all() or np.abs(response).max() > 1e5:
        sizes = [0.5 * size for size in sizes]  # the spring has become unstable
        force, response = struck(sizes, hits)
    reached = _rms(response - plain, plain) / error
    campaign = _measured(nominal, force, response, hits, imperfection, rng)
    return ImperfectBench(campaign, names, tuple(sizes), reached)


def _size_for(
    wanted: float,
    index: int,
    sizes: list[float],
    struck: Callable[[list[float]], Floats],
    plain: Floats,
) -> float:
    """Return the size of one law alone at which it changes the records as wanted."""
    size, trial = 0.03, [0.0] * len(sizes)
    for _ in range(3):
        trial[index] = size
        change = _rms(struck(trial) - plain, plain)
        if not np.isfinite(change):
            size *= 0.3
            continue
        size = float(np.clip(size * wanted / max(change, 1e-12), 1e-5, 0.6))
        if abs(np.log(change / wanted)) < 0.2:
            break
    return size


def _rms(difference: Floats, response: Floats) -> float:
    """Return the rms over records of a change relative to the response."""
    ratio = np.sum(difference**2, axis=(1, 2)) / np.sum(response**2, axis=(1, 2))
    return float(np.sqrt(ratio.mean()))


def _absorber(
    real: Mapping[str, float], errors: Imperfection, rng: np.random.Generator
) -> tuple[float, float, float, float]:
    """Return body, mass, spring and damper of an absorber."""
    body = int(rng.integers(2))
    mass = real[("m1", "m2")[body]] * rng.uniform(*errors.absorber)
    omega = 2 * np.pi * float(np.exp(rng.uniform(np.log(150.0), np.log(3000.0))))
    damping = 2 * rng.uniform(0.005, 0.03) * mass * omega
    return body, mass, mass * omega**2, damping


@dataclass(frozen=True)
class _Hits:
    """Body, level, preload ratio and pulse of each hit."""

    body: npt.NDArray[np.int64]
    level: Floats
    preload: Floats
    force: Floats

    def only(self, rows: tuple[int, ...]) -> "_Hits":
        """Return some of the hits."""
        at = list(rows)
        return _Hits(self.body[at], self.level[at], self.preload[at], self.force[at])


def _hits(rng: np.random.Generator) -> _Hits:
    """Return all conditions twice, each hit with a pulse of its own."""
    rows = [*_CONDITIONS, *(_CONDITIONS[i] for i in _REPEATED)]
    pulses = [
        _pulse(
            level * rng.uniform(0.92, 1.08),
            rng.uniform(0.9e-3, 1.3e-3),
            0.0078 + rng.uniform(-1e-4, 1e-4),
        )
        for _, level, _ in rows
    ]
    return _Hits(
        np.array([body for body, _, _ in rows]),
        np.array([level for _, level, _ in rows]),
        np.array([ratio for _, _, ratio in rows]),
        np.array(pulses),
    )


def _struck(truth: _Truth, law: Law, hits: _Hits) -> tuple[Floats, Floats]:
    """Return recorded forces and accelerations of both bodies."""
    parts = (law.numbers, law.sliders, law.hysteresis)
    found = []
    for body, force in zip(hits.body.tolist(), hits.force, strict=True):
        a = newmark(
            truth.mass,
            truth.damping,
            truth.stiffness,
            truth.direction,
            law.drift,
            force,
            body,
            1 / (RATE * STEPS),
            parts,
        )
        found.append(_recorded(a[:2]))
    return _recorded(hits.force), np.array(found)


def _measured(
    nominal: Mapping[str, float],
    force: Floats,
    response: Floats,
    hits: _Hits,
    errors: Imperfection,
    rng: np.random.Generator,
) -> Campaign:
    """Return the campaign with gains, scatter and noise."""
    records = len(force)
    point = np.exp(errors.gain * rng.standard_normal(2))[hits.body]
    channel = np.exp(errors.gain * rng.standard_normal(2))
    heavy = rng.standard_t(5, size=(records, 2)) / np.sqrt(5.0 / 3.0)
    common = errors.scatter * rng.standard_normal(records)
    gain = channel * (1.0 + errors.scatter * heavy)
    force = force * (point * (1.0 + common))[:, None]
    force = force + 0.4 * errors.noise * rng.standard_normal(force.shape)
    response = response * gain[:, :, None]
    response = response + errors.noise * rng.standard_normal(response.shape)
    return Campaign(
        name="imperfect",
        sample_rate=RATE,
        force=force,
        response=response,
        hit=hits.body,
        level=hits.level,
        preload=4000.0 * hits.preload,
        order=np.arange(records, dtype=float),
        preload_reference=4000.0,
        model=two_body_model(nominal, SPREAD),
    )
