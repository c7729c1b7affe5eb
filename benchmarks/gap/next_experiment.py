# SPDX-License-Identifier: MIT
"""Do recommended experiments decide ambiguous verdicts on joints? Count, write page.

Usage: python benchmarks/gap/next_experiment.py RUNS.jsonl [--count 200]
           [--first 90000] [--page docs/gap-next-experiment.md]

A joint with one hidden effect is measured once, rising. Where the verdict is ambiguous
and the truth has an expected margin of 10 or more over every rival, the recommended
series is simulated by the physics of the joint, and so is one drawn at random; each is
diagnosed beside the first data. One JSON line for each joint; seeds that are in the
file are skipped.
"""

import argparse
import json
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import contact_campaigns as maker
import numpy as np
from outcomes import share_text

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.contact_bench.contact_bench import make_contact_bench
from jointbench.analysis.gap.contact_bench.joint_states import JointData, JointStates
from jointbench.analysis.gap.law_diagnosis.contact_diagnosis import (
    ContactDiagnosis,
    diagnose_contact,
)
from jointbench.analysis.gap.law_diagnosis.contact_search import (
    fit_contact_base,
    fit_effect,
)
from jointbench.analysis.gap.next_experiment.contact_series import (
    joined_states,
    new_states,
    torque_series,
)
from jointbench.analysis.gap.search.screening import screen

LEAST_MARGIN = 10.0
Run = dict[str, Any]


class LongJoint:
    """One joint in the first session and in every candidate series after it.

    Sizes of the effect are drawn over all states, so that the joint is one and the
    same in all of them.
    """

    def __init__(self, seed: int, effect: str) -> None:
        """Draw the joint and measure it in all its states."""
        plan = maker.plan_joint(np.random.default_rng([seed, 77]), effect)
        law, plan = maker.measured_law(plan)
        self.law = law
        states = plan.states
        first = (states.assembly == 0) & ~states.falling
        short = _chosen(states, np.flatnonzero(first))
        self.first = np.flatnonzero(first[first])
        known = JointData("joint", plan.facts, short, _no_rows())
        self.series, joined = [], short
        for series in torque_series(short):
            begin = joined.torque.size
            own = new_states(replace(known, states=joined), series)
            joined = joined_states(joined, own)
            self.series.append(np.arange(begin, joined.torque.size))
        ratio = float(np.median(plan.true_preload[first] / states.torque[first]))
        washers = np.isfinite(joined.preload)
        plan = replace(plan, states=joined, true_preload=joined.torque * ratio)
        sds = maker.value_sds(plan)
        plan, factors = maker.scattered(plan)
        rng = np.random.default_rng([seed, 79])
        reading = plan.true_preload * np.exp(
            joined.preload_sd * rng.standard_normal(joined.torque.size)
        )
        plan = replace(
            plan,
            states=replace(joined, preload=np.where(washers, reading, np.nan)),
        )
        self.data = maker.data_of(
            plan, maker.truth_of(plan, seed, factors), sds, noisy=True
        )
        flat = replace(plan, rng=np.random.default_rng(0))
        true = maker.truth_of(flat, seed, np.ones_like(factors))
        self.clean = maker.data_of(flat, true, sds)

    def part(self, states: np.ndarray, *, clean: bool = False) -> JointData:
        """Return the joint as measured in some of its states."""
        data = self.clean if clean else self.data
        rows = data.rows.chosen(np.isin(data.rows.state, states))
        place = {int(old): new for new, old in enumerate(states)}
        state = np.array([place[int(k)] for k in rows.state])
        return replace(
            data,
            states=_chosen(data.states, states),
            rows=replace(rows, state=state),
        )


def _no_rows() -> Any:
    return None


def _chosen(states: JointStates, index: np.ndarray) -> JointStates:
    assembly = np.unique(states.assembly[index], return_inverse=True)[1]
    return JointStates(
        torque=states.torque[index],
        preload=states.preload[index],
        preload_sd=states.preload_sd[index],
        assembly=assembly,
        falling=states.falling[index],
        time=states.time[index],
        shear=states.shear[index],
        frequency=states.frequency[index],
    )


@one_thread()
def margin(joint: LongJoint, effect: str, site: str) -> float:
    """Return the expected margin of the truth on the first data.

    The cost of the best rival less that of the truth, both fitted to data without
    scatter; the base is a rival, what contains the truth is none.
    """
    made = make_contact_bench(joint.part(joint.first, clean=True), joint.law)
    bench, base = fit_contact_base(made)
    tests = screen(bench, base, bench.candidates)
    fits = [(c, fit_effect(bench, base, tests, c)) for c in bench.candidates]
    own = [f.cost for c, f in fits if c.effect.name == effect and str(c.site) == site]
    others = [
        f.cost
        for c, f in fits
        if c.effect.name != effect and effect not in c.effect.generalises
    ]
    return min([base.cost, *others]) - own[0] if own else 0.0


def word_of(done: ContactDiagnosis, truth: str) -> str:
    """Return what an experiment made of an ambiguous verdict."""
    found = done.found
    verdict = found.verdict.value
    if verdict == "named":
        return "right" if found.effects[0].name == truth else "wrong"
    if verdict == "ambiguous":
        held = truth in {e.name for e in found.effects}
        return "ambiguous" if held else "ambiguous, wrong"
    return "wrong" if verdict == "none" else verdict


def run_one(seed: int) -> Run:
    """Return verdicts on one joint before and after its experiments."""
    effect = maker.HIDDEN[seed % len(maker.HIDDEN)]
    joint = LongJoint(seed, effect)
    site = {
        "radiated_damping": "joint:normal",
        "gas_film": "joint:normal",
        "microslip_damping": "joint:tangential",
    }.get(effect, "link:joint")
    run: Run = {"seed": seed, "truth": effect}
    start = time.process_time()
    done = diagnose_contact(joint.part(joint.first), joint.law)
    run |= {"verdict": done.found.verdict.value, "first": word_of(done, effect)}
    run["seconds"] = time.process_time() - start
    if run["verdict"] != "ambiguous" or not done.experiments:
        return run
    run["margin"] = margin(joint, effect, site)
    if run["margin"] < LEAST_MARGIN:
        return run
    best = done.experiments[0]
    drawn = int(np.random.default_rng([seed, 80]).integers(len(joint.series)))
    run |= {"best": best.name, "minutes": best.minutes}
    run["expected"] = best.expected.decided
    run["random"] = next(e.name for e in done.experiments if e.index == drawn)
    for key, index in (("after_best", best.index), ("after_random", drawn)):
        both = np.concatenate([joint.first, joint.series[index]])
        run[key] = word_of(diagnose_contact(joint.part(both), joint.law), effect)
    return run


def main() -> None:
    """Run the seeds that are missing, and write the page if asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--count", type=int, default=0)
    parser.add_argument("--first", type=int, default=90_000)
    parser.add_argument("--page", type=Path)
    asked = parser.parse_args()
    lines = asked.runs.read_text().splitlines() if asked.runs.exists() else []
    runs = [json.loads(line) for line in lines]
    done = {run["seed"] for run in runs}
    with asked.runs.open("a", encoding="utf-8") as out:
        for seed in range(asked.first, asked.first + asked.count):
            if seed in done:
                continue
            runs.append(run_one(seed))
            out.write(json.dumps(runs[-1]) + "\n")
            out.flush()
    print("\n".join(tables(runs)))
    if asked.page:
        asked.page.write_text(page(runs), encoding="utf-8")


def tables(runs: list[Run]) -> list[str]:
    """Return the counts as Markdown."""
    judged = [r for r in runs if "after_best" in r]
    n = len(judged)
    rows = [
        f"{len(runs)} joints, {sum(r['verdict'] == 'ambiguous' for r in runs)} "
        f"ambiguous after the first session, {n} of these with a margin of "
        f"{LEAST_MARGIN:g} or more.",
        "",
        "| after | decided rightly | decided wrongly | still ambiguous, truth in it | "
        "other |",
        "|---|---|---|---|---|",
    ]
    for key, label in (
        ("after_best", "the recommended experiment"),
        ("after_random", "one drawn at random"),
    ):
        count = Counter(r[key] for r in judged)
        other = n - count["right"] - count["wrong"] - count["ambiguous"]
        rows.append(
            f"| {label} | {share_text(count['right'], n)} | "
            f"{share_text(count['wrong'], n)} | {count['ambiguous']} | {other} |"
        )
    if judged:
        mean = float(np.mean([r["expected"] for r in judged]))
        minutes = float(np.median([r["minutes"] for r in judged]))
        rows += [
            "",
            f"Expected beforehand: {100 * mean:.0f} % decided. The recommended "
            f"experiment takes {minutes:.0f} minutes (median). Recommended: "
            + ", ".join(
                f"{name} {k} times"
                for name, k in Counter(r["best"] for r in judged).most_common()
            )
            + ".",
        ]
    return rows


def page(runs: list[Run]) -> str:
    """Return the page with the counts and every joint that was judged."""
    seeds = [r["seed"] for r in runs]
    lines = [
        f"| {r['seed']} | {r['truth']} | {r['margin']:.0f} | {r['best']} | "
        f"{r['after_best']} | {r['random']} | {r['after_random']} |"
        for r in runs
        if "after_best" in r
    ]
    return "\n".join(
        [
            "# Does the recommended experiment decide?",
            "",
            "Made by `python benchmarks/gap/next_experiment.py RUNS.jsonl --first "
            f"{min(seeds)} --count {len(seeds)} --page docs/gap-next-experiment.md`.",
            "A joint with one hidden effect (the physics of "
            "[gap-contact-confusion.md](gap-contact-confusion.md)) is measured once, "
            "with rising torques. Where the verdict is ambiguous, the recommended "
            "series is simulated and diagnosed beside the first data, and so is one "
            "of the same candidates drawn at random.",
            "",
            *tables(runs),
            "",
            "| seed | truth | margin | recommended | after it | at random | after it |",
            "|---|---|---|---|---|---|---|",
            *lines,
            "",
        ]
    )


if __name__ == "__main__":
    main()
