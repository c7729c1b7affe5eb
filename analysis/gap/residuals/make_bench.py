# SPDX-License-Identifier: MIT
"""Make the bench of a campaign: candidates, time gate, scales and groups."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.catalogue.catalogue import (
    CATALOGUE,
    candidates_of,
    check_names,
)
from jointbench.analysis.gap.catalogue.probes import PROBES
from jointbench.analysis.gap.model.campaign import TAIL, Campaign
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.fit_records import Blocks
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.lumped_residual import gated_excitation
from jointbench.analysis.gap.residuals.noise_models import Noise
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.residuals.scatter_directions import scatter_directions
from jointbench.analysis.gap.residuals.scatter_record import no_scatter
from jointbench.analysis.gap.response.dynamic_stiffness import dynamic_stiffness, invert
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.analysis.gap.response.predict_records import motion, undamped


def make_bench(
    campaign: Campaign,
    *,
    without: frozenset[str] = frozenset(),
    entries: tuple[LumpedEffect, ...] = CATALOGUE,
    policy: Policy = STANDARD,
) -> LumpedBench:
    """Prepare a campaign for the engine.

    Args:
        campaign: measurement and model.
        without: names of effects to leave out of the catalogue.
        entries: the catalogue.
        policy: thresholds for its fits.

    Raises:
        UsageError: `without` holds a name that no entry has.
    """
    check_names(without, entries)
    entries = tuple(e for e in entries if e.effect.name not in without)
    time_gate, force_sigma = (0, campaign.force.shape[1]), 0.0
    if not campaign.continuous:
        time_gate, force_sigma = force_time_gate(campaign.force)
    excitation = gated_excitation(campaign, time_gate)
    records, channels, samples = campaign.response.shape
    quiet = max(time_gate[0], 16)
    sigma = np.sqrt(np.mean(campaign.response[:, :, :quiet] ** 2, axis=(0, 2)))
    floor = 1e-6 * np.abs(campaign.response).max()
    sigma = np.tile(np.maximum(sigma, floor), (records, 1))
    directions = scatter_directions(campaign)
    bench = LumpedBench(
        campaign=campaign,
        entries=entries,
        candidates=candidates_of(entries, campaign.model),
        probes=candidates_of(PROBES, campaign.model),
        excitation=excitation,
        time_gate=time_gate,
        noise=Noise(sigma, force_sigma, no_scatter(directions, records)),
        basis=np.zeros((records, 1, channels * samples)),
        shrink=np.zeros((records, 1, 1)),
        scales={},
        blocks=_blocks(campaign),
        short={},
        settled=None,
        policy=policy,
    )
    return replace(bench, scales=_scales(bench))


def force_time_gate(force: FloatArray) -> tuple[tuple[int, int], float]:
    """Return the samples that hold the hits, and the noise outside them [N]."""
    n = force.shape[1]
    sigma = float(np.std(force[:, n // 2 :]))
    strong = np.abs(force) > np.maximum(
        RESIDUALS.hit_noise_sd * sigma,
        RESIDUALS.hit_share * np.abs(force).max(axis=1, keepdims=True),
    )
    # A contact lasts several samples; a single one is a peak of the noise.
    strong[:, 1:-1] &= strong[:, :-2] | strong[:, 2:]
    where = np.flatnonzero(strong.any(axis=0))
    if where.size == 0 or np.ptp(where) > n // 2:
        return (0, n), 0.0
    padding = _padding(force, (int(where[0]), int(where[-1])), sigma)
    first = max(int(where[0]) - padding, 0)
    last = min(int(where[-1]) + padding, n)
    outside = np.concatenate([force[:, :first], force[:, last:]], axis=1)
    return (first, last), float(np.sqrt(np.mean(outside**2)))


def _padding(force: FloatArray, hit: tuple[int, int], sigma: float) -> int:
    """Return the least padding of the hits beyond which the force is noise.

    Each sample within the time gate adds its noise to the prediction, where it rings on
    in every mode; the ringing of the filter, which a time gate cuts off, is in
    proportion to the force. So the time gate of a noisy record is narrow.

    Args:
        force: of all records [N], shape (n_records, n).
        hit: first and last strong sample.
        sigma: noise of the force [N].
    """
    first, last = hit
    *narrow, widest = RESIDUALS.force_paddings
    for padding in narrow if sigma > 0.0 else ():
        before = force[:, max(first - widest, 0) : max(first - padding, 0)]
        after = force[:, last + padding : last + widest]
        beyond = np.concatenate([before, after], axis=1) / sigma
        excess = float(np.mean(beyond**2)) - 1.0 if beyond.size else np.inf
        if excess < RESIDUALS.padding_noise * np.sqrt(2.0 / beyond.size):
            return padding
    return widest


def _blocks(campaign: Campaign) -> Blocks:
    records, channels, samples = campaign.response.shape
    group = np.repeat(np.arange(records), channels * samples)
    labels = tuple(
        {
            "level": f"{level:.3g}" if campaign.continuous else f"{level:g} N",
            "hit point": f"{campaign.model.bodies[hit].name}",
            "preload": f"{preload:g} N",
            "order": f"{order:g}",
        }
        for level, hit, preload, order in zip(
            campaign.level, campaign.hit, campaign.preload, campaign.order, strict=True
        )
    )
    seen = samples - TAIL - campaign.lead
    white = campaign.repeatability is None
    return Blocks(
        group, labels, records * channels * seen, campaign.response.shape, white
    )


def _scales(bench: LumpedBench) -> dict[str, float]:
    """Return characteristic sizes at the nominal parameters, which scale starts."""
    model, excitation = bench.campaign.model, bench.excitation
    theta = model.nominal
    joint = model.first_joint
    n, links = len(model.bodies), len(model.links)
    x = motion(model, theta, excitation, (), oversampling=1)
    first, second = model.ends(joint)
    r = x[second] - (x[first] if first >= 0 else 0.0)
    travel, speed = undamped(r, excitation), undamped(r * excitation.s, excitation)
    z = dynamic_stiffness(model, theta, excitation.s, excitation.conditions, ())
    peak = np.argmax(np.abs(invert(z)[second, second, 0]))
    frequency = max(float(excitation.s[peak].imag) / (2 * np.pi), 1.0)
    stiffness = float(theta[n + joint])
    return {
        "one": 1.0,
        "mass": float(np.mean(theta[:n])),
        "stiffness": stiffness,
        "damping": float(theta[n + links + joint]),
        "travel": float(np.abs(travel).max()),
        "force": stiffness * float(np.abs(travel).max()),
        "speed": float(np.abs(speed).max()),
        "frequency": frequency,
        "period": 1.0 / frequency,
        "sample": 1.0 / bench.campaign.sample_rate,
        "peak": float(np.abs(bench.campaign.response).max()),
        "noise": float(bench.noise.sigma.min()),
    }
