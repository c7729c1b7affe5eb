# SPDX-License-Identifier: MIT
"""Base model of a two-body campaign from its nominal values and priors."""

from collections.abc import Mapping

import numpy as np

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.lumped.lumped_model import (
    GROUND,
    Body,
    Link,
    LumpedModel,
    ResponseChannel,
)


def two_body_model(
    nominal: Mapping[str, float], spread: Mapping[str, float]
) -> LumpedModel:
    """Return ground -(k0, c0)- m1 -(kj, cj)- m2 with a channel on each body.

    Args:
        nominal: m1, m2 [kg], k0, kj [N/m], c0, cj [N s/m].
        spread: standard deviation of the logarithm of each [-], same keys.

    Raises:
        BadData: a value is missing or not positive.
    """
    for key in ("m1", "m2", "k0", "kj", "c0", "cj"):
        for table, word in ((nominal, "nominal value"), (spread, "1-sigma")):
            value = table.get(key)
            if value is None or not (np.isfinite(value) and value > 0):
                raise BadData(
                    f"the {word} of {key!r} is {value!r}, it must be a positive "
                    "number; complete the nominal parameters"
                )
    return LumpedModel(
        bodies=tuple(Body(key, nominal[key], spread[key]) for key in ("m1", "m2")),
        links=(
            _link("ground", (GROUND, "m1"), "0", nominal, spread, joint=False),
            _link("joint", ("m1", "m2"), "j", nominal, spread, joint=True),
        ),
        channels=(ResponseChannel("a0", "m1"), ResponseChannel("a1", "m2")),
    )


def _link(
    name: str,
    ends: tuple[str, str],
    key: str,
    nominal: Mapping[str, float],
    spread: Mapping[str, float],
    *,
    joint: bool,
) -> Link:
    return Link(
        name,
        ends,
        stiffness=nominal[f"k{key}"],
        damping=nominal[f"c{key}"],
        stiffness_spread=spread[f"k{key}"],
        damping_spread=spread[f"c{key}"],
        joint=joint,
    )
