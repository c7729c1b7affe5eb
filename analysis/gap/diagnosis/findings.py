# SPDX-License-Identifier: MIT
"""Describe the signature of a residual in sentences, and advise what to do."""

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.catalogue.nonlinear_effects import CUBIC, QUADRATIC
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.evidence_facts import Facts
from jointbench.analysis.gap.diagnosis.level_evidence import LevelScaling
from jointbench.analysis.gap.diagnosis.location import Relative
from jointbench.analysis.gap.model.evidence_records import DirectedTest, RecordEstimates
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench

ODD, EVEN = CUBIC.effect.name, QUADRATIC.effect.name


def describe(
    bench: LumpedBench,
    residual: FloatArray,
    relative: Relative,
    facts: Facts,
    estimates: RecordEstimates | None,
    tests: Sequence[DirectedTest],
) -> tuple[str, ...]:
    """Describe the signature of a residual for an engineer who seeks its cause.

    Args:
        bench: measurement and noise.
        residual: whitened, shape (n_records, n_channels, n_samples).
        relative: residual over response by view and slice [-].
        facts: what is known of the residual.
        estimates: joint estimates of single records, or None.
        tests: directed tests of the base.
    """
    lines = [
        _level_line(bench, facts),
        _channel_line(relative["output"], facts),
        _phase_line(bench, residual),
    ]
    if facts.guessed and facts.scaling is not LevelScaling.PROPORTIONAL:
        lines.append(symmetry(tests))
    if estimates is not None:
        lines += _record_lines(estimates, facts)
    return tuple(line for line in lines if line)


def advise(bench: LumpedBench, facts: Facts) -> str:
    """Advise what would clarify a residual that no effect explains.

    Args:
        bench: measurement and noise.
        facts: what is known of the residual.
    """
    if bench.campaign.continuous:
        return "shake at levels over a factor of 10; then try a user-defined effect"
    if np.unique(bench.campaign.level).size < 2:
        return (
            "hit at four levels over a factor of 30: one level cannot separate causes"
        )
    if facts.scaling is LevelScaling.UNDETERMINED:
        return "hit harder, or repeat more often: noise masks the softer hits"
    if facts.scaling is LevelScaling.CHANGES:
        return (
            "hit at intermediate levels and from the other side, which separates even "
            "from odd laws; then try a user-defined effect with --effects"
        )
    if facts.uneven:
        return f"swap sensor {facts.uneven} with another, or move it, and repeat"
    return "hit at more points and preloads; check for a part missing from the model"


def _level_line(bench: LumpedBench, facts: Facts) -> str:
    if bench.campaign.continuous:
        return ""
    if np.unique(bench.campaign.level).size < 2:
        return "level: measured at one level only; hit harder and softer"
    if not facts.levels:
        return "level: noise masks the softer hits; hit harder"
    recur = ", ".join(f"{100 * f.share:.0f} % at {f.level:g} N" for f in facts.levels)
    return (
        "level: with the base model fitted to the softer hits, the residual of the "
        f"hardest, scaled with the force, recurs in softer hits by {recur}; "
        f"{_cause(facts)}"
    )


def _cause(facts: Facts) -> str:
    """State how the residual scales with the hit, and what follows for the cause.

    A nonlinear law is linear to first order about its preload, so a residual
    proportional to the hit excludes none.
    """
    seen = "proportional to the hit"
    if facts.seen is not LevelScaling.PROPORTIONAL:
        seen = f"not {seen}"
    if facts.guessed and facts.seen is LevelScaling.PROPORTIONAL:
        return f"{seen}, so the cause is linear over this range of motion"
    if facts.guessed:
        return f"{seen}, so the cause depends on the level or on the order of the hits"
    if facts.seen is facts.scaling:
        return seen
    return f"{seen}, unlike the named effects taken alone"


def _channel_line(slices: Mapping[str, float], facts: Facts) -> str:
    if len(slices) < 2:
        return ""
    words = ", ".join(f"{name} {100 * x:.2g} %" for name, x in slices.items())
    line = f"channel: residual over response {words}"
    if not facts.guessed:
        return line
    if facts.uneven:
        return f"{line}; uneven: check that sensor and the body it is mounted on"
    return f"{line}; equal, so the cause is in the structure, not in one sensor"


def _phase_line(bench: LumpedBench, residual: FloatArray) -> str:
    """State which share of the residual falls into the pulse, not the ring-down."""
    if bench.campaign.continuous:
        return ""
    power = np.maximum(np.sum(residual**2 - 1.0, axis=(0, 1)), 0.0)
    total = max(float(power.sum()), 1e-300)
    during = float(power[: bench.time_gate[1]].sum()) / total
    return (
        f"time: {100 * during:.0f} % during the force pulse, the rest in the ring-down"
    )


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
    kind = (
        "odd (equal in tension and compression)"
        if odd > even
        else "even (different in tension and compression)"
    )
    return (
        f"symmetry: a cubic spring would explain {100 * odd:.0f} % of the residual, a "
        f"quadratic one {100 * even:.0f} %: mostly {kind}"
    )


def _record_lines(estimates: RecordEstimates, facts: Facts) -> list[str]:
    lines = [
        "joint: separate stiffness and damping for each record would explain "
        f"{100 * estimates.share:.0f} % of the residual"
    ]
    if estimates.share < DIAGNOSIS.taken_share:
        more = ", so another cause contributes" if facts.guessed else ""
        return [lines[0] + more]
    views = [
        ("level", estimates.level, estimates.preload),
        ("preload", estimates.preload, estimates.level),
    ]
    if facts.scaling is LevelScaling.PROPORTIONAL:
        views = views[1:]
    for word, values, sd in (
        ("stiffness", estimates.stiffness[:, 0], estimates.stiffness_sd[:, 0]),
        ("damping", estimates.damping[:, 0], estimates.damping_sd[:, 0]),
    ):
        for view, x, other in views:
            alike = _alike(x, other)
            line = _trend(word, view, x[alike], values[alike], sd[alike])
            lines += [line] if line else []
    return lines


def _alike(x: FloatArray, other: FloatArray) -> BoolArray:
    """Return the records whose other condition occurs at every x.

    Otherwise a second preload with soft hits only would be taken for the cause of
    what the hard hits show.
    """
    met = [set(other[x == value].tolist()) for value in np.unique(x)]
    return np.isin(other, sorted(set.intersection(*met)))


def _trend(word: str, view: str, x: FloatArray, y: FloatArray, sd: FloatArray) -> str:
    """Describe how an estimate changes from the lowest to the highest x, if clear."""
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
