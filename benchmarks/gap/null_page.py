# SPDX-License-Identifier: MIT
"""The page that `benchmarks/gap/null_bootstrap.py` makes of its runs."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.stats import binomtest

Run = dict[str, Any]
QUANTILES = (0.5, 0.9, 0.99, 0.995)
NOMINAL = 0.005
ROOM = 1.3
"""Factor on the threshold from which the engine searches for an effect."""

HEAD = """# False alarms of the gap engine

Made by `benchmarks/gap/null_bootstrap.py`. Simulated campaigns without a missing effect
are fitted. From each fitted base model (parent) whole campaigns are drawn, with channel
noise, propagated force noise, the estimated gain and settling of every hit, and newly
drawn nominal parameters. Base fit, noise estimate and all directed tests run on each
draw as on any campaign. Draw k of parent s has the seed [s, 2, k].

The responses are those of the first method; for each parent they were verified
by the second integrator: at most {apart:.1e} of a channel's peak apart, {chi2:.1e}
units of chi2 in a whole campaign.
"""
LIMIT = """
## The largest directed drop

"Linearised" is the basis of the engine's threshold: {linearised} draws of the maximum
of correlated chi2 variables from the directions themselves. "Full" is the largest drop
of the drawn campaigns. The threshold is the engine's own for that draw, at 99.5 %.
The statistic includes hum, which the linearised draws omit.

| grid | scatter | seed | n | linearised 50 / 90 / 99 / 99.5 % | full, same | \
over the threshold | over 1.3 x it |
|---|---|---|---|---|---|---|---|
"""
GLOBAL = """
## The global acceptance criterion

| seed | chi2/dof, mean | its sd | assumed sd | largest distance [sd] | rejected |
|---|---|---|---|---|---|
"""


def wilson(hits: int, count: int) -> tuple[float, float]:
    """Return the 95 % Wilson interval of a share [-]."""
    low, high = binomtest(hits, count).proportion_ci(method="wilson")
    return float(low), float(high)


def share(hits: int, count: int) -> str:
    """Return a count with its share and interval [%]."""
    low, high = wilson(hits, count)
    return f"{hits} ({100 * hits / count:.1f} %, {100 * low:.1f} to {100 * high:.1f})"


def over(draws: Sequence[Run], room: float = 1.0) -> int:
    """Return how many draws lie above `room` times their threshold."""
    return sum(draw["largest"] > room * draw["threshold"] for draw in draws)


def page(runs: Sequence[Run]) -> str:
    """Return the page of all runs."""
    heads = [run for run in runs if run["draw"] < 0]
    draws = {
        head["seed"]: [r for r in runs if r["seed"] == head["seed"] and r["draw"] >= 0]
        for head in heads
    }
    heads = [head for head in heads if draws[head["seed"]]]
    text = HEAD.format(
        apart=max(head["apart"] for head in heads),
        chi2=max(head["chi2_apart"] for head in heads),
    )
    text += "\n## In short\n\n" + _pooled(heads, draws)
    text += LIMIT.format(linearised="20,000")
    text += "".join(_limit_row(head, draws[head["seed"]]) for head in heads)
    text += GLOBAL
    text += "".join(_global_row(head, draws[head["seed"]]) for head in heads)
    text += "\n## What widens the full distribution\n\n"
    return text + _force_noise(heads) + _scatter(heads, draws) + _noise_estimate(draws)


def _quantiles(values: Sequence[float]) -> str:
    return " / ".join(f"{q:.4g}" for q in values)


def _limit_row(head: Run, draws: Sequence[Run]) -> str:
    largest = np.quantile([draw["largest"] for draw in draws], QUANTILES)
    return (
        f"| {head['grid']} | {100 * head['scatter']:.2g} % | {head['seed']} | "
        f"{len(draws)} | {_quantiles(head['linearised'])} | {_quantiles(largest)} | "
        f"{share(over(draws), len(draws))} | "
        f"{share(over(draws, ROOM), len(draws))} |\n"
    )


def _sd_of_chi2(draws: Sequence[Run]) -> float:
    return float(np.std([draw["chi2_per_dof"] for draw in draws], ddof=1))


def _global_row(head: Run, draws: Sequence[Run]) -> str:
    chi2 = np.array([draw["chi2_per_dof"] for draw in draws])
    assumed = head["noise_sd"]
    refused = sum(bool(draw["reason"]) for draw in draws)
    return (
        f"| {head['seed']} | {chi2.mean():.4f} | {_sd_of_chi2(draws):.4f} | "
        f"{assumed:.4f} | {np.abs(chi2 - 1).max() / assumed:.1f} | "
        f"{share(refused, len(draws))} |\n"
    )


def _pooled(heads: Sequence[Run], draws: dict[int, list[Run]]) -> str:
    """Return limit and criterion pooled over all parents."""
    lines = []
    for words, wanted in (("without", False), ("with", True)):
        mine = [
            draw
            for head in heads
            if (head["scatter"] > 0) is wanted
            for draw in draws[head["seed"]]
        ]
        if not mine:
            continue
        count = over(mine)
        low, high = wilson(count, len(mine))
        verdict = (
            "the limit is consistent"
            if low <= NOMINAL <= high
            else f"the limit is too {'low' if low > NOMINAL else 'high'}"
        )
        needed = np.quantile([d["largest"] / d["threshold"] for d in mine], 0.995)
        above = Counter(
            d["which"].split("@")[0] for d in mine if d["largest"] > d["threshold"]
        )
        names = ", ".join(f"{name} {k}" for name, k in above.most_common()) or "none"
        lines.append(
            f"- Campaigns {words} scatter from hit to hit: of {len(mine)} draws, "
            f"{share(count, len(mine))} are over the threshold, 0.5 % is expected: "
            f"{verdict}. "
            f"The full 99.5 % quantile is {needed:.3g} times the threshold. "
            f"Over {ROOM} times the threshold, where the search begins: "
            f"{share(over(mine, ROOM), len(mine))}. Effects over it: {names}.\n"
        )
    ratio = np.median([_sd_of_chi2(draws[h["seed"]]) / h["noise_sd"] for h in heads])
    lines.append(
        f"- Global criterion: chi2/dof scatters by {ratio:.2f} times the assumed sd "
        "(median of the parents).\n"
    )
    return "".join(lines)


def _force_noise(heads: Sequence[Run]) -> str:
    """Return how much of the force's noise the whitening leaves in the scores."""
    widest = [head["score_variance"] for head in heads if "score_variance" in head]
    if not widest:
        return ""
    return (
        "- Noise of the force: propagated sample by sample inside the time gate, it "
        "gives the widest score of a parent a variance of at least "
        f"{min(widest):.2f} to {max(widest):.2f} where the linearised draws have 1. "
        "The whitening omits the upper modes, which its smooth shapes do not excite.\n"
    )


def _scatter(heads: Sequence[Run], draws: dict[int, list[Run]]) -> str:
    """Return how often too little scatter was found, and what that does."""
    low, above, count = 0, 0, 0
    for head in heads:
        if head["scatter"] <= 0:
            continue
        for draw in draws[head["seed"]]:
            count += 1
            pairs = zip(draw["found_scatter"], head["found_scatter"], strict=True)
            if any(own < 0.5 * true for own, true in pairs):
                low += 1
                above += draw["largest"] > ROOM * draw["threshold"]
    if not count:
        return ""
    return (
        f"- Scatter from hit to hit: in {low} of {count} draws with scatter repeats "
        "had a scatter below half of the drawn value; of these "
        f"{above} are over {ROOM} times the threshold.\n"
    )


def _noise_estimate(draws: dict[int, list[Run]]) -> str:
    """Return how much of the difference the noise estimate makes."""
    known = [d for mine in draws.values() for d in mine if "known" in d]
    if not known:
        return ""
    apart = [d["largest"] - d["known"]["largest"] for d in known]
    low, middle, high = np.quantile(apart, [0.05, 0.5, 0.95])
    return (
        f"- Noise estimate: {len(known)} draws without scatter were judged again with "
        "their true noise in place of the estimate. The "
        f"estimate moves the largest drop by {middle:.2f} in the median, and by "
        f"{low:.2f} to {high:.2f} in 90 % of them.\n"
    )
