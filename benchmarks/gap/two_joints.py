# SPDX-License-Identifier: MIT
"""Two nonlinear joints at once: forward accuracy and diagnoses.

Usage: python benchmarks/gap/two_joints.py forward FORWARD.jsonl
       python benchmarks/gap/two_joints.py diagnose RUNS.jsonl [--count 40] [--seed 1]
       python benchmarks/gap/two_joints.py page FORWARD.jsonl RUNS.jsonl

`forward` compares every pair of laws, a linear one included, with solve_ivp; `diagnose`
makes campaigns with a law at each of two joints and diagnoses them. What is in a file
already is skipped. `page` prints docs/gap-two-joints.md.
"""

import argparse
import json
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from outcomes import wilson
from two_joints_maker import LAWS, make_two_joints

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.lumped.lumped_model import LumpedModel

sys.path.append(str(Path(__file__).parents[2] / "tests" / "judges"))
PAIRED = (*LAWS, "maxwell")
STEPS = (8, 16, 64)
RUBBING = ("coulomb",)
POINTS = 64
"""Points of solve_ivp per sample where a force jumps; 16 otherwise."""
BAR = 1e-4
WORDS = ("right", "ambiguous with both", "one of two", "unknown", "wrong")


def main() -> None:
    """Run a part."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("forward", "diagnose", "page"))
    parser.add_argument("paths", type=Path, nargs="+")
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    if arguments.what == "page":
        forward, runs = (_lines(path) for path in arguments.paths)
        sys.stdout.write(page(forward, runs))
        return
    path = arguments.paths[0]
    done = {run["key"] for run in _lines(path)}
    seeds = range(arguments.seed, arguments.seed + arguments.count)
    jobs = _pairs() if arguments.what == "forward" else map(str, seeds)
    for key in jobs:
        if key not in done:
            run = forward_of(key) if arguments.what == "forward" else judge(int(key))
            with path.open("a", encoding="utf-8") as out:
                out.write(json.dumps({"key": key} | run) + "\n")
            sys.stderr.write(f"{key} {run.get('word', '')}\n")


def _lines(path: Path) -> list[dict[str, Any]]:
    if not path.exists():
        return []
    return [json.loads(row) for row in path.read_text(encoding="utf-8").splitlines()]


def _pairs() -> Iterator[str]:
    """Return every pair once; which of the two is at the foot alternates."""
    for i, first in enumerate(PAIRED):
        for j, second in enumerate(PAIRED[i:]):
            yield f"{first} {second}" if j % 2 == 0 else f"{second} {first}"


def judge(seed: int) -> dict[str, Any]:
    """Make a campaign and diagnose it."""
    from jointbench.analysis.gap.diagnosis.diagnose import diagnose
    from jointbench.analysis.gap.model.diagnosis_record import diagnosis_json

    made = make_two_joints(seed)
    start = time.process_time()
    found = diagnosis_json(diagnose(made.campaign))
    run = {
        "truth": made.truth,
        "parameters": [dict(e.parameters) for e in made.effects],
        "rho": made.rho,
        "seconds": time.process_time() - start,
        "found": found,
    }
    return run | {"word": word_of(run)}


def word_of(run: dict[str, Any]) -> str:
    """Return what a diagnosis is worth: one of `WORDS`."""
    truth, found = set(run["truth"]), run["found"]
    labels = {f"{e['name']}@{e['site']}" for e in found["effects"]}
    if found["verdict"] == "ambiguous":
        return "ambiguous with both" if truth <= labels else "wrong"
    if found["verdict"] != "named":
        return "unknown"
    if labels == truth:
        return "right"
    return "one of two" if labels < truth else "wrong"


def _two_joint_model() -> LumpedModel:
    from jointbench.analysis.gap.model.two_body_model import two_body_model

    nominal = {"m1": 8.0, "m2": 4.0, "k0": 2.4e7, "c0": 300.0, "kj": 6e7, "cj": 220.0}
    model = two_body_model(nominal, dict.fromkeys(nominal, 0.1))
    foot, joint = model.links
    return replace(model, links=(replace(foot, joint=True), joint))


def forward_of(key: str) -> dict[str, Any]:
    """Return the largest difference from solve_ivp over the peak, by steps."""
    from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
    from jointbench.analysis.gap.response.dynamic_stiffness import Action
    from jointbench.analysis.gap.response.effect_hooks import HitConditions
    from jointbench.analysis.gap.response.excitation import prepare_excitation
    from jointbench.analysis.gap.response.predict_records import respond
    from jointbench.analysis.gap.second_method.verify import second_response

    rate, samples = 16384.0, 288
    when = np.arange(samples) / rate
    pulse = np.exp(-0.5 * ((when - 0.004) / 2.5e-4) ** 2)
    conditions = HitConditions(np.ones(1), np.zeros(1))
    force = 1000.0 * pulse[None, :]
    excitation = prepare_excitation(force, np.array([1]), rate, conditions)
    model, names = _two_joint_model(), key.split()
    entries = {entry.name: entry for entry in CATALOGUE}
    # Stiffness, largest motion and speed of the foot and of the joint under that hit.
    links = ((2.4e7, 4.1e-5, 0.07), (6e7, 1.8e-5, 0.07))
    actions = [
        Action(entries[name], "link", at, np.array(_values(*links[at])[name]))
        for at, name in enumerate(names)
    ]
    points = POINTS if set(names) & set(RUBBING) else 16
    nominal = model.nominal
    expected = second_response(
        model, nominal, excitation, actions, tolerance=1e-9, points=points
    )
    peak = np.abs(expected).max(axis=-1, keepdims=True)

    def response(own: list[Action], steps: int) -> FloatArray:
        return respond(model, nominal, excitation, own, oversampling=steps)

    def apart(found: FloatArray) -> float:
        return float(np.abs((found - expected)[..., :-64] / peak).max())

    steps = {str(n): apart(response(actions, n)) for n in STEPS}
    both = response(actions[:1], STEPS[1]) + response(actions[1:], STEPS[1])
    return {"apart": steps, "serial": apart(both - response([], STEPS[1]))}


def _values(k: float, travel: float, speed: float) -> dict[str, list[float]]:
    """Return parameters of a typical size at a link."""
    return {
        "cubic_stiffness": [0.3 * k / travel**2],
        "quadratic_stiffness": [0.3 * k / travel],
        "gap": [0.3 * k, 0.2 * travel],
        "jenkins": [0.3 * k, 0.2 * travel, 14.0],
        "iwan": [0.3 * k, 0.6 * travel, 0.5, 14.0],
        "bouc_wen": [0.3 * k, 0.3 * travel, 1.5, 1.8],
        "coulomb": [0.05 * k * travel, 0.003 * speed],
        "quadratic_damping": [0.6 * k * travel / speed],
        "maxwell": [0.3 * k, 8e-4],
    }


def page(forward: list[dict[str, Any]], runs: list[dict[str, Any]]) -> str:
    """Return the page."""
    return "\n".join([*_forward_part(forward), "", *_diagnosis_part(runs), ""])


def _forward_part(forward: list[dict[str, Any]]) -> list[str]:
    apart = {run["key"]: run["apart"] for run in forward}
    serial = {run["key"]: run["serial"] for run in forward}
    rubbing = {key for key in apart if set(key.split()) & set(RUBBING)}
    lines = [
        "# Two nonlinear joints at once",
        "",
        "Made by `benchmarks/gap/two_joints.py`. The specimen is ground, foot, base, "
        "joint, top; a law acts at the foot and another one at the joint.",
        "",
        "## Forward response",
        "",
        f"All {len(apart)} pairs of {len(PAIRED)} laws against `solve_ivp` (LSODA, "
        "tolerance 1e-9): largest difference of an acceleration over its peak. The bar "
        f"is {BAR:g}. Last row: two single responses added up, for comparison.",
        "",
        "| steps a sample | without dry friction: median | worst | worst pair | "
        "with dry friction: median | worst | worst pair |",
        "|---" * 7 + "|",
    ]
    for steps in map(str, STEPS):
        cells = [steps]
        for keys in (apart.keys() - rubbing, rubbing):
            cells += _cells({key: apart[key][steps] for key in keys})
        lines.append(f"| {' | '.join(cells)} |")
    cells = ["added up"]
    for keys in (apart.keys() - rubbing, rubbing):
        cells += _cells({key: serial[key] for key in keys})
    return [*lines, f"| {' | '.join(cells)} |"]


def _cells(values: dict[str, float]) -> list[str]:
    if not values:
        return ["", "", ""]
    worst = max(values, key=lambda key: values[key])
    middle = float(np.median(list(values.values())))
    return [f"{middle:.1e}", f"{values[worst]:.1e}", worst.replace(" ", " + ")]


def _diagnosis_part(runs: list[dict[str, Any]]) -> list[str]:
    count = len(runs)
    lines = [
        "## Diagnoses",
        "",
        f"{count} campaigns (seeds 1 to 6 of 15 hits and 62 ms, the others of 12 hits "
        "and 47 ms) by the simulators' Runge-Kutta stepper, each "
        "with two laws drawn from eight; each law has a projected signal-to-noise "
        "ratio above 30 beside the other. Sites count: a right name at the other "
        "joint is wrong.",
        "",
        "| outcome | n | 95 % interval |",
        "|---|---|---|",
    ]
    for word in WORDS:
        mine = sum(run["word"] == word for run in runs)
        low, high = wilson(mine, count)
        share = f"{mine} ({100 * mine / count:.0f} %)"
        lines.append(f"| {word} | {share} | {low:.0f} to {high:.0f} % |")
    seconds = [run["seconds"] for run in runs]
    lines += [
        "",
        f"Computing time: median {np.median(seconds):.0f} s, worst "
        f"{max(seconds):.0f} s of one core.",
        "",
        "| seed | foot | joint | rho | verdict | found |",
        "|---" * 6 + "|",
    ]
    for run in runs:
        found = run["found"]
        labels = ", ".join(f"{e['name']}@{e['site']}" for e in found["effects"])
        names = [label.partition("@")[0] for label in run["truth"]]
        rho = " / ".join(f"{value:.0f}" for value in run["rho"])
        lines.append(
            f"| {run['key']} | {names[0]} | {names[1]} | {rho} | {run['word']} | "
            f"{found['verdict']}: {labels} |"
        )
    return lines


if __name__ == "__main__":
    main()
