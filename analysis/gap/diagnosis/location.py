# SPDX-License-Identifier: MIT
"""Locate a residual: level, channel, frequency and condition, in one sentence.

A residual that is linear in the response is large wherever the response is large: its
chi2 grows with the level of the hit although the cause does not. Slices are therefore
also compared by residual over response, which is constant for a linear cause.
"""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.evidence_facts import UNEVEN, Facts
from jointbench.analysis.gap.diagnosis.level_evidence import LevelScaling
from jointbench.analysis.gap.model.campaign import TAIL
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench

_CONTROLLED = ("hit point", "preload")
Relative = dict[str, dict[str, float]]


def relative_residuals(bench: LumpedBench, residual: FloatArray) -> Relative:
    """Return residual over response by view and slice [-].

    Args:
        bench: measurement and noise.
        residual: whitened, shape (n_records, n_channels, n_samples).
    """
    size = bench.campaign.response / bench.noise.sigma[:, :, None]
    counted = counted_samples(bench)
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


def locate(bench: LumpedBench, residual: FloatArray, facts: Facts) -> str:
    """Return one sentence that locates the residual of a fit.

    Args:
        bench: measurement and noise.
        residual: whitened, shape (n_records, n_channels, n_samples).
        facts: what is known of it.
    """
    counted = counted_samples(bench)
    excess = np.maximum(np.sum(residual**2, axis=2) - counted, 0.0)
    total = max(float(excess.sum()), 1e-300)
    parts = [] if bench.campaign.continuous else [_level_words(bench, excess, facts)]
    channels = excess.sum(axis=0) / total
    top = int(np.argmax(channels))
    name = bench.campaign.model.channels[top].name
    several = channels.size > 1
    if several and channels[top] > DIAGNOSIS.mainly_share:
        parts.append(f"mainly on {name} ({100 * channels[top]:.0f} %)")
    elif several:
        parts.append("on all channels")
    low, high = _band(bench, residual)
    parts.append(f"at {low:.3g} to {high:.3g} Hz")
    signed = np.sum(residual**2, axis=2) - counted
    parts += [
        words for view in _CONTROLLED if (words := _uneven_words(bench, signed, view))
    ]
    verb = "is " if bench.campaign.continuous else ""
    return f"the residual {verb}{', '.join(parts)}"


def prior_deviation_words(bench: LumpedBench, base: Fit) -> str:
    """State that only the prior deviation of a base parameter shows the gap.

    Args:
        bench: measurement and noise.
        base: fit without effects, which meets the records but not its priors.
    """
    deviations = base.prior_deviations
    worst = int(np.argmax(np.abs(deviations)))
    return (
        "the base model meets the records nearly within their noise, but only with "
        f"{bench.base_names[worst]} {deviations[worst]:+.1f} sd from its nominal value"
    )


def _level_words(bench: LumpedBench, excess: FloatArray, facts: Facts) -> str:
    words = [x["level"] for x in bench.blocks.labels]
    shares = {k: float(excess[rows].sum()) for k, rows in _rows_of(words).items()}
    total = max(sum(shares.values()), 1e-300)
    top = max(shares, key=lambda key: shares[key])
    held = f"{100 * shares[top] / total:.0f} % of it at {top}"
    if len(shares) == 1:
        return "was measured at one level only"
    if facts.scaling is LevelScaling.UNDETERMINED:
        return f"is largest at {top} ({held})"
    if facts.scaling is LevelScaling.PROPORTIONAL:
        return "is proportional to the hit at every level"
    size = facts.levels[0].size
    if size < DIAGNOSIS.growth_ratio:
        return f"grows with level ({held})"
    if size > 1.0 / DIAGNOSIS.growth_ratio:
        return f"decreases with level, relative to the hit ({held})"
    return f"changes shape with level ({held})"


def _response_power(bench: LumpedBench) -> FloatArray:
    size = bench.campaign.response / bench.noise.sigma[:, :, None]
    return np.asarray(np.sum(size**2, axis=(1, 2)))


def _matched(bench: LumpedBench, names: Sequence[str]) -> list[list[int]]:
    """Return the records that agree in the views of those names."""
    keys = ["|".join(x[name] for name in names) for x in bench.blocks.labels]
    return list(_rows_of(keys).values())


def _band(bench: LumpedBench, residual: FloatArray) -> tuple[float, float]:
    """Return the narrowest band that holds most of the excess [Hz]."""
    n, rate = residual.shape[2], bench.campaign.sample_rate
    power = np.abs(np.fft.rfft(residual, axis=2)) ** 2 / max(counted_samples(bench), 1)
    excess = np.maximum(np.sum(power - 1.0, axis=(0, 1)), 0.0)
    excess[0] = 0.0
    total = np.cumsum(excess)
    want = DIAGNOSIS.band_share * total[-1]
    ends = np.searchsorted(total, np.concatenate([[0.0], total[:-1]]) + want)
    ends = np.where(ends < n // 2, ends, 10 * n)
    first = int(np.argmin(ends - np.arange(ends.size)))
    last = min(int(ends[first]), n // 2)
    return first * rate / n, (last + 1) * rate / n


def most_significant_view(
    bench: LumpedBench, residual: FloatArray, facts: Facts
) -> str:
    """Return the view in which a residual is most significant.

    Args:
        bench: measurement and noise.
        residual: whitened, shape (n_records, n_channels, n_samples).
        facts: what is known of the residual.
    """
    if facts.scaling is LevelScaling.CHANGES:
        return "level"
    excess = np.sum(residual**2, axis=2) - counted_samples(bench)
    ratios = {view: _unevenness(bench, excess, view)[0] for view in _CONTROLLED}
    top = max(ratios, key=lambda view: ratios[view])
    return top if ratios[top] > UNEVEN else "frequency"


def counted_samples(bench: LumpedBench) -> int:
    """Return how many samples of a record carry weight."""
    return int(bench.campaign.response.shape[2]) - TAIL - bench.campaign.lead


def _unevenness(bench: LumpedBench, excess: FloatArray, view: str) -> tuple[float, str]:
    """Return the ratio of residual over response, all other conditions equal.

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
            noise = 3.0 * float(np.sqrt(2.0 * len(rows) * counted_samples(bench)))
            low[word] = max(own[rows].sum() - noise, 0.0) / power[rows].sum()
            high[word] = (max(own[rows].sum(), 0.0) + noise) / power[rows].sum()
        word = max(low, key=lambda key: low[key])
        ratio = float(np.sqrt(low[word] / min(high.values())))
        if ratio > best:
            best, top = ratio, word
    return best, top


def _uneven_words(bench: LumpedBench, excess: FloatArray, view: str) -> str:
    """Name the slice with a far larger residual over response, if any."""
    ratio, top = _unevenness(bench, excess, view)
    if ratio < UNEVEN:
        return ""
    where = f"hits on {top}" if view == "hit point" else f"preload {top}"
    return f"over {ratio:.2g} times stronger for {where}"


def condition_of(bench: LumpedBench, record: int) -> str:
    """Return hit point, level and preload of a record in words."""
    labels = bench.blocks.labels[record]
    if bench.campaign.continuous:
        return f"shaken at {labels['hit point']}, rms level {labels['level']}"
    return (
        f"hit on {labels['hit point']}, {labels['level']}, preload "
        + (labels["preload"])
    )
