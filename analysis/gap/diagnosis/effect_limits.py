# SPDX-License-Identifier: MIT
"""The largest size of each effect that the records do not exclude.

The directed tests of the base give amplitude and standard deviation of every effect at
every point of its start grid, with the base refitted to first order. For an effect with
shape parameters the limit is that of the shape that is hardest to see.
"""

import numpy as np

from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.model.check_records import EffectLimit
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.bench_protocol import values_of
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.search.screening import Direction, Screening


def effect_limits(bench: LumpedBench, screening: Screening) -> tuple[EffectLimit, ...]:
    """Return the limit of each effect at each site, in the order of the catalogue.

    Args:
        bench: measurement and model.
        screening: directed tests of the base.

    Returns:
        Effects whose amplitude the test does not determine, such as a reversed sign or
        a clipped channel, are left out.
    """
    found = []
    for candidate in bench.candidates:
        if candidate.effect.parameters[0].starts:
            continue
        own = [d for d in screening.directions if d.candidate == candidate]
        tested = [d for d in own if np.isfinite(d.amplitude_sd) and not d.suggested]
        if tested:
            found.append(_limit(bench, max(tested, key=lambda d: abs(_largest(d)))))
    return tuple(found)


def _largest(direction: Direction) -> float:
    """Return the largest amplitude that is not excluded [coordinate]."""
    if direction.one_sided:
        reach = DIAGNOSIS.one_sided_quantile * direction.amplitude_sd
        return max(direction.amplitude, 0.0) + reach
    reach = DIAGNOSIS.two_sided_quantile * direction.amplitude_sd
    sign = 1.0 if direction.amplitude >= 0.0 else -1.0
    return direction.amplitude + sign * reach


def _limit(bench: LumpedBench, direction: Direction) -> EffectLimit:
    """Return the limit of a test in the unit of its effect."""
    coordinates = direction.coordinates.copy()
    coordinates[0] = _largest(direction)
    candidate = direction.candidate
    values = values_of(bench, Term(candidate, coordinates))
    return EffectLimit(
        candidate.effect.name, str(candidate.site), candidate.effect.reported(values)
    )
