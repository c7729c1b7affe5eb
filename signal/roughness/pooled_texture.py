# SPDX-License-Identifier: MIT
"""Texture parameters of several measurements of one surface."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.special

from jointbench.signal.roughness.uncertain_parameters import (
    MeasuredTexture,
    TextureValue,
)

COVERAGE = 0.95
_NORMAL_FREEDOM = 1e6
"""Degrees of freedom from which Student's factor is that of the normal [-]."""


def pooled_texture(several: Sequence[MeasuredTexture]) -> tuple[TextureValue, ...]:
    """Return the mean parameters of several measurements of one surface.

    The scatter of the measurements holds noise and place; filter and scales are common
    to all of them. The interval has Student's factor for the degrees of freedom of the
    combined uncertainty (Welch and Satterthwaite).

    Args:
        several: measurements at different places, two at least.
    """
    found = []
    for name in (one.name for one in several[0].values):
        all_of = [one.named(name) for one in several]
        known = [one for one in all_of if one.value is not None]
        if len(known) < 2:
            found.append(TextureValue(name, None))
            continue
        found.append(_pooled(name, known))
    return tuple(found)


def _pooled(name: str, known: Sequence[TextureValue]) -> TextureValue:
    values = np.array([one.value for one in known], dtype=np.float64)
    repeats = float(values.std(ddof=1) / np.sqrt(values.size))
    common = {
        cause: float(np.mean([dict(one.parts)[cause] for one in known]))
        for cause in ("filter", "height", "pitch")
        if all(cause in dict(one.parts) for one in known)
    }
    value = TextureValue(
        name,
        float(values.mean()),
        float(np.mean([one.bias for one in known])),
        (*common.items(), ("repeats", repeats)),
    )
    share = (value.uncertainty / repeats) ** 4 if repeats > 0 else np.inf
    freedom = (values.size - 1) * share
    level = 0.5 + COVERAGE / 2
    factor = (
        1.96
        if freedom > _NORMAL_FREEDOM
        else float(scipy.special.stdtrit(freedom, level))
    )
    return replace(value, factor=factor)
