# SPDX-License-Identifier: MIT
"""Say what a misfit looks like, in sentences with numbers, and what to do about it."""

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.evidence_facts import Facts
from jointbench.analysis.gap.diagnosis.level_evidence import LevelScaling
from jointbench.analysis.gap.diagnosis.location import Relative
from jointbench.analysis.gap.model.evidence_records import DirectedTest, Wishes
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench

ODD, EVEN = "cubic_stiffness", "quadratic_stiffness"


def describe(
    bench: LumpedBench,
    residual: FloatArray,
    relative: Relative,
    facts: Facts,
    wishes: Wishes | None,
    tests: Sequence[DirectedTest],
) -> tuple[str, ...]:
    """Say what a misfit looks like, for somebody who must think of its cause.

    Args:
        bench: measurement and noise.
        residual: whitened, shape (n_records, n_channels, n_samples).
        relative: misfit over response by view and slice [-].
        facts: what is known of the misfit.
        wishes: of the records for the joint, or None.
        tests: directed tests of the base.
    """
    lines = [
        _level_line(bench, facts),
        _channel_line(relative["output"], facts),
        _phase_line(bench, residual),
    ]
    if facts.guessed and facts.scaling is not LevelScaling.PROPORTIONAL:
        lines.append(symmetry(tests))
    if wishes is not None:
        lines += _wish_lines(wishes, facts)
    return tuple(line for line in lines if line)


def advise(bench: LumpedBench, facts: Facts) -> str:
    """Say what would bring light into a misfit that no effect explains.

    Args:
        bench: measurement and noise.
        facts: what is known of the misfit.
    """
    if bench.campaign.continuous:
        return "shake at levels over a factor of 10; then try a law of your own"
    if np.unique(bench.campaign.level).size < 2:
        return "hit at four levels over a factor of 30: one level cannot tell causes"
    if facts.scaling is LevelScaling.UNTOLD:
        return "hit harder, or average more repeats: the noise hides the softer hits"
    if facts.scaling is LevelScaling.CHANGES:
        return (
            "hit at levels in between and from the other side, which tells even from "
            "odd laws; then try a law of your own with --effects"
        )
    if facts.uneven:
        return f"swap sensor {facts.uneven} with another, or move it, and hit again"
    return "hit at more points and preloads; look for a part that the model leaves out"


def _level_line(bench: LumpedBench, facts: Facts) -> str:
    if bench.campaign.continuous:
        return ""
    if np.unique(bench.campaign.level).size < 2:
        return "level: seen at one level only; hit harder and softer"
    if not facts.levels:
        return "level: the noise hides whether softer hits show it; hit harder"
    recur = ", ".join(f"{100 * f.share:.0f} % at {f.level:g} N" for f in facts.levels)
    return (
        "level: with the base fitted to the softer hits, the misfit of the hardest, "
        f"scaled with the force, recurs in softer ones by {recur}; {_cause(facts)}"
    )


def _cause(facts: Facts) -> str:
    """Say how the misfit goes with the hit, and what it tells where the cause is open.

    A law that is not linear is so to first order about its preload, so that a misfit
    in proportion to the hit rules none out.
    """
    seen = "in proportion to the hit"
    if facts.seen is not LevelScaling.PROPORTIONAL:
        seen = f"not {seen}"
    if facts.guessed and facts.seen is LevelScaling.PROPORTIONAL:
        return f"{seen}, so the cause is linear over this travel"
    if facts.guessed:
        return f"{seen}, so the cause depends on the level, or on when a hit was made"
    if facts.seen is facts.scaling:
        return seen
    return f"{seen}, unlike what the named effects do by themselves"


def _channel_line(slices: Mapping[str, float], facts: Facts) -> str:
    if len(slices) < 2:
        return ""
    words = ", ".join(f"{name} {100 * x:.2g} %" for name, x in slices.items())
    line = f"channel: misfit over response {words}"
    if not facts.guessed:
        return line
    if facts.uneven:
        return f"{line}; uneven: suspect that sensor or the body it sits on"
    return f"{line}; alike, so it is in the structure rather than in one sensor"


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


def _wish_lines(wishes: Wishes, facts: Facts) -> list[str]:
    lines = [
        "joint: a stiffness and damping of its own for each record would take "
        f"{100 * wishes.share:.0f} % of the misfit"
    ]
    if wishes.share < DIAGNOSIS.taken_share:
        more = ", so more than those is at work" if facts.guessed else ""
        return [lines[0] + more]
    views = [
        ("level", wishes.level, wishes.preload),
        ("preload", wishes.preload, wishes.level),
    ]
    if facts.scaling is LevelScaling.PROPORTIONAL:
        views = views[1:]
    for word, values, sd in (
        ("stiffness", wishes.stiffness[:, 0], wishes.stiffness_sd[:, 0]),
        ("damping", wishes.damping[:, 0], wishes.damping_sd[:, 0]),
    ):
        for view, x, other in views:
            alike = _alike(x, other)
            line = _trend(word, view, x[alike], values[alike], sd[alike])
            lines += [line] if line else []
    return lines


def _alike(x: FloatArray, other: FloatArray) -> BoolArray:
    """Return the records whose other condition was met at every x.

    Else a second preload that only soft hits met would be taken for the cause of what
    the hard ones do.
    """
    met = [set(other[x == value].tolist()) for value in np.unique(x)]
    return np.isin(other, sorted(set.intersection(*met)))


def _trend(word: str, view: str, x: FloatArray, y: FloatArray, sd: FloatArray) -> str:
    """Say how a wish goes from the lowest to the highest x, where that is clear."""
    at = np.unique(x)
    if at.size < 2:
        return ""
    weight = 1.0 / np.maximum(sd, 1e-12) ** 2
    means = [float(np.average(y[x == v], weights=weight[x == v])) for v in at]
    errors = [float(np.sqrt(1.0 / weight[x == v].sum())) for v in at]
    change = means[-1] - means[0]
    if (
        abs(change) < DIAGNOSIS.clear_sd * np.hypot(errors[0], errors[-1])
        or abs(change) < 1e-3
    ):
        return ""
    steps = np.diff(means)
    steady = np.all(steps > 0) or np.all(steps < 0)
    values = ", ".join(
        f"{100 * m:+.2g} % at {v:g} N"
        for v, m in itertools.islice(zip(at, means, strict=True), 6)
    )
    way = ("rises" if change > 0 else "falls") if steady else "changes"
    return f"joint {word} {way} with {view}: {values}"
