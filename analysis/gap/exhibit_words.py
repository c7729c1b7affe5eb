# SPDX-License-Identifier: MIT
"""Say where a misfit sits and what it looks like, in sentences with numbers.

A misfit that is linear in the response is large wherever the response is large: its
chi2 grows with the level of the hit although nothing in it does. So slices are also
compared by the misfit over the response, which a linear cause leaves alone.
"""

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.gap.exhibit_level import Recurrence, is_linear
from jointbench.analysis.gap.exhibit_records import DirectedTest, Wishes
from jointbench.analysis.gap.fit import Fit
from jointbench.analysis.gap.lumped import TAIL, LumpedBench

GROWS = 0.7
"""Size at the next lower level, over the hardest, below which a misfit grows."""
MAINLY = 0.6
UNEVEN = 2.0
"""Ratio of relative misfits from which a view is worth a word."""
BAND_SHARE = 0.8
CLEAR_SD = 4.0
"""Distance from 0 at which a wish of a record counts."""
TAKEN = 0.3
"""Share of the misfit that the joint's own numbers must take to be worth telling."""
CONTROLLED = ("hit point", "preload")
ODD, EVEN = "cubic_stiffness", "quadratic_stiffness"

Relative = dict[str, dict[str, float]]


def relative_misfits(bench: LumpedBench, residual: FloatArray) -> Relative:
    """Return misfit over response by view and slice [-].

    Args:
        bench: measurement and noise.
        residual: whitened, shape (n_records, n_channels, n_samples).
    """
    size = bench.campaign.response / bench.noise.sigma[:, :, None]
    counted = _counted(bench)
    excess = np.sum(residual**2, axis=2) - counted
    power = np.sum(size**2, axis=2)
    found: Relative = {}
    for name in bench.blocks.labels[0]:
        keys = [labels[name] for labels in bench.blocks.labels]
        found[name] = {
            key: _ratio(excess[rows], power[rows])
            for key, rows in _rows_of(keys).items()
        }
    found["output"] = {
        channel.name: _ratio(excess[:, i], power[:, i])
        for i, channel in enumerate(bench.campaign.model.channels)
    }
    return found


def _rows_of(keys: Sequence[str]) -> dict[str, list[int]]:
    return {
        key: [i for i, k in enumerate(keys) if k == key] for key in dict.fromkeys(keys)
    }


def _ratio(excess: FloatArray, power: FloatArray) -> float:
    return float(np.sqrt(max(excess.sum(), 0.0) / max(power.sum(), 1e-300)))


def locate(
    bench: LumpedBench, residual: FloatArray, levels: Sequence[Recurrence]
) -> str:
    """Return one sentence on where the misfit of a fit sits.

    Args:
        bench: measurement and noise.
        residual: whitened, shape (n_records, n_channels, n_samples).
        levels: recurrence at softer hits.
    """
    counted = _counted(bench)
    excess = np.maximum(np.sum(residual**2, axis=2) - counted, 0.0)
    total = max(float(excess.sum()), 1e-300)
    parts = [_level_words(bench, excess, levels)]
    channels = excess.sum(axis=0) / total
    top = int(np.argmax(channels))
    name = bench.campaign.model.channels[top].name
    several = channels.size > 1
    if several and channels[top] > MAINLY:
        parts.append(f"mainly on {name} ({100 * channels[top]:.0f} %)")
    elif several:
        parts.append("on all channels")
    low, high = _band(residual, bench.campaign.sample_rate)
    parts.append(f"at {low:.3g} to {high:.3g} Hz")
    signed = np.sum(residual**2, axis=2) - counted
    parts += [
        words for view in CONTROLLED if (words := _uneven_words(bench, signed, view))
    ]
    return "the misfit " + ", ".join(parts)


def pulled(bench: LumpedBench, base: Fit) -> str:
    """Say that the misfit hides in the base's own parameters.

    Args:
        bench: measurement and noise.
        base: fit without effects, which meets the records all but for its sheet.
    """
    worst = int(np.argmax(np.abs(base.pulls)))
    return (
        "the records are met to nearly their noise, but only with "
        f"{bench.base_names[worst]} pulled {base.pulls[worst]:+.1f} sd off its sheet"
    )


def _level_words(
    bench: LumpedBench, excess: FloatArray, levels: Sequence[Recurrence]
) -> str:
    words = [x["level"] for x in bench.blocks.labels]
    shares = {k: float(excess[rows].sum()) for k, rows in _rows_of(words).items()}
    total = max(sum(shares.values()), 1e-300)
    top = max(shares, key=lambda key: shares[key])
    held = f"{100 * shares[top] / total:.0f} % of it at {top}"
    if len(shares) == 1:
        return "was seen at one level only"
    if not levels:
        return f"is largest at {top} ({held})"
    if is_linear(levels):
        return "is in proportion to the hit at every level"
    size = levels[0].size
    if size < GROWS:
        return f"grows with level ({held})"
    if size > 1.0 / GROWS:
        return f"fades with level, relative to the hit ({held})"
    return f"changes its shape with level ({held})"


def _response_power(bench: LumpedBench) -> FloatArray:
    size = bench.campaign.response / bench.noise.sigma[:, :, None]
    return np.asarray(np.sum(size**2, axis=(1, 2)))


def _matched(bench: LumpedBench, names: Sequence[str]) -> list[list[int]]:
    """Return the records that agree in the views of those names."""
    keys = ["|".join(x[name] for name in names) for x in bench.blocks.labels]
    return list(_rows_of(keys).values())


def _band(residual: FloatArray, rate: float) -> tuple[float, float]:
    """Return the narrowest band that holds most of the excess [Hz]."""
    n = residual.shape[2]
    power = np.abs(np.fft.rfft(residual, axis=2)) ** 2 / n
    excess = np.maximum(np.sum(power - 1.0, axis=(0, 1)), 0.0)
    excess[0] = 0.0
    total = np.cumsum(excess)
    want = BAND_SHARE * total[-1]
    ends = np.searchsorted(total, np.concatenate([[0.0], total[:-1]]) + want)
    ends = np.where(ends < n // 2, ends, 10 * n)
    first = int(np.argmin(ends - np.arange(ends.size)))
    last = min(int(ends[first]), n // 2)
    return first * rate / n, (last + 1) * rate / n


def telling_view(
    bench: LumpedBench, residual: FloatArray, levels: Sequence[Recurrence]
) -> str:
    """Return the view in which a misfit stands out most.

    Args:
        bench: measurement and noise.
        residual: whitened, shape (n_records, n_channels, n_samples).
        levels: recurrence at softer hits.
    """
    if levels and not is_linear(levels):
        return "level"
    excess = np.sum(residual**2, axis=2) - _counted(bench)
    ratios = {view: _unevenness(bench, excess, view)[0] for view in CONTROLLED}
    top = max(ratios, key=lambda view: ratios[view])
    return top if ratios[top] > UNEVEN else "frequency"


def _counted(bench: LumpedBench) -> int:
    """Return how many samples of a record carry weight."""
    return int(bench.campaign.response.shape[2]) - TAIL - bench.campaign.lead


def _unevenness(bench: LumpedBench, excess: FloatArray, view: str) -> tuple[float, str]:
    """Return by how much misfit over response differs, all other conditions alike.

    Returns:
        A lower limit of the ratio [-], and the slice where it is largest.
    """
    others = tuple(n for n in ("level", "hit point", "preload") if n != view)
    own, power = excess.sum(axis=1), _response_power(bench)
    words = np.array([labels[view] for labels in bench.blocks.labels])
    best, top = 1.0, ""
    for group in _matched(bench, others):
        low: dict[str, float] = {}
        high: dict[str, float] = {}
        for word in dict.fromkeys(words[group].tolist()):
            rows = [k for k in group if words[k] == word]
            noise = 3.0 * float(np.sqrt(2.0 * len(rows) * _counted(bench)))
            low[word] = max(own[rows].sum() - noise, 0.0) / power[rows].sum()
            high[word] = (max(own[rows].sum(), 0.0) + noise) / power[rows].sum()
        word = max(low, key=lambda key: low[key])
        ratio = float(np.sqrt(low[word] / min(high.values())))
        if ratio > best:
            best, top = ratio, word
    return best, top


def _uneven_words(bench: LumpedBench, excess: FloatArray, view: str) -> str:
    """Say where misfit over response is far larger, all other conditions alike."""
    ratio, top = _unevenness(bench, excess, view)
    if ratio < UNEVEN:
        return ""
    where = f"hits on {top}" if view == "hit point" else f"preload {top}"
    return f"over {ratio:.2g} times stronger for {where}"


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
        _level_line(levels, several=np.unique(bench.campaign.level).size > 1),
        _channel_line(relative["output"]),
        _phase_line(bench, residual),
        "" if is_linear(levels) else _parity_line(tests),
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


def _level_line(levels: Sequence[Recurrence], *, several: bool) -> str:
    if not several:
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


def _parity_line(tests: Sequence[DirectedTest]) -> str:
    """Compare an odd with an even law in the joint, where both were tested."""
    best = dict.fromkeys((ODD, EVEN), 0.0)
    for test in tests:
        name = test.label.partition("@")[0]
        if name in best:
            best[name] = max(best[name], test.share)
    odd, even = best[ODD], best[EVEN]
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
            "joint: a stiffness and damping of its own for each hit would take only "
            f"{100 * wishes.share:.0f} % of the misfit: no joint that just differs"
        ]
    lines = [
        "joint: a stiffness and damping of its own for each hit would take "
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
