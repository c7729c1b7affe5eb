# SPDX-License-Identifier: MIT
"""Write docs/gap-model-error.md from the judgements of model_error.py.

Usage: python benchmarks/gap/model_error_page.py RUNS.jsonl > docs/gap-model-error.md
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from outcomes import wilson

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))
from imperfect_benches import FAMILY

from jointbench.analysis.gap.model.policy import STANDARD

Run = dict[str, Any]
_LIMITS = (
    "mostly_standard_errors",
    "mostly_conditions",
    "mostly_share",
    "mostly_left",
    "mostly_beside",
)
_INTRO = (
    "# Verdicts under model error\n\n"
    "Made by `benchmarks/gap/model_error.py` and `model_error_page.py`. The benches "
    "are those of `tests/judges/imperfect_benches.py`, which share neither "
    "integrator nor scatter model with the engine: two absorbers of 0.2 to 1 % of a "
    "body's mass that the model lacks, masses off by 1 % (their priors state 0.3 "
    "%), gains of channels and of hit points off by 1 %, 0.5 % scatter of each hit "
    "and channel with heavy tails (Student t with 5 degrees of freedom) and of each "
    "hit's force, and a joint law that is a mixture of a main law and a second one "
    "of another family with 8 to 25 % of its change of the records. Time "
    "integration: Newmark's method at eight steps per sample. The change by the "
    "laws is 0.25 to 2.5 times the change by unknown modes, masses and gains "
    "together. Counts with 95 % Wilson intervals in %.\n"
)


def share(hits: int, n: int) -> str:
    """Return a count with its interval."""
    if n == 0:
        return "not run"
    low, high = wilson(hits, n)
    return f"{100 * hits / n:.0f} % ({hits}/{n}; {low:.0f} to {high:.0f})"


def word_of(run: Run) -> str:
    """Return right, wrong, open or unknown, at the limits in force."""
    if run["verdict"] not in ("mostly", "unknown"):
        return str(run["verdict"])
    if family := named_with(run):
        right = family == run["family"] and run["kind"] == "mixture"
        return "right" if right else "wrong"
    partial = run["mostly"]
    return "open" if partial is not None and partial["nonlinear"] else "unknown"


def named_with(run: Run, **limits: float) -> str:
    """Return the family that is named at other limits, or empty."""
    m = run["mostly"]
    if m is None:
        return ""
    at = {name: limits.get(name, float(getattr(STANDARD, name))) for name in _LIMITS}
    clear = all(
        lead["standard_errors"] > at["mostly_standard_errors"]
        and lead["conditions"] >= at["mostly_conditions"]
        for lead in (m["lead"], *m["rivals"])
    )
    left, beside = m["left_of_explainable"], m.get("beside")
    explained = m["share_explained"] if left is None else 1.0 - left
    explained = max(m["share_explained"], explained)
    near = left is not None and left <= at["mostly_left"]
    near = near and m["share_explained"] >= at["mostly_share"]
    shaped = beside is None or beside["share"] <= at["mostly_beside"]
    named = clear and explained >= at["mostly_share"] and (near or shaped)
    return str(m["family"]) if named and m["nonlinear"] else ""


def effect_of(name: str, runs: Sequence[Run]) -> str:
    """Return how many verdicts change if a limit is 30 % lower or higher."""
    value, words = float(getattr(STANDARD, name)), []
    for sign, factor in (("-", 0.7), ("+", 1.3)):
        changed = sum(
            named_with(r, **{name: factor * value}) != named_with(r) for r in runs
        )
        words.append(f"{sign}30 %: {changed} of {len(runs)}")
    return "; ".join(words)


def _counts(runs: Sequence[Run]) -> list[str]:
    """Return the table of counts."""
    lines = [
        "| set | n | right | wrong | open | unknown |",
        "|---|---|---|---|---|---|",
    ]
    for kind in ("mixture", "taken out", "no law"):
        own = [word_of(r) for r in runs if r["kind"] == kind]
        cells = [share(own.count(w), len(own)) for w in ("right", "wrong")]
        cells += [str(own.count(w)) for w in ("open", "unknown")]
        lines.append(f"| {kind} | {len(own)} | {' | '.join(cells)} |")
    return lines


def _of_the_second(runs: Sequence[Run]) -> str:
    """Return how many families named falsely are that of the second law."""
    own = [r for r in runs if r["kind"] == "taken out"]
    wrong = [r for r in own if word_of(r) == "wrong"]
    there = sum(named_with(r) == FAMILY[r["truth"][1]] for r in wrong)
    return (
        f"Of the {len(wrong)} wrong names of the second set {there} are the family of "
        "the second law, which is in the records. A family that is in no law of the "
        f"records was named in {share(len(wrong) - there, len(own))}."
    )


def _by(runs: Sequence[Run], name: str, key: Callable[[Run], str]) -> list[str]:
    """Return right and wrong of the mixtures by some key."""
    lines = ["", f"| {name} | n | right | wrong | open or unknown |"]
    lines.append("|---|---|---|---|---|")
    own = [r for r in runs if r["kind"] == "mixture"]
    for label in sorted({key(r) for r in own}):
        words = Counter(word_of(r) for r in own if key(r) == label)
        rest = words["open"] + words["unknown"]
        n = sum(words.values())
        lines.append(
            f"| {label} | {n} | {words['right']} | {words['wrong']} | {rest} |"
        )
    return lines


def _visible(run: Run) -> str:
    return "law below model error" if run["visible"] < 1.0 else "law above model error"


def outside_part(runs: Sequence[Run]) -> list[str]:
    """Return what the verdict makes of effects that no catalogue has."""
    own = [r for r in runs if r["kind"] == "outside"]
    if not own:
        return []
    lines = [
        "## Effects outside every catalogue",
        "",
        "The joint law is one that the catalogue lacks; every second bench has hardly "
        "any model error. A family that is not true of the law counts as a wrong name "
        "(a stiffness that drifts within a record has none).",
        "",
        "| effect | true family | n | wrong name | right family | joint called "
        "nonlinear | unknown |",
        "|---|---|---|---|---|---|---|",
    ]
    names = list(dict.fromkeys(r["truth"][0] for r in own))
    for label in (*names, "all"):
        some = [r for r in own if label in ("all", r["truth"][0])]
        words = Counter(_outside_word(r) for r in some)
        family = "" if label == "all" else some[0]["family"]
        cells = [share(words["wrong"], len(some)), str(words["right"])]
        cells += [str(words["open"]), str(words["unknown"])]
        lines.append(f"| {label} | {family} | {len(some)} | {' | '.join(cells)} |")
    whole = sum(r["whole"] for r in own)
    lines += ["", f"The whole engine ran in {whole} of them.", ""]
    return lines


def _outside_word(run: Run) -> str:
    """Return wrong, right, open or unknown for an effect outside every catalogue."""
    if run["verdict"] not in ("mostly", "unknown", "none"):
        return "wrong"
    if family := named_with(run):
        return "right" if family == run["family"] else "wrong"
    partial = run["mostly"]
    return "open" if partial is not None and partial["nonlinear"] else "unknown"


def page(every: Sequence[Run]) -> str:
    """Return the page."""
    runs = [r for r in every if r["kind"] != "outside"]
    seconds = [r["seconds"] for r in runs if not r["whole"]]
    lines = [
        _INTRO,
        "Mixture: the whole catalogue. Taken out: the same records, all laws of the "
        "main law's family taken out of the catalogue; any family named counts as "
        "wrong, also that of the second law. No law: only model error. Open: a joint "
        "called nonlinear without a family.",
        "",
        *_counts(runs),
        "",
        _of_the_second(runs),
        "",
        f"CPU time of this part of the verdict: median {np.median(seconds):.1f} s, "
        f"largest {np.max(seconds):.1f} s (of a machine that was also busy with other "
        "work).",
        "",
        *outside_part(every),
        "## Mixtures by main law, and by size",
        *_by(runs, "main law", lambda r: str(r["truth"][0])),
        *_by(runs, "size", _visible),
        "",
        "## Limits of the verdict",
        "",
        "Verdicts of all judgements above that change with one limit alone.",
        "",
        "| limit | value | change |",
        "|---|---|---|",
    ]
    for name in _LIMITS:
        value = getattr(STANDARD, name)
        lines.append(f"| {name} | {value:g} | {effect_of(name, runs)} |")
    wrong = [r for r in runs if word_of(r) == "wrong"]
    lines += ["", "## Wrong verdicts", ""]
    for r in wrong:
        m = r["mostly"]
        lines.append(
            f"* {r['kind']} {r['seed']}: {' with '.join(r['truth'])}; named "
            f"{m['family']} ({m['effect']}), {100 * m['share_explained']:.0f} % of the "
            "power removed"
        )
    if not wrong:
        lines.append("None.")
    return "\n".join([*lines, ""])


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    text = parser.parse_args().runs.read_text(encoding="utf-8")
    print(page([json.loads(line) for line in text.splitlines()]))


if __name__ == "__main__":
    main()
