# SPDX-License-Identifier: MIT
"""Count verdicts of the contact bench on simulated joints, and write the page.

Usage: python benchmarks/gap/contact_score.py RUNS.jsonl [--kind null|single]
           [--count 200] [--first 10000] [--page docs/gap-contact-confusion.md]

One JSON line for each joint; seeds that are in the file are skipped, so that an
interrupted run can be continued. A single effect with a margin below 50 is counted
as made and not judged; above, it is diagnosed with its effect taken out as well.
"""

import argparse
import json
import time
from collections import Counter
from pathlib import Path
from typing import Any

from contact_campaigns import HIDDEN, JointCampaign, make_joint
from outcomes import NAMEABLE, share_text

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.gap.contact_bench.contact_bench import make_contact_bench
from jointbench.analysis.gap.contact_bench.held_out_torques import HeldOutTorques
from jointbench.analysis.gap.law_diagnosis.contact_diagnosis import (
    ContactDiagnosis,
    diagnose_contact,
)
from jointbench.analysis.gap.law_diagnosis.contact_search import (
    fit_contact_base,
    fit_effect,
)
from jointbench.analysis.gap.search.screening import screen

Run = dict[str, Any]


@one_thread()
def margins(joint: JointCampaign) -> tuple[float, float]:
    """Return the expected margins: over rivals that are no generalisation, over all.

    The cost of the best rival less that of the truth, both fitted to the joint without
    scatter and noise; the base alone is a rival. Rivals are fitted by decreasing
    directed test until one is within `NAMEABLE`: what is returned is then a bound.
    """
    bench, base = fit_contact_base(make_contact_bench(joint.clean, joint.law))
    screening = screen(bench, base, bench.candidates)
    truth = [c for c in bench.candidates if c.effect.name == joint.truth]
    if not truth:
        return 0.0, 0.0
    own = fit_effect(bench, base, screening, truth[0])
    fair = whole = base.cost - own.cost
    for rival in screening.leaders(len(bench.candidates)):
        if rival is truth[0] or fair < NAMEABLE:
            continue
        margin = fit_effect(bench, base, screening, rival).cost - own.cost
        whole = min(whole, margin)
        if joint.truth not in rival.effect.generalises:
            fair = min(fair, margin)
    return fair, min(fair, whole)


def outcome(done: ContactDiagnosis, seconds: float) -> Run:
    """Return what is counted of a diagnosis."""
    found = done.found
    return {
        "verdict": found.verdict.value,
        "named": [[e.name, e.site] for e in found.effects],
        "confidence": [e.confidence for e in found.effects],
        "reason": found.reason,
        "closest": found.closest.effects[0] if found.closest else "",
        "values_inside": done.after.share_inside,
        "torques": [_torques_inside(done.after), len(done.after.levels)],
        "gap": [found.gap_before.value, found.gap_after.value],
        "seconds": seconds,
    }


def _torques_inside(held: HeldOutTorques) -> int:
    """Return the held-out torques whose values are all in one region of 95 %."""
    pairs = zip(held.chi2.tolist(), held.dof.tolist(), strict=True)
    return sum(chi2 <= chi2_limit(0.05, dof) for chi2, dof in pairs)


def judge(joint: JointCampaign, without: frozenset[str] = frozenset()) -> Run:
    """Return the verdict on one joint."""
    start = time.process_time()
    done = diagnose_contact(joint.data, joint.law, without=without)
    return outcome(done, time.process_time() - start)


def run_one(kind: str, seed: int) -> Run:
    """Return truth, margin and verdicts of one seed."""
    if kind == "null":
        return {
            "kind": kind,
            "seed": seed,
            "truth": "",
            "found": judge(make_joint(seed, "")),
        }
    joint = make_joint(seed, HIDDEN[seed % len(HIDDEN)])
    fair, whole = margins(joint)
    run: Run = {"kind": kind, "seed": seed, "truth": joint.truth, "site": joint.site}
    run |= {"margin": fair, "margin_all": whole}
    if fair >= NAMEABLE:
        run["found"] = judge(joint)
    if whole >= NAMEABLE:
        run["without"] = judge(joint, frozenset({joint.truth}))
    return run


def word_of(run: Run, found: Run) -> str:
    """Return the score of a verdict on a joint with an effect in the catalogue."""
    if found["verdict"] in {"none", "unknown"}:
        return str(found["verdict"])
    names = {tuple(one) for one in found["named"]}
    truth = (run["truth"], run["site"])
    if found["verdict"] == "ambiguous":
        return "ambiguous, truth in it" if truth in names else "ambiguous, wrong"
    return "right" if names == {truth} else "wrong name"


def main() -> None:
    """Run the seeds that are missing, and write the page if asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--kind", choices=("null", "single"), default="single")
    parser.add_argument("--count", type=int, default=0)
    parser.add_argument("--first", type=int, default=10_000)
    parser.add_argument("--page", type=Path)
    asked = parser.parse_args()
    lines = asked.runs.read_text().splitlines() if asked.runs.exists() else []
    runs = [json.loads(line) for line in lines]
    done = {(run["kind"], run["seed"]) for run in runs}
    with asked.runs.open("a", encoding="utf-8") as out:
        for seed in range(asked.first, asked.first + asked.count):
            if (asked.kind, seed) in done:
                continue
            runs.append(run_one(asked.kind, seed))
            out.write(json.dumps(runs[-1]) + "\n")
            out.flush()
    print("\n".join(tables(runs)))
    if asked.page:
        asked.page.write_text(page(runs), encoding="utf-8")


def tables(runs: list[Run]) -> list[str]:
    """Return the counts as Markdown."""
    null = [r["found"] for r in runs if r["kind"] == "null"]
    single = [r for r in runs if r["kind"] == "single"]
    strong = [r for r in single if r["margin"] >= NAMEABLE]
    hidden = [r for r in single if "without" in r]
    words = [word_of(r, r["found"]) for r in strong]
    out = [r["without"]["verdict"] for r in hidden]
    wrong = [w in {"wrong name", "ambiguous, wrong"} for w in words]
    right = [r for r, w in zip(strong, words, strict=True) if w == "right"]
    inside = sum(r["found"]["torques"][0] for r in right)
    torques = sum(r["found"]["torques"][1] for r in right)
    values = [r["found"]["values_inside"] for r in right]
    nulls = Counter(f["verdict"] for f in null)
    lines = ["| joints | bar | counted |", "|---|---|---|"]

    def row(name: str, bar: str, hits: int, count: int) -> None:
        lines.append(f"| {name} | {bar} | {share_text(hits, count)} |")

    row("nothing missing: none", ">= 98 %", nulls["none"], len(null))
    named = nulls["named"] + nulls["ambiguous"]
    row("nothing missing: a name", "<= 1 %", named, len(null))
    row("one effect, margin >= 50: right", ">= 88 %", words.count("right"), len(words))
    row("one effect, margin >= 50: wrong", "<= 2 %", sum(wrong), len(words))
    row("taken out: unknown", ">= 85 %", out.count("unknown"), len(out))
    row(
        "taken out: a name",
        "<= 5 %",
        out.count("named") + out.count("ambiguous"),
        len(out),
    )
    row("right name: held-out torque in its region of 95 %", ">= 90 %", inside, torques)
    if values:
        mean = 100 * sum(values) / len(values)
        name = "right name: held-out values in their interval of 95 %"
        lines.append(f"| {name} | | {mean:.1f} % |")
    seconds = [r["found"]["seconds"] for r in runs if "found" in r]
    if seconds:
        lines.append(f"| CPU s of a diagnosis: largest | <= 60 | {max(seconds):.1f} |")
    return [*lines, "", *by_effect(single)]


def by_effect(single: list[Run]) -> list[str]:
    """Return one row for each hidden effect."""
    lines = [
        "| hidden | made | margin >= 50 | right | ambiguous, truth in it | unknown | "
        "none | mistaken for | taken out: unknown, none, named as |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for name in HIDDEN:
        own = [r for r in single if r["truth"] == name]
        strong = [r for r in own if r["margin"] >= NAMEABLE]
        words = Counter(word_of(r, r["found"]) for r in strong)
        wrong = [
            "/".join(n for n, _ in r["found"]["named"])
            for r in strong
            if word_of(r, r["found"]) in {"wrong name", "ambiguous, wrong"}
        ]
        out = [r["without"] for r in own if "without" in r]
        kinds = Counter(f["verdict"] for f in out)
        as_ = sorted({n for f in out for n, _ in f["named"]})
        lines.append(
            f"| `{name}` | {len(own)} | {len(strong)} | {words['right']} | "
            f"{words['ambiguous, truth in it']} | {words['unknown']} | "
            f"{words['none']} | {', '.join(wrong) or '-'} | {kinds['unknown']}, "
            f"{kinds['none']}, {', '.join(as_) or '-'} |"
        )
    return lines


def page(runs: list[Run]) -> str:
    """Return the page with the counts."""
    seeds = {k: [r["seed"] for r in runs if r["kind"] == k] for k in ("null", "single")}
    spans = "; ".join(f"{k}: {min(s)} to {max(s)}" for k, s in seeds.items() if s)
    return HEAD + f"Seeds: {spans}.\n\n" + "\n".join(tables(runs)) + "\n"


HEAD = """# Verdicts of the contact bench on simulated joints

Written by `benchmarks/gap/contact_score.py`. The joints come from the physics of single
summits (`benchmarks/gap/contact_physics.py`), not from the formulas of the catalogue:
Hertz contacts summed one by one on simulated surfaces, waves closed by boundary
elements, flattened summits unloaded one by one, slip with the load of each contact.
Torques scatter uniformly, joints differ by 10 to 30 % from assembly to assembly (the
file states 20 %), values have correlated errors of 1.5 to 12 %. The law knows the
surface with errors of 5 to 10 %. The margin is the cost of the best rival less that of
the true effect on the same joint without scatter and noise; rivals that contain the
true effect as a special case are not counted. Shares have 95 % Wilson intervals.

Seeds 0 to 399, 50000 to 50014 and 60000 to 60045 (one effect), 20000 to 20216 and 45000
to 45022 (none) were used while effects and limits were set; none is counted here.

"""

if __name__ == "__main__":
    main()
