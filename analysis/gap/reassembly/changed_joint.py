# SPDX-License-Identifier: MIT
"""Has a joint changed since the sessions before? And what the next assembly will be."""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from scipy.special import chdtrc, ndtr, ndtri

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    STIFFNESSES,
    ContactQuantity,
    JointData,
    JointFacts,
)
from jointbench.analysis.gap.reassembly.assembly_rows import (
    AssemblyRows,
    assembly_rows,
)
from jointbench.analysis.gap.reassembly.assembly_scatter import (
    NominalScatter,
    ScatterPosterior,
    scatter_posterior,
)
from jointbench.analysis.gap.reassembly.expected_values import (
    Expected,
    expected_values,
    quantiles,
)
from jointbench.analysis.gap.reassembly.reassembly_settings import REASSEMBLY

DAMPINGS = QUANTITIES[len(STIFFNESSES) :]


class JointChange(StrEnum):
    """Whether a joint has changed."""

    CHANGED = "changed"
    SCATTER = "within its scatter"
    OPEN = "cannot be determined"


@dataclass(frozen=True, slots=True)
class LatestAssembly:
    """The latest assembly beside those before.

    Attributes:
        change: verdict on this quantity.
        ratio: of its values to those expected, over all levels [-].
        interval: in which that ratio lies if nothing has changed, 95 % [-].
        detectable: factor on the values that is seen in four of five sessions [-].
        offset_probability: of a ratio as far from 1 or farther [-].
        shape_probability: of a course over the levels as far from that expected or
            farther [-].
    """

    change: JointChange
    ratio: float
    interval: tuple[float, float]
    detectable: float
    offset_probability: float
    shape_probability: float


@dataclass(frozen=True, slots=True, eq=False)
class QuantityOverAssemblies:
    """One quantity over the assemblies of a joint.

    Attributes:
        rows: measured values.
        scatter: from assembly to assembly and from tightening to tightening.
        level: levels of the prediction, shape (n_levels,).
        next_assembly: median, lower and upper end of the 95 % interval of the next
            assembly in SI units, shape (3, n_levels).
        latest: the latest assembly beside those before.
    """

    rows: AssemblyRows
    scatter: ScatterPosterior
    level: FloatArray
    next_assembly: FloatArray
    latest: LatestAssembly

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "level", "next_assembly")


@dataclass(frozen=True, slots=True)
class Reassembly:
    """A joint over its assemblies.

    Attributes:
        change: verdict on all quantities together.
        reassembled: whether the joint was put together again before the latest states.
        by_torque: whether levels are torques [N m], not preloads [N].
        quantities: by what was measured.
    """

    change: JointChange
    reassembled: bool
    by_torque: bool
    quantities: dict[ContactQuantity, QuantityOverAssemblies]


@one_thread()
def compare_assemblies(
    data: JointData,
    *,
    level: FloatArray | None = None,
    reassembled: bool = True,
) -> Reassembly:
    """Predict the next assembly of a joint, and judge whether the latest differs.

    Args:
        data: joint over its preload in several assemblies, in their order.
        level: for which the next assembly is predicted, torque [N m] or preload [N],
            shape (n_levels,); None for those measured.
        reassembled: whether the joint was put together again between the latest
            assembly and that before; else its offset must be the same.

    Raises:
        BadData: there is one assembly only, or a level is too far from those measured.
    """
    rows = assembly_rows(data)
    limit = REASSEMBLY.significance / len(rows)
    found = {
        quantity: _one_quantity(
            one, _nominal(data.facts, quantity), level, reassembled, limit
        )
        for quantity, one in rows.items()
    }
    said = {one.latest.change for one in found.values()}
    order = (JointChange.CHANGED, JointChange.OPEN, JointChange.SCATTER)
    change = next(c for c in order if c in said)
    by_torque = bool(np.isfinite(data.states.torque).all())
    return Reassembly(change, reassembled, by_torque, found)


def _nominal(facts: JointFacts, quantity: ContactQuantity) -> NominalScatter:
    within = facts.torque_scatter
    if quantity in DAMPINGS:
        within = REASSEMBLY.damping_within
    return NominalScatter(facts.reassembly, within)


def _one_quantity(
    rows: AssemblyRows,
    nominal: NominalScatter,
    level: FloatArray | None,
    reassembled: bool,
    limit: float,
) -> QuantityOverAssemblies:
    asked = rows.levels if level is None else level
    # Offsets are those of assemblies that were opened in between.
    as_put = rows if reassembled else _joined(rows)
    scatter = scatter_posterior(as_put, nominal)
    new = np.full(asked.size, int(rows.assembly.max()) + 1)
    tail = 0.5 * (1.0 - REASSEMBLY.confidence)
    # Each level by itself: one tightening of the next assembly, without its error.
    expected = expected_values(scatter, asked, new, np.zeros((asked.size,) * 2))
    ends = np.exp(quantiles(expected, (0.5, tail, 1.0 - tail)))
    latest = _latest(rows, as_put, nominal, limit)
    return QuantityOverAssemblies(rows, scatter, asked, ends, latest)


def _joined(rows: AssemblyRows) -> AssemblyRows:
    """Return the rows with the latest assembly as part of the one before."""
    last, before = rows.assemblies[-1], rows.assemblies[-2]
    return replace(
        rows, assembly=np.where(rows.assembly == last, before, rows.assembly)
    )


def _latest(
    rows: AssemblyRows, as_put: AssemblyRows, nominal: NominalScatter, limit: float
) -> LatestAssembly:
    new = rows.assembly == rows.assemblies[-1]
    old = AssemblyRows(
        rows.quantity,
        rows.value[~new],
        rows.covariance[np.ix_(~new, ~new)],
        rows.level[~new],
        rows.assembly[~new],
    )
    # Levels that the sessions before do not reach show nothing of a change.
    reach = REASSEMBLY.extrapolation if old.levels.size > 1 else 1.0
    margin = np.log(reach) + REASSEMBLY.same_level
    inside = (np.log(rows.level) > np.log(old.levels[0]) - margin) & (
        np.log(rows.level) < np.log(old.levels[-1]) + margin
    )
    new &= inside
    if not new.any():
        return LatestAssembly(JointChange.OPEN, np.nan, (0.0, np.inf), np.inf, 1.0, 1.0)
    expected = expected_values(
        scatter_posterior(old, nominal),
        rows.level[new],
        as_put.assembly[new],
        rows.covariance[np.ix_(new, new)],
    )
    return _judged(expected, rows.value[new], limit)


def _judged(expected: Expected, value: FloatArray, limit: float) -> LatestAssembly:
    """Judge offset and shape of the latest values."""
    weight = expected.weight
    ones = np.ones(value.size)
    offset, sd, offset_tail, shape_tail = (np.empty(weight.size) for _ in range(4))
    for k, (mean, covariance) in enumerate(
        zip(expected.mean, expected.covariance, strict=True)
    ):
        rest = value - mean
        white = np.linalg.solve(covariance, np.column_stack([ones, rest]))
        precision = float(ones @ white[:, 0])
        offset[k], sd[k] = float(ones @ white[:, 1]) / precision, precision**-0.5
        offset_tail[k] = 2.0 * float(ndtr(-abs(offset[k]) / sd[k]))
        squares = max(float(rest @ white[:, 1]) - (offset[k] / sd[k]) ** 2, 0.0)
        shape_tail[k] = chdtrc(value.size - 1, squares) if value.size > 1 else 1.0
    p_offset, p_shape = float(weight @ offset_tail), float(weight @ shape_tail)
    # What nothing but scatter shows, with the sd of all pairs together.
    spread = float(np.sqrt(weight @ sd**2))
    wide = spread * float(-ndtri(0.5 * (1.0 - REASSEMBLY.confidence)))
    least = limit / REASSEMBLY.tests
    seen = spread * float(ndtri(REASSEMBLY.power) - ndtri(0.5 * least))
    if min(p_offset, p_shape) < least:
        change = JointChange.CHANGED
    elif seen > np.log(REASSEMBLY.widest):
        change = JointChange.OPEN
    else:
        change = JointChange.SCATTER
    return LatestAssembly(
        change,
        float(np.exp(weight @ offset)),
        (float(np.exp(-wide)), float(np.exp(wide))),
        float(np.exp(seen)),
        p_offset,
        p_shape,
    )
