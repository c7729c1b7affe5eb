# SPDX-License-Identifier: MIT
"""Say what a misfit looks like, in sentences with numbers, and what to do about it."""

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.gap.exhibit_level import Recurrence, is_linear
from jointbench.analysis.gap.exhibit_records import DirectedTest, Wishes
from jointbench.analysis.gap.exhibit_where import UNEVEN, Relative
from jointbench.analysis.gap.lumped import LumpedBench

CLEAR_SD = 4.0
"""Distance from 0 at which a wish of a record counts."""
TAKEN = 0.3
"""Share of the misfit that the joint's own numbers must take to be worth telling."""
ODD, EVEN = "cubic_stiffness", "quadratic_stiffness"


def describe(
    bench: LumpedBench,
    residual: FloatArray,
    relative: Relative,
    levels: Sequence[Recurrence],
    wishes: Wishes | None,
    tests: Sequence[DirectedTest],
) -> tuple[str, ...]:
    """Say what a misfit looks like, for somebody who must think of its cause.

    Args:
        bench: measurement and noise.
        residual: whitened, shape (n_records, n_channels, n_samples).
        relative: misfit over response by view and slice [-].
        levels: recurrence at softer hits.
        wishes: of the records for the joint, or None.
        tests: directed tests of the base.
    """
    lines = [
        _level_line(bench, levels),
        _channel_line(relative["output"]),
        _phase_line(bench, residual),
        "" if is_linear(levels) else symmetry(tests),
    ]
    if wishes is not None:
        lines += _wish_lines(wishes)
    return tuple(line for line in lines if line)


def advise(bench: LumpedBench, relative: Relative, levels: Sequence[Recurrence]) -> str:
    """Say what would bring light into a misfit that no effect explains.

    Args:
        bench: measurement and noise.
        relative: misfit over response by view and slice [-].
        levels: recurrence at softer hits.
    """
    if bench.campaign.continuous:
        return "shake at levels over a factor of 10; then try a law of your own"
    if np.unique(bench.campaign.level).size < 2:
        return "hit at four levels over a factor of 30: one level cannot tell causes"
    if not levels:
        return "hit harder, or average more repeats: the noise hides the softer hits"
    if not is_linear(levels):
        return (
            "hit at levels in between and from the other side, which tells even from "
            "odd laws; then try a law of your own with --effects"
        )
    top = max(relative["output"], key=lambda name: relative["output"][name])
    if relative["output"][top] > UNEVEN * min(relative["output"].values()):
        return f"swap sensor {top} with another, or move it, and hit again"
    return "hit at more points and preloads; look for a part that the model leaves out"


def _level_line(bench: LumpedBench, levels: Sequence[Recurrence]) -> str:
    if bench.campaign.continuous:
        return ""
    if np.unique(bench.campaign.level).size < 2:
        return "level: seen at one level only; hit harder and softer"
    if not levels:
        return "level: the noise hides whether softer hits show it; hit harder"
    recur = ", ".join(f"{100 * f.share:.0f} % at {f.level:g} N" for f in levels)
    kind = "so the cause depends on amplitude"
    if is_linear(levels):
        kind = "so the cause is linear in the motion"
    return (
        "level: the misfit of the hardest hits, scaled with the force, recurs in "
        f"softer ones by {recur}; {kind}"
    )


def _channel_line(slices: Mapping[str, float]) -> str:
    if len(slices) < 2:
        return ""
    words = ", ".join(f"{name} {100 * x:.2g} %" for name, x in slices.items())
    top, least = max(slices.values()), min(slices.values())
    kind = "alike, so it is in the structure rather than in one sensor"
    if top > UNEVEN * max(least, 1e-12):
        kind = "uneven: suspect that sensor or the body it sits on"
    return f"channel: misfit over response {words}; {kind}"


def _phase_line(bench: LumpedBench, residual: FloatArray) -> str:
    """Say whether the misfit comes with the hit or in the ringing after it."""
    if bench.campaign.continuous:
        return ""
    power = np.maximum(np.sum(residual**2 - 1.0, axis=(0, 1)), 0.0)
    total = max(float(power.sum()), 1e-300)
    during = float(power[: bench.gate[1]].sum()) / total
    return f"time: {100 * during:.0f} % while the force acts, the rest in the ringing"


def symmetry(tests: Sequence[DirectedTest]) -> str:
    """Compare an odd with an even law in the joint; empty unless both were tested."""
    shares: dict[str, float] = {}
    for test in tests:
        name = test.label.partition("@")[0]
        shares[name] = max(shares.get(name, 0.0), test.share)
    if not {ODD, EVEN} <= shares.keys():
        return ""
    odd, even = shares[ODD], shares[EVEN]
    if max(odd, even) < 0.1:
        return ""
    kind = "odd (alike in push and pull)" if odd > even else "even (push unlike pull)"
    return (
        f"symmetry: a cubic spring would take {100 * odd:.0f} % of the misfit, a "
        f"quadratic one {100 * even:.0f} %: mostly {kind}"
    )


def _wish_lines(wishes: Wishes) -> list[str]:
    if wishes.share < TAKEN:
        return [
            "joint: a stiffness and damping of its own for each record would take only "
            f"{100 * wishes.share:.0f} % of the misfit, so more than those is at work"
        ]
    lines = [
        "joint: a stiffness and damping of its own for each record would take "
        f"{100 * wishes.share:.0f} % of the misfit"
    ]
    for word, values, sd in (
        ("stiffness", wishes.stiffness[:, 0], wishes.stiffness_sd[:, 0]),
        ("damping", wishes.damping[:, 0], wishes.damping_sd[:, 0]),
    ):
        for view, x, unit in (
            ("level", wishes.level, "N"),
            ("preload", wishes.preload, "N"),
        ):
            line = _trend(word, view, unit, x, values, sd)
            lines += [line] if line else []
    return lines


def _trend(
    word: str, view: str, unit: str, x: FloatArray, y: FloatArray, sd: FloatArray
) -> str:
    """Say how a wish goes from the lowest to the highest x, where that is clear."""
    at = np.unique(x)
    if at.size < 2:
        return ""
    weight = 1.0 / np.maximum(sd, 1e-12) ** 2
    means = [float(np.average(y[x == v], weights=weight[x == v])) for v in at]
    errors = [float(np.sqrt(1.0 / weight[x == v].sum())) for v in at]
    change = means[-1] - means[0]
    if abs(change) < CLEAR_SD * np.hypot(errors[0], errors[-1]) or abs(change) < 1e-3:
        return ""
    steps = np.diff(means)
    steady = np.all(steps > 0) or np.all(steps < 0)
    values = ", ".join(
        f"{100 * m:+.2g} % at {v:g} {unit}"
        for v, m in itertools.islice(zip(at, means, strict=True), 6)
    )
    way = ("rises" if change > 0 else "falls") if steady else "changes"
    return f"joint {word} {way} with {view}: {values}"
