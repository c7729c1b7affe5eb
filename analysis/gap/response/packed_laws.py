# SPDX-License-Identifier: MIT
"""Pack the force laws of ports into the arrays of the time integration."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.response.effect_hooks import Law
from jointbench.analysis.gap.response.law_forces import (
    CURVES,
    SLIDERS,
    IntegrationLaws,
)

PARAMETERS = 4
SLIDER_ROWS = 4
CURVE_ROWS = 3


def pack_laws(
    laws: Sequence[Law], ports: Sequence[int], *, band_limited: bool
) -> IntegrationLaws:
    """Return laws that act together in packed arrays.

    Args:
        laws: in the order of their forces.
        ports: port of each law.
        band_limited: True for samples of the band-limited force.
    """
    p = np.zeros((len(laws), PARAMETERS))
    for row, law in zip(p, laws, strict=True):
        row[: law.parameters.size] = law.parameters
    sizes = [law.slips.size for law in laws]
    return IntegrationLaws(
        kinds=np.array([law.kind for law in laws], dtype=np.int64),
        ports=np.array(ports, dtype=np.int64),
        p=p,
        ends=np.cumsum([0, *sizes], dtype=np.int64),
        slips=np.concatenate([law.slips for law in laws]),
        weights=np.concatenate([law.weights for law in laws]),
        tables=_rows(laws, SLIDERS, SLIDER_ROWS),
        tops=np.stack([law.tops for law in laws]),
        curves=_rows(laws, CURVES, CURVE_ROWS),
        band_limited=band_limited,
    )


def _rows(laws: Sequence[Law], kind: int, count: int) -> FloatArray:
    """Return the tables of one kind of law, `count` rows per law, zeros for others.

    A shorter table is continued by its last value, as a look-up beyond its end is.
    """
    own = [law.tables if law.kind == kind else None for law in laws]
    width = max((t.shape[1] for t in own if t is not None), default=1)
    rows = [
        np.zeros((count, width)) if t is None else _continued(t, width) for t in own
    ]
    return rows[0] if len(rows) == 1 else np.concatenate(rows)


def _continued(table: FloatArray, width: int) -> FloatArray:
    more = width - table.shape[1]
    return np.pad(table, ((0, 0), (0, more)), mode="edge") if more else table
