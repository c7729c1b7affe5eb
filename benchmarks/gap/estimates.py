# SPDX-License-Identifier: MIT
"""Of right names: sites, parameters, force curves, gap and prior deviation."""

from collections.abc import Sequence

import numpy as np
from outcomes import Run, named_by, share_text, word_of

FRICTION = ("jenkins", "iwan", "bouc_wen")


def right_singles(runs: Sequence[Run]) -> list[Run]:
    """Return the singles that were named right."""
    return [r for r in runs if r["kind"] == "single" and word_of(r) == "right"]


def site_share(runs: Sequence[Run]) -> str:
    """Return how often the site of a right name is right."""
    mine = [r for r in runs if r["kind"] in {"single", "pair"}]
    mine = [r for r in mine if word_of(r) == "right"]
    hits = sum(
        dict(named_by(r)) == dict(zip(r["truth"], r["sites"], strict=True))
        for r in mine
    )
    return share_text(hits, len(mine))


def coverage(runs: Sequence[Run]) -> list[str]:
    """Return, effect by effect, how often 2 sd hold the true parameters."""
    inside: dict[str, list[bool]] = {}
    for run in right_singles(runs):
        effect = run["found"]["effects"][0]
        if effect["name"] in FRICTION:
            continue
        for name, estimate in effect["parameters"].items():
            truth = run["parameters"][0].get(name)
            if truth is None or not np.isfinite(estimate["sd"]):
                continue
            off = abs(estimate["value"] - truth) / max(estimate["sd"], 1e-300)
            inside.setdefault(run["truth"][0], []).append(off <= 2.0)
    every = [x for row in inside.values() for x in row]
    lines = ["| effect | within 2 sd |", "|---|---|"]
    lines += [
        f"| {name} | {share_text(sum(row), len(row))} |"
        for name, row in sorted(inside.items())
    ]
    return [*lines, f"| all | {share_text(sum(every), len(every))} |"]


def force_curves(runs: Sequence[Run]) -> str:
    """Return how well the curves of hysteretic laws come out, where they were named.

    What a law takes off the elastic force on first loading, up to the largest motion
    of the joint, against the truth; the largest difference over the largest value.
    """
    errors = [
        error_of(run)
        for run in right_singles(runs)
        if run["found"]["effects"][0]["name"] in FRICTION
    ]
    if not errors:
        return "none was named"
    inside = sum(e <= 0.1 for e in errors)
    return (
        f"median error {100 * np.median(errors):.1f} %; within 10 %: "
        f"{share_text(inside, len(errors))}"
    )


def error_of(run: Run) -> float:
    """Return the error of one force curve [-]."""
    from jointbench.simulators.hidden.campaign_design import draw_design
    from jointbench.simulators.hidden.effect_draws import specimen_scales

    effect = run["found"]["effects"][0]
    named = {name: one["value"] for name, one in effect["parameters"].items()}
    travel = specimen_scales(draw_design(run["seed"])).elongation
    r = np.linspace(0.0, travel, 200)
    truth = softening(effect["name"], run["parameters"][0], r)
    error = np.abs(softening(effect["name"], named, r) - truth).max()
    return float(error / np.abs(truth).max())


def softening(name: str, p: dict[str, float], r: np.ndarray) -> np.ndarray:
    """Return elastic force less that of a hysteretic law on first loading [N]."""
    from jointbench.analysis.gap.response.slider_integration import slider_tables

    if name == "iwan":
        edges = np.linspace(0, 1, int(p.get("sliders", 14)) + 1)
        power = p["chi"] + 2
        shares = np.diff(edges**power)
        centres = np.diff(edges ** (power + 1)) / shares * power / (power + 1)
        weights, slips = p["kt"] * shares, p["phimax"] * centres
    elif name == "jenkins":
        weights, slips = np.array([p["kt"]]), np.array([p["Fs"] / p["kt"]])
    else:
        yielding = p["zy"] / (p["b"] + p["g"]) ** (1 / p["n"])
        weights, slips = np.array([p["k"]]), np.array([yielding])
    tables, tops = slider_tables(1.0, 0.0, p.get("sharpness", p.get("n", 1.0)))
    grid = np.arange(tables.shape[1]) / tops[0]
    x = r[:, None] / slips
    force = np.interp(x, grid, tables[0], right=1.0) * slips
    return np.asarray(np.sum(weights * (r[:, None] - force), axis=1))


def shrinkage(runs: Sequence[Run]) -> str:
    """Return how much held-out gaps of 3 and more shrink under right names."""
    shrinks = [
        run["found"]["shrink"]
        for run in right_singles(runs)
        if run["found"]["gap_before"] >= 3.0
    ]
    if not shrinks:
        return "no gap of 3 or more"
    return (
        f"median {100 * np.median(shrinks):.1f} %, smallest {100 * min(shrinks):.1f} % "
        f"(n = {len(shrinks)})"
    )


def prior_deviations(runs: Sequence[Run]) -> str:
    """Return prior deviations of effects that only the priors show, above 5 sigma.

    Of six correct base values one is beyond 2 sigma in a quarter of all campaigns, so
    the value that deviated most is followed, and all values are counted as well.
    """
    rows = []
    for run in right_singles(runs):
        if run["truth"][0] not in {"added_mass", "gain_error"}:
            continue
        every = list(run["found"]["pulls"].values())
        most = max(every, key=lambda p: abs(p["before"]))
        if abs(most["before"]) > 5:
            rows.append((most, max(abs(p["after"]) for p in every)))
    if not rows:
        return "no prior deviation above 5 sigma"
    before = np.median([abs(most["before"]) for most, _ in rows])
    after = np.array([abs(most["after"]) for most, _ in rows])
    return (
        f"median {before:.1f} to {np.median(after):.2f} sigma; below 2 after: "
        f"{share_text(int(np.sum(after < 2)), len(rows))}; every base value below 2: "
        f"{share_text(sum(worst < 2 for _, worst in rows), len(rows))}"
    )


def fisher(runs: Sequence[Run]) -> str:
    """Return the stated sd over the Fisher bound, for effects of one parameter.

    The bound follows from the truth alone: what rho is to the whole effect, 1 is to
    one sd of its only parameter, with base and priors free to follow.
    """
    ratios = []
    for run in right_singles(runs):
        (estimate, *more) = run["found"]["effects"][0]["parameters"].values() or [None]
        if estimate is None or more or run["truth"][0] in FRICTION:
            continue
        ratios.append(estimate["sd"] * run["rho"][0] / abs(estimate["value"]))
    if not ratios:
        return "no effect of one parameter"
    return (
        f"median {np.median(ratios):.2f}, nine of ten below "
        f"{np.quantile(ratios, 0.9):.2f} (n = {len(ratios)})"
    )
