# SPDX-License-Identifier: MIT
"""The score of a verdict, and the sets of campaigns that share a target."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy.stats import binomtest

NAMEABLE = 50.0
NOT_IN_CATALOGUE = ("hidden", "outside")
Run = dict[str, Any]
WORDS = (
    "right",
    "ambiguous, truth in it",
    "unknown",
    "none",
    "one of two",
    "ambiguous, wrong",
    "wrong name",
    "crash",
)


def named_by(run: Run) -> list[tuple[str, str]]:
    """Return names and sites of what was named."""
    return [(e["name"], e["site"]) for e in run["found"].get("effects", [])]


def word_of(run: Run) -> str:
    """Return the score of a verdict: the exact names, or correct doubt."""
    verdict = run["found"]["verdict"]
    if verdict in {"crash", "unknown", "none"}:
        return str(verdict)
    truth, named = set(run["truth"]), {name for name, _ in named_by(run)}
    if verdict == "ambiguous":
        inside = bool(truth) and truth <= named and run["kind"] not in NOT_IN_CATALOGUE
        return "ambiguous, truth in it" if inside else "ambiguous, wrong"
    if run["kind"] in NOT_IN_CATALOGUE:
        return "wrong name"
    if run["kind"] == "pair" and named < truth:
        return "one of two"
    return "right" if named == truth else "wrong name"


def wilson(hits: int, count: int) -> tuple[float, float]:
    """Return the 95 % Wilson interval of a share [%]."""
    low, high = binomtest(hits, count).proportion_ci(method="wilson")
    return 100 * float(low), 100 * float(high)


def share_text(hits: int, count: int) -> str:
    """Return a share with its interval, in words."""
    if count == 0:
        return "-"
    low, high = wilson(hits, count)
    return f"{100 * hits / count:.1f} % ({hits}/{count}; {low:.1f} to {high:.1f})"


def sets_of(runs: Sequence[Run]) -> dict[str, list[Run]]:
    """Split runs into the sets that have a bar of their own."""
    margins = [min(run["margins"], default=np.inf) for run in runs]
    kinds: dict[str, Callable[[Run, float], bool]] = {
        "nothing missing": lambda r, m: r["kind"] == "null",
        "one effect, margin >= 50": lambda r, m: (
            r["kind"] == "single" and m >= NAMEABLE
        ),
        "one effect, margin < 50": lambda r, m: r["kind"] == "single" and m < NAMEABLE,
        "two effects, margins >= 50": lambda r, m: (
            r["kind"] == "pair" and m >= NAMEABLE
        ),
        "two effects, a margin < 50": lambda r, m: r["kind"] == "pair" and m < NAMEABLE,
        "taken out, margin >= 50": lambda r, m: r["kind"] == "hidden" and m >= NAMEABLE,
        "taken out, margin < 50": lambda r, m: r["kind"] == "hidden" and m < NAMEABLE,
        "outside, margin >= 50": lambda r, m: r["kind"] == "outside" and m >= NAMEABLE,
        "outside, margin < 50": lambda r, m: r["kind"] == "outside" and m < NAMEABLE,
    }
    return {
        name: [r for r, m in zip(runs, margins, strict=True) if test(r, m)]
        for name, test in kinds.items()
    }
