"""A small hammer campaign made in code, for the tests of the gap engine."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.model.two_body_model import two_body_model
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench

NOMINAL = {"m1": 8.0, "m2": 4.0, "k0": 2.4e7, "c0": 300.0, "kj": 6e7, "cj": 220.0}
SPREAD = {"m1": 0.003, "m2": 0.003, "k0": 0.05, "c0": 0.2, "kj": 0.1, "cj": 0.3}
RATE = 16384.0
SAMPLES = 1024
BASE = np.array([0.002, -0.001, 0.04, -0.06, 0.1, -0.2])
OF_THE_SIGNAL = ("saturation", "hum")
"""Effects whose scale is that of a measured signal."""
CONDITIONS = (
    (1, 30.0, 4000.0),
    (1, 300.0, 4000.0),
    (1, 1000.0, 4000.0),
    (1, 300.0, 4000.0),
    (1, 1000.0, 4000.0),
    (0, 300.0, 4000.0),
    (0, 1000.0, 4000.0),
    (1, 300.0, 8000.0),
)


def quiet_campaign(
    response: FloatArray | None = None, *, samples: int = SAMPLES
) -> Campaign:
    """Return the hits with a given response, or with none."""
    time = np.arange(samples) / RATE
    shape = np.exp(-0.5 * ((time - 0.008) / 2.5e-4) ** 2)
    level = np.array([level for _, level, _ in CONDITIONS])
    records = len(CONDITIONS)
    if response is None:
        response = np.zeros((records, 2, samples))
    return Campaign(
        name="made",
        sample_rate=RATE,
        force=level[:, None] * shape,
        response=response,
        hit=np.array([hit for hit, _, _ in CONDITIONS]),
        level=level,
        preload=np.array([preload for _, _, preload in CONDITIONS]),
        order=np.arange(records, dtype=float),
        preload_reference=4000.0,
        model=two_body_model(NOMINAL, SPREAD),
    )


def first_samples(campaign: Campaign, count: int) -> Campaign:
    """Return the campaign with records of the first samples only."""
    return replace(
        campaign,
        force=campaign.force[:, :count],
        response=campaign.response[..., :count],
    )


def term_of(bench: LumpedBench, name: str, site: str, values: list[float]) -> Term:
    """Return a term with values [SI]."""
    found = [
        c for c in bench.candidates if c.effect.name == name and str(c.site) == site
    ]
    coordinates = [
        p.encode(v / bench.scale(p.scale))
        for p, v in zip(found[0].effect.parameters, values, strict=True)
    ]
    return Term(found[0], np.array(coordinates))


def made_campaign(
    effects: list[tuple[str, str, list[float]]], *, noise: float = 0.05, seed: int = 1
) -> Campaign:
    """Return a campaign with hidden effects, a deviating base, and noise."""
    bench = make_bench(quiet_campaign())
    rng = np.random.default_rng(seed)
    draws = noise * rng.standard_normal(bench.campaign.response.shape)
    if any(name in OF_THE_SIGNAL for name, _, _ in effects):
        bench = make_bench(quiet_campaign(bench.response(BASE, []) + draws))
    terms = [term_of(bench, *effect) for effect in effects]
    return quiet_campaign(bench.response(BASE, terms) + draws)
