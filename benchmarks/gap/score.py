# SPDX-License-Identifier: MIT
"""Score the gap engine on campaigns with a known answer.

Usage: python benchmarks/gap/score.py DIRECTORY [--cases 0,2,4] [--without-truth]
                                      [--runs RUNS.jsonl]

DIRECTORY holds case_NN.h5 files and a truth.json as in shared/data/gap-campaigns.
With --without-truth each campaign's own effects are taken out of the catalogue, so
that "unknown" is right. Prints one line a campaign and a table of the outcomes. With
--runs each outcome is kept in a file, and what is in it is not run again.
"""

import argparse
import json
import time
from collections import Counter
from pathlib import Path
from typing import Any

from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis

Run = dict[str, Any]


def judge(names: set[str], found: Diagnosis, *, hidden: bool) -> str:
    """Return what a diagnosis is worth against the true names."""
    verdict = found.verdict.value
    named = {e.name for e in found.effects}
    if hidden and verdict == "unknown":
        return "right"
    if verdict == "none":
        return "right" if not names else "silent"
    if verdict == "unknown":
        return "unknown"
    if verdict == "mostly":
        partial = found.partial
        return "mostly right" if partial and partial.effect in names else "mostly other"
    if verdict == "ambiguous":
        return "ambiguous with truth" if names <= named else "ambiguous without"
    return "right" if named == names and not hidden else "WRONG"


def kind_of(names: set[str]) -> str:
    """Return none, single or pair."""
    return ("none", "single", "pair")[min(len(names), 2)]


def line(case: str, names: set[str], found: Diagnosis, word: str, took: float) -> str:
    """Return the line of one campaign."""
    named = " | ".join(
        f"{e.name}@{e.site} {e.confidence:.2f} "
        + " ".join(f"{p.name}={p.value:.5g}+-{p.sd:.2g}" for p in e.parameters)
        for e in found.effects
    )
    return (
        f"{case} {','.join(sorted(names)) or 'none':40s} {word:20s} "
        f"{found.verdict.value:9s} {named} gap {found.gap_before.value:.3g} -> "
        f"{found.gap_after.value:.3g} {took:.1f} s {found.reason}"
    )


def scored(directory: Path, case: str, names: set[str], hidden: bool) -> Run:
    """Diagnose one campaign and return its outcome.

    Args:
        directory: of the campaigns.
        case: name of the campaign.
        names: of its effects.
        hidden: whether they are taken out of the catalogue.
    """
    start = time.process_time()
    found = diagnose(
        read_campaign(directory / f"{case}.h5"),
        without=frozenset(names if hidden else ()),
    )
    seconds = time.process_time() - start
    word = judge(names, found, hidden=hidden)
    return {
        "case": case,
        "hidden": hidden,
        "kind": kind_of(names),
        "word": word,
        "seconds": seconds,
        "text": line(case, names, found, word, seconds),
    }


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=Path)
    parser.add_argument("--cases", default="")
    parser.add_argument("--without-truth", action="store_true")
    parser.add_argument("--runs", type=Path)
    arguments = parser.parse_args()
    directory, hidden = arguments.directory, arguments.without_truth
    truth: dict[str, Any] = json.loads((directory / "truth.json").read_text())
    wanted = {f"case_{int(n):02d}" for n in arguments.cases.split(",") if n}
    kept = _kept(arguments.runs, hidden)
    runs = []
    for case, answer in sorted(truth.items()):
        names = set(answer["effects"])
        if (wanted and case not in wanted) or (hidden and not names):
            continue
        run = kept.get(case) or scored(directory, case, names, hidden)
        runs.append(run)
        if arguments.runs and case not in kept:
            with arguments.runs.open("a", encoding="utf-8") as out:
                out.write(json.dumps(run) + "\n")
        print(run["text"], flush=True)
    for (kind, word), count in sorted(Counter(map(_outcome, runs)).items()):
        print(f"{kind:8s} {word:22s} {count}")
    times = sorted(run["seconds"] for run in runs)
    print(f"median {times[len(times) // 2]:.1f} s, worst {times[-1]:.1f} s")


def _outcome(run: Run) -> tuple[str, str]:
    return run["kind"], run["word"]


def _kept(path: Path | None, hidden: bool) -> dict[str, Run]:
    """Return the outcomes of a file by campaign; none if there is no file."""
    if path is None or not path.exists():
        return {}
    lines = path.read_text(encoding="utf-8").splitlines()
    return {r["case"]: r for r in map(json.loads, lines) if r["hidden"] is hidden}


if __name__ == "__main__":
    main()
