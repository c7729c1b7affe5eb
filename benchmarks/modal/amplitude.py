# SPDX-License-Identifier: MIT
"""How good the modes over amplitude are: coverage, errors, false findings.

Usage: OMP_NUM_THREADS=1 python benchmarks/modal/amplitude.py --log LOG.jsonl
    [--minutes 20] [--first 0] [--base 900000] [--parts linear ...]
    [--page docs/modal-amplitude-coverage.md --commit HASH]

The parts (or those named, one as often as it is named) take turns until the time is up;
each draw is one line of the log, and a later run continues where the log ends. Part and
seed, counted from a base, define a draw. A part ends early once the Wilson interval of
its share is past the bar.
"""

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from amplitude_cases import LAWS, Case, draw, linear_draw, pair_draw
from amplitude_peers import PEERS, peer_curve
from jointed_masses import true_curve
from scipy.stats import binomtest

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.signal.amplitude.amplitude_curve import AmplitudeMode, Dependence
from jointbench.signal.amplitude.ring_downs import ring_downs
from jointbench.station.pipeline.chain import ChainSettings, ModalChain, judged_modes

_NORMAL_95 = 1.959964
_NEAR = 0.08
# Median of the absolute value of a normal error, in standard deviations.
_MEDIAN = 0.6745
FAMILY = {
    "micro-slip": "friction",
    "jenkins": "friction",
    "cubic": "elastic",
    "clearance": "elastic",
    "quadratic damping": "quadratic",
}
PAIR_LAWS = ("micro-slip", "cubic", "quadratic damping")
DECIBELS = (40.0, 60.0, 80.0)
SOFTENING = (0.002, 0.005, 0.01, 0.02, 0.04)
Row = dict[str, Any]


def _chain(case: Case) -> ModalChain:
    return judged_modes([case.recording], ChainSettings())


def _nearest(chain: ModalChain, frequency: float) -> AmplitudeMode | None:
    near = [m for m in chain.amplitude if abs(m.soft.frequency / frequency - 1) < _NEAR]
    return min(near, key=lambda m: abs(m.soft.frequency - frequency), default=None)


def _exponent(case: Case, mode: AmplitudeMode) -> Row:
    """Return the exponent of micro-slip as found, with its sd, and the joint's own."""
    joint = case.structure.joint
    slip = np.log(joint.slider_force / joint.slider_stiffness)
    true = float(np.polyfit(slip, np.log(joint.slider_stiffness), 1)[0])
    found = [law for law in mode.laws if law.name == "micro-slip power law"]
    if not found:
        return {}
    value, sd = found[0].exponent, found[0].exponent_sd
    return {"exponent_true": true, "exponent": value, "exponent_sd": sd}


def _modes_near(chain: ModalChain, frequency: float) -> int:
    found = chain.result.model.natural_frequency
    return int(np.sum(np.abs(found / frequency - 1) < _NEAR))


def curves(seed: int) -> Row:
    """One joint, one law, one noise level: errors and coverage of the curve."""
    law = LAWS[seed % len(LAWS)]
    decibel = DECIBELS[seed // len(LAWS) % 3]
    # Each law meets all changes within some thirty seeds.
    turn = seed + seed // len(LAWS) + seed // (3 * len(LAWS))
    softening = SOFTENING[turn % len(SOFTENING)]
    bodies = None if seed % 2 else 1
    case = draw(
        10_000 + seed, law=law, softening=softening, decibel=decibel, bodies=bodies
    )
    frequency = float(case.structure.modes()[0][case.mode] / 2 / np.pi)
    started = time.process_time()
    chain = _chain(case)
    row: Row = {
        "law": law,
        "decibel": decibel,
        "softening": softening,
        "bodies": case.structure.mass.size,
        "cpu": time.process_time() - started,
        "near": _modes_near(chain, frequency),
    }
    mode = _nearest(chain, frequency)
    if mode is None or mode.curve is None:
        return row | {"outcome": mode.dependence.value if mode else "no mode"}
    return row | {"outcome": mode.dependence.value} | _scores(case, mode)


def _scores(case: Case, mode: AmplitudeMode) -> Row:
    curve = mode.curve
    assert curve is not None
    sizes = case.joint_amplitude * np.geomspace(1e-4, 3.0, 50)
    truth = true_curve(case.structure, case.mode, sizes)
    mass = int(curve.channel.split("@")[1]) - 1
    f, z = truth.at(mass, curve.amplitude)
    return {
        "f_held": float(
            np.mean(np.abs(curve.frequency - f) < _NORMAL_95 * curve.frequency_sd)
        ),
        "z_held": float(
            np.mean(np.abs(curve.damping_ratio - z) < _NORMAL_95 * curve.damping_sd)
        ),
        "f_ppm": float(1e6 * np.sqrt(np.mean((curve.frequency / f - 1) ** 2))),
        "z_percent": float(100 * np.median(np.abs(curve.damping_ratio / z - 1))),
        "z_bound": float(100 * np.median(curve.damping_noise_sd / z) * _MEDIAN),
        "residual_ratio": mode.residual_ratio,
        "exponent": mode.laws[0].exponent if mode.laws else None,
        "law_found": mode.laws[0].name if mode.laws else None,
        "peers": _peers(case, mode, mass, truth.at),
    }


def _peers(
    case: Case, mode: AmplitudeMode, mass: int, truth: Callable[..., Any]
) -> Row:
    """Return errors of the peers, and ours at the same amplitudes."""
    curve = mode.curve
    assert curve is not None
    decays = ring_downs([case.recording])
    channel = decays.labels.index(curve.channel)
    every = case.structure.modes()[0] / 2 / np.pi
    own = float(curve.frequency[0])
    others = every[np.abs(every - every[case.mode]) > 1.0]
    room = min([0.15 * own, *(0.5 * np.abs(others - own))])
    found: Row = {}
    for name, peer in PEERS.items():
        size, f, z = peer_curve(
            peer,
            list(decays.samples[:, channel]),
            decays.sample_rate,
            (own - room, own + room),
            (own, float(curve.damping_ratio[0])),
        )
        inside = (size > curve.amplitude[0]) & (size < curve.amplitude[-1])
        if inside.sum() < 3:
            continue
        true_f, true_z = truth(mass, size[inside])
        ours = np.array([curve.at(float(one)) for one in size[inside]])
        found[name] = [
            float(1e6 * np.sqrt(np.mean((f[inside] / true_f - 1) ** 2))),
            float(100 * np.median(np.abs(z[inside] / true_z - 1))),
            float(1e6 * np.sqrt(np.mean((ours[:, 0] / true_f - 1) ** 2))),
            float(100 * np.median(np.abs(ours[:, 1] / true_z - 1))),
            float(
                100
                * _MEDIAN
                * np.median(
                    np.interp(size[inside], curve.amplitude, curve.damping_noise_sd)
                    / true_z
                )
            ),
        ]
    return found


def softening(seed: int) -> Row:
    """One physical mode that softens by 0 to 5 %: how many modes are reported."""
    rng = np.random.default_rng(seed)
    change = float(rng.uniform(0.0, 0.05))
    decibel = float(rng.choice(DECIBELS))
    case = draw(
        20_000 + seed, law="micro-slip", softening=change, decibel=decibel, bodies=1
    )
    frequency = float(case.structure.modes()[0][0] / 2 / np.pi)
    chain = _chain(case)
    mode = _nearest(chain, frequency)
    return {
        "change": change,
        "near": _modes_near(chain, frequency),
        "outcome": mode.dependence.value if mode else "no mode",
        "soft_error": mode.soft.frequency / frequency - 1.0 if mode else None,
        "soft_sd": mode.soft.frequency_sd / frequency if mode else None,
    }


def linear(seed: int) -> Row:
    """A linear structure: outcomes of its modes."""
    recording, _ = linear_draw(30_000 + seed)
    chain = judged_modes([recording], ChainSettings())
    return {
        "outcomes": [mode.dependence.value for mode in chain.amplitude],
        "merged": sum(len(mode.replaces) - 1 for mode in chain.amplitude),
    }


def families(seed: int) -> Row:
    """A random joint: is its family right."""
    rng = np.random.default_rng(40_000 + seed)
    law = LAWS[seed % len(LAWS)]
    case = draw(
        40_000 + seed,
        law=law,
        softening=float(rng.uniform(0.004, 0.03)),
        decibel=float(rng.choice(DECIBELS)),
        bodies=1,
    )
    frequency = float(case.structure.modes()[0][case.mode] / 2 / np.pi)
    mode = _nearest(_chain(case), frequency)
    if mode is None or mode.curve is None:
        outcome = mode.dependence.value if mode else "no mode"
        return {"law": law, "family": "", "span": 0, "outcome": outcome}
    span = float(np.log10(mode.curve.amplitude[-1] / mode.curve.amplitude[0]))
    return {
        "law": law,
        "family": mode.family,
        "span": span,
        "outcome": mode.dependence.value,
        "right": mode.family.startswith(FAMILY[law]),
        **(_exponent(case, mode) if law == "micro-slip" else {}),
        "ratio": None if np.isnan(mode.ratio) else mode.ratio,
    }


def exponents(seed: int) -> Row:
    """A random micro-slip joint: is its exponent in the 95 % interval."""
    rng = np.random.default_rng(60_000 + seed)
    change, decibel = float(rng.uniform(0.004, 0.03)), float(rng.choice(DECIBELS))
    case = draw(
        60_000 + seed, law="micro-slip", softening=change, decibel=decibel, bodies=1
    )
    mode = _nearest(_chain(case), float(case.structure.modes()[0][0] / 2 / np.pi))
    row: Row = {"change": change, "decibel": decibel}
    if mode is None:
        return row | {"outcome": "no mode"}
    first = mode.laws[0].name if mode.laws else None
    return row | {
        "outcome": mode.dependence.value,
        "law_found": first,
        **_exponent(case, mode),
    }


def pairs(seed: int) -> Row:
    """Two modes on one joint, 3 to 8 % apart: resolved, and right where they are."""
    rng = np.random.default_rng(50_000 + seed)
    law = PAIR_LAWS[seed % len(PAIR_LAWS)]
    change = float(10 ** rng.uniform(-3.5, -2.0))
    decibel = float(rng.choice(DECIBELS))
    case = pair_draw(50_000 + seed, law=law, softening=change, decibel=decibel)
    chain = _chain(case)
    every = case.structure.modes()[0] / 2 / np.pi
    near = [
        min(chain.amplitude, key=lambda m, one=one: abs(m.soft.frequency - one))
        for one in every
    ]
    resolved = all(
        mode.curve is not None and mode.dependence is not Dependence.NOT_DECIDED
        for mode in near
    )
    row: Row = {
        "law": law,
        "change": change,
        "decibel": decibel,
        "apart": float(every[1] / every[0] - 1.0),
        "outcomes": [mode.dependence.value for mode in near],
        "resolved": resolved and near[0] is not near[1],
    }
    if not row["resolved"]:
        return row
    errors = np.array([_pair_errors(case, k, mode) for k, mode in enumerate(near)])
    softs = [mode.soft.frequency for mode in near]
    return row | {
        "f_ppm": float(errors[:, 0].max()),
        "z_percent": float(errors[:, 1].max()),
        "ratio_percent": float(
            100 * abs(softs[1] / softs[0] / (every[1] / every[0]) - 1)
        ),
    }


def _pair_errors(case: Case, number: int, mode: AmplitudeMode) -> tuple[float, float]:
    """Return rms error of f [ppm] and median of zeta [%] where bands are narrow."""
    curve = mode.curve
    assert curve is not None
    sizes = case.joint_amplitude * np.geomspace(1e-4, 3.0, 50)
    mass = int(curve.channel.split("@")[1]) - 1
    truth = true_curve(case.structure, number, sizes)
    f, z = truth.at(mass, curve.amplitude)
    known = (curve.frequency_sd < 250e-6 * f) & (curve.damping_sd < 0.025 * z)
    if not known.any():
        return 0.0, 0.0
    return (
        float(1e6 * np.sqrt(np.mean((curve.frequency / f - 1)[known] ** 2))),
        float(100 * np.median(np.abs(curve.damping_ratio / z - 1)[known])),
    )


PARTS: dict[str, tuple[Callable[[int], Row], int]] = {
    "curves": (curves, 300),
    "softening": (softening, 300),
    "linear": (linear, 400),
    "families": (families, 60),
    "exponents": (exponents, 60),
    "pairs": (pairs, 60),
}


def wilson_ends(held: int, n: int) -> tuple[float, float]:
    """Return the ends of a share's 95 % Wilson interval [%]."""
    if n == 0:
        return 0.0, 100.0
    low, high = binomtest(held, n).proportion_ci(method="wilson")
    return 100 * float(low), 100 * float(high)


def wilson(held: int, n: int) -> str:
    """Return a share with its 95 % Wilson interval, in percent."""
    if n == 0:
        return "none run"
    low, high = wilson_ends(held, n)
    return f"{held} of {n}: {100 * held / n:.1f} % ({low:.1f} to {high:.1f})"


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--log", type=Path, required=True)
    parser.add_argument("--minutes", type=float, default=20.0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--page", type=Path)
    parser.add_argument("--commit", default="", help="of the code, for the page")
    parser.add_argument("--base", type=int, default=0)
    parser.add_argument("--parts", nargs="*", default=list(PARTS), choices=list(PARTS))
    given = parser.parse_args()
    done = _read(given.log)
    ends = time.monotonic() + 60 * given.minutes
    left = {
        part: [given.base + seed for seed in range(given.first, most)][::-1]
        for part, (_, most) in PARTS.items()
    }
    while time.monotonic() < ends and any(left[part] for part in given.parts):
        for part in given.parts:
            while left[part] and (part, left[part][-1]) in done:
                left[part].pop()
            if left[part] and not _clear(part, done) and time.monotonic() < ends:
                seed = left[part].pop()
                done[part, seed] = _drawn(PARTS[part][0], part, seed, given.log)
            elif _clear(part, done):
                left[part].clear()
    if given.page is not None:
        from amplitude_page import page

        given.page.write_text(page(done, given.commit))


def _clear(part: str, done: dict[tuple[str, int], Row]) -> bool:
    """Return whether the Wilson interval of a part is past its bar already."""
    rows = [row for (name, _), row in done.items() if name == part]
    if part == "softening":
        return wilson_ends(sum(row.get("near") == 1 for row in rows), len(rows))[0] > 97
    if part == "linear":
        fired = sum("depends" in row.get("outcomes", []) for row in rows)
        return wilson_ends(fired, len(rows))[1] < 1
    return False


def _drawn(run: Callable[[int], Row], part: str, seed: int, log: Path) -> Row:
    try:
        row = run(seed)
    except JointbenchError as error:
        row = {"failed": str(error)}
    with log.open("a") as file:
        file.write(json.dumps({"part": part, "seed": seed} | row) + "\n")
    print(part, seed, row, flush=True)
    return row


def _read(log: Path) -> dict[tuple[str, int], Row]:
    if not log.exists():
        return {}
    rows = [json.loads(line) for line in log.read_text().splitlines()]
    return {(row["part"], row["seed"]): row for row in rows}


if __name__ == "__main__":
    main()
