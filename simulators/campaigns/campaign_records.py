# SPDX-License-Identifier: MIT
"""Two-body hammer campaigns with hidden effects, and their truth."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.detectability.expected_margin import (
    Margin,
    MarginScale,
    expected_margin,
    first_order_margin,
    margin_scale,
)
from jointbench.simulators.hidden.campaign_design import CampaignDesign, draw_design
from jointbench.simulators.hidden.campaign_response import simulate_records
from jointbench.simulators.hidden.campaign_sampling import FORCE_NOISE, SAMPLES
from jointbench.simulators.hidden.effect_draws import (
    FAMILIES,
    OUTSIDE_CATALOGUE,
    draw_effect,
    require_effect,
    resize_effect,
    specimen_scales,
)
from jointbench.simulators.hidden.hidden_effects import HiddenEffect
from jointbench.simulators.hidden.hit_deviations import ScatterWays

MARGIN_RANGE = (1.0, 1e4)
_CLOSE = 0.15  # relative tolerance of the size of an effect
_MOST_SIZES = 6
_FAR = 3.0  # ratio of margins at which refitted rivals require another size
_MORE_SIZES = 4


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedCampaign:
    """A simulated campaign and its truth.

    Attributes:
        design: specimen, hits and noise.
        effects: hidden ones.
        margins: best possible margin of each effect, same order; empty if not
            calculated.
        force: hammer force [N], shape (n_records, n).
        acceleration: of base and top [m/s^2], shape (n_records, 2, n).
    """

    design: CampaignDesign
    effects: tuple[HiddenEffect, ...]
    margins: tuple[Margin, ...]
    force: FloatArray
    acceleration: FloatArray

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        count = len(self.design.conditions)
        require_shape("force", self.force, (count, SAMPLES))
        require_shape("acceleration", self.acceleration, (count, 2, SAMPLES))
        freeze(self, "force", "acceleration")

    @property
    def truth(self) -> tuple[str, ...]:
        """Names an analyst should find: of the catalogue, `unknown`, or `none`."""
        names = tuple(
            "unknown" if effect.name in OUTSIDE_CATALOGUE else effect.name
            for effect in self.effects
        )
        return names or ("none",)


def make_campaign(
    seed: int,
    *,
    effects: Sequence[str | HiddenEffect] = (),
    margin: float | tuple[float, float] = MARGIN_RANGE,
    size: float | None = None,
    grid: str | None = None,
    noise: float | None = None,
    hit_scatter: float = 0.0,
    ways: ScatterWays | None = None,
) -> SimulatedCampaign:
    """Draw a campaign with hidden effects.

    Args:
        seed: of all draws.
        effects: names, whose parameters are drawn, or complete effects; each name is
            sized alone, without the others.
        margin: expected margin of each named effect [-], or a range to draw it from
            log-uniformly.
        size: share of the largest physical size [-] instead of a margin.
        grid: of hits, one of `GRIDS`; None draws it.
        noise: of each acceleration [m/s^2]; None draws it.
        hit_scatter: relative standard deviation between hits [-]; 0.001 to 0.002 is a
            good operator.
        ways: further scatter of the hits; None for none.

    Returns:
        The campaign. An effect that cannot reach its margin at a physical size has the
        largest size; `margins` holds the result.

    Raises:
        UsageError: an effect is unknown, or named twice.
    """
    names = [each if isinstance(each, str) else each.name for each in effects]
    if len(set(names)) < len(names):
        raise UsageError(f"effects {names} name one twice; hide each of them once")
    for name in names:
        require_effect(name)
    design = draw_design(
        seed, grid=grid, noise=noise, hit_scatter=hit_scatter, ways=ways
    )
    hidden: tuple[HiddenEffect, ...] = ()
    margins: tuple[Margin, ...] = ()
    if effects:
        scale = margin_scale(design)
        rng = np.random.default_rng([seed, 12])
        pairs = [_hide(scale, each, margin, size, rng) for each in effects]
        hidden = tuple(effect for effect, _ in pairs)
        margins = tuple(known or expected_margin(scale, e) for e, known in pairs)
    force, acceleration = noisy(design, *simulate_records(design, hidden))
    return SimulatedCampaign(design, hidden, margins, force, acceleration)


def quick_campaign(
    seed: int,
    *,
    effects: Sequence[str] = (),
    size: float = 0.3,
    grid: str | None = None,
    noise: float | None = None,
    hit_scatter: float = 0.0,
    ways: ScatterWays | None = None,
) -> SimulatedCampaign:
    """Draw a campaign as `make_campaign` does, without margins.

    Margins take ten times as long as the records.

    Args:
        seed: of all draws.
        effects: names, whose parameters are drawn.
        size: share of the largest physical size of each effect [-].
        grid: of hits, one of `GRIDS`; None draws it.
        noise: of each acceleration [m/s^2]; None draws it.
        hit_scatter: relative standard deviation between hits [-].
        ways: further scatter of the hits; None for none.

    Raises:
        UsageError: an effect is unknown, or named twice.
    """
    if len(set(effects)) < len(effects):
        raise UsageError(f"effects {effects} name one twice; hide each of them once")
    design = draw_design(
        seed, grid=grid, noise=noise, hit_scatter=hit_scatter, ways=ways
    )
    rng = np.random.default_rng([seed, 12])
    scales = specimen_scales(design)
    hidden = tuple(
        resize_effect(draw_effect(name, scales, rng), size) for name in effects
    )
    force, acceleration = noisy(design, *simulate_records(design, hidden))
    return SimulatedCampaign(design, hidden, (), force, acceleration)


def campaign_noise_free(
    campaign: SimulatedCampaign, *, with_effects: bool = True
) -> tuple[FloatArray, FloatArray]:
    """Return the noise-free records of a campaign.

    Args:
        campaign: the campaign.
        with_effects: False for the base model at its true values.

    Returns:
        Forces [N], shape (n_records, n), and accelerations [m/s^2], shape
        (n_records, 2, n).
    """
    return simulate_records(campaign.design, campaign.effects if with_effects else ())


def size_to_margin(
    scale: MarginScale, largest: HiddenEffect, wanted: float
) -> HiddenEffect:
    """Reduce an effect to a wanted expected margin.

    Args:
        scale: the design, prepared.
        largest: the effect at its largest.
        wanted: expected margin [-].

    Returns:
        The effect, within 15 % of the first-order margin, and mostly within a factor of
        3 of the margin with refitted rivals; or `largest`.
    """
    return _sized(scale, largest, wanted)[0]


def _sized(
    scale: MarginScale, largest: HiddenEffect, wanted: float
) -> tuple[HiddenEffect, Margin | None]:
    """Return the effect at its size, with its margin if known already."""
    if not FAMILIES[largest.name].resizable:
        return largest, None
    share = _first_share(scale, largest, wanted)
    tried: list[tuple[float, float]] = []
    best: tuple[float, HiddenEffect, Margin] | None = None
    for _ in range(_MORE_SIZES):
        sized = resize_effect(largest, share)
        known = expected_margin(scale, sized)
        missing = float(np.log(wanted / max(known.margin, 1e-12)))
        if best is None or abs(missing) < best[0]:
            best = abs(missing), sized, known
        if best[0] < np.log(_FAR) or (share == 1.0 and missing > 0):
            break
        tried.append((float(np.log(share)), missing))
        share = min(1.0, float(np.exp(_next_size(tried))))
    return (largest, None) if best is None else best[1:]


def _next_size(tried: Sequence[tuple[float, float]]) -> float:
    """Return the log of the next share to try, from logs of shares and of what misses.

    Between two sizes, one too small and one too large, by interpolation; a rival may
    begin to follow an effect at some size, so that the margin leaps.
    """
    small = max((t for t in tried if t[1] > 0), default=None)
    large = min((t for t in tried if t[1] < 0), default=None)
    if small is not None and large is not None and small[0] < large[0]:
        part = small[1] / (small[1] - large[1])
        return small[0] + part * (large[0] - small[0])
    # Between first-order and second-order growth.
    (share, missing), power = tried[-1], 3.0
    if len(tried) > 1 and tried[-2][0] != share:
        slope = (tried[-2][1] - missing) / (share - tried[-2][0])
        power = float(np.clip(slope, 1.0, 5.0))
    return share + float(np.clip(missing / power, -3.0, 3.0))


def _first_share(scale: MarginScale, largest: HiddenEffect, wanted: float) -> float:
    """Return the share of the size with the wanted first-order margin."""
    share, power = 0.01, 2.0
    known: list[tuple[float, float]] = []
    for _ in range(_MOST_SIZES):
        margin = first_order_margin(scale, resize_effect(largest, share)).margin
        if abs(np.log(max(margin, 1e-12) / wanted)) < _CLOSE:
            break
        known.append((np.log(share), np.log(max(margin, 1e-12))))
        if len(known) > 1:
            (first, low), (second, high) = known[-2:]
            # Small changes grow as the square; a delay that a filter can mimic, as
            # the fourth power.
            slope = (high - low) / (second - first) if second != first else power
            power = float(np.clip(slope, 1.0, 5.0))
        step = np.log(wanted / max(margin, 1e-12)) / power
        share = min(1.0, share * float(np.exp(np.clip(step, -5.0, 5.0))))
        if share == 1.0 and known[-1][0] == 0.0:
            break
    return share


def _hide(
    scale: MarginScale,
    effect: str | HiddenEffect,
    margin: float | tuple[float, float],
    size: float | None,
    rng: np.random.Generator,
) -> tuple[HiddenEffect, Margin | None]:
    if isinstance(effect, HiddenEffect):
        return effect, None
    largest = draw_effect(effect, scale.scales, rng)
    if size is not None:
        return resize_effect(largest, size), None
    low, high = margin if isinstance(margin, tuple) else (margin, margin)
    wanted = float(np.exp(rng.uniform(np.log(low), np.log(high))))
    return _sized(scale, largest, wanted)


def noisy(
    design: CampaignDesign, force: FloatArray, acceleration: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Add the white noise of the sensors."""
    rng = np.random.default_rng([design.seed, 13])
    force_noise = FORCE_NOISE * design.noise * rng.standard_normal(force.shape)
    noise = design.noise * rng.standard_normal(acceleration.shape)
    return force + force_noise, acceleration + noise
