# SPDX-License-Identifier: MIT
"""The gain of an effect is computed with one noise estimate for both fits."""

import gap_bench as made
import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.residuals.make_bench import make_bench

NOISE = 0.02
BASE = made.BASE


def softening_campaign(seed: int) -> Campaign:
    """Return hits on a joint that grows softer by 1 in 7,000 from first to last."""
    bench = make_bench(made.quiet_campaign())
    clean = [
        bench.response(BASE + softer * np.eye(6)[3], [])[k]
        for k, softer in enumerate(
            -1.4e-4 * np.linspace(0.0, 1.0, len(bench.campaign.hit))
        )
    ]
    rng = np.random.default_rng(seed)
    records: FloatArray = np.stack(clean)
    return made.quiet_campaign(records + NOISE * rng.standard_normal(records.shape))


def test_a_trend_outside_the_catalogue_is_not_credited_to_another_effect() -> None:
    """Without loosening in the catalogue nothing is named, with it loosening is.

    More campaigns with an effect outside the catalogue: docs/gap-outside.md.
    """
    campaign = softening_campaign(1)
    assert diagnose(campaign, without=frozenset({"loosening"})).effects == ()
    found = diagnose(campaign)
    assert found.verdict is Finding.NAMED
    assert [e.name for e in found.effects] == ["loosening"]
