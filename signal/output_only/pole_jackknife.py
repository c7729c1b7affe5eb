# SPDX-License-Identifier: MIT
"""Jackknife over blocks: steady poles of correlations and their scatter.

All poles are estimated again with each block of the record left out in turn. The
scatter of a pole is its uncertainty, for any kind of noise in the correlations; a pole
with too large a scatter is no mode.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.tail_probabilities import normal_quantile, t_quantile
from jointbench.signal.modal.lscf import OrderPoles
from jointbench.signal.modal.stabilisation import PoleCandidate, Stabilisation, mac
from jointbench.signal.output_only.correlations import Correlations
from jointbench.signal.output_only.stochastic_subspace import subspace_poles

# A pole is followed at this many of the orders at which it was stable.
_ORDERS_AVERAGED = 5
# Largest sd of a mode: of damping as a share of itself, of frequency as a share of the
# half-power half-width.
_VAGUE = 0.4
_ADRIFT = 0.4
# Two poles closer than their half-power half-width are one if the MAC of their shapes
# exceeds this.
_ALIKE = 0.9
# A pole further off than this many half-power half-widths is another pole.
_LEASH = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class JudgedPole:
    """A candidate after the jackknife.

    Attributes:
        candidate: as found in the diagram.
        pole: median over the orders with the least scatter [rad/s].
        sd: of frequency [Hz] and of damping ratio, shape (2,).
        shape: largest component 1, shape (n_outputs,).
    """

    candidate: PoleCandidate
    pole: complex
    sd: FloatArray
    shape: ComplexArray


def judge_poles(
    data: Correlations,
    found: Sequence[PoleCandidate],
    table: Stabilisation,
    band: tuple[float, float],
) -> list[JudgedPole]:
    """Jackknife all candidates and keep the steady ones, each once.

    Args:
        data: correlations, block by block.
        found: candidates among the poles of `table`.
        table: poles of all orders from all blocks.
        band: poles outside it are left out [Hz].

    Returns:
        The modes by ascending frequency; their sd is widened so that 1.96 of it cover
        as Student's t does.

    Source:
        Efron and Stein, Annals of Statistics 9 (1981) 586.
    """
    if not found:
        return []
    orders = tuple(int(order) for order in table.orders)
    whole = correlation_poles(data, data.mean, orders, band)
    parts = [
        correlation_poles(data, data.without(block), orders, band)
        for block in range(data.blocks.shape[0])
    ]
    judged = [_judge(candidate, table, whole, parts) for candidate in found]
    known = [one for one in judged if one is not None and _known(one.pole, one.sd)]
    return _each_once(known)


def _judge(
    candidate: PoleCandidate,
    table: Stabilisation,
    whole: Sequence[OrderPoles],
    parts: Sequence[Sequence[OrderPoles]],
) -> JudgedPole | None:
    """Follow a candidate through the blocks, at the orders with the least scatter.

    At high orders a resonance may be shared by two poles, and the nearer one changes
    from block to block: such orders scatter and are skipped.
    """
    members = table.order[table.stable & (table.track == candidate.track)]
    places = [int(i) for i in np.flatnonzero(np.isin(table.orders, members))]
    poles = np.array(
        [[_nearest(some[i], candidate.pole)[0] for i in places] for some in parts]
    )
    spread = np.array([_doubt(column) for column in poles.T])
    best = np.argsort(spread)[: max(1, min(_ORDERS_AVERAGED, len(places) // 2))]
    if not np.isfinite(spread[best]).all():
        return None
    here = [_nearest(whole[places[i]], candidate.pole) for i in best]
    left_out = [_middle(row[best]) for row in poles]
    shape = _mean_shape([shape for _, shape in here])
    middle = _middle(np.array([pole for pole, _ in here]))
    return JudgedPole(candidate, middle, _jackknife(np.array(left_out)), shape)


def _nearest(order: OrderPoles, pole: complex) -> tuple[complex, ComplexArray]:
    """Return the pole of an order nearest to another, or NaN if none is near."""
    if order.pole.size:
        distance = np.abs(order.pole - pole)
        nearest = int(np.argmin(distance))
        if distance[nearest] < _LEASH * abs(pole.real):
            return complex(order.pole[nearest]), order.shape[nearest]
    return complex(np.nan, np.nan), np.zeros(0, complex)


def _middle(poles: ComplexArray) -> complex:
    return complex(np.median(poles.real), np.median(poles.imag))


def _doubt(poles: ComplexArray) -> float:
    """Return the relative variance of a leave-one-out pole; infinite if lost once."""
    if not np.isfinite(poles).all():
        return np.inf
    middle = _middle(poles)
    sd = _jackknife(poles)
    half_width = abs(middle.real) / (2.0 * np.pi)
    damping = -middle.real / abs(middle)
    return float((sd[0] / half_width) ** 2 + (sd[1] / damping) ** 2)


def _mean_shape(shapes: Sequence[ComplexArray]) -> ComplexArray:
    """Return the common shape; the shape of each order has an arbitrary phase."""
    shape = np.linalg.svd(np.array(shapes), full_matrices=False)[2][0]
    return np.asarray(shape / shape[np.argmax(np.abs(shape))])


def _each_once(known: Sequence[JudgedPole]) -> list[JudgedPole]:
    """Keep the better known of two tracks with the same pole and shape."""
    kept: list[JudgedPole] = []
    for one in sorted(known, key=lambda k: float(k.sd[1] / -k.pole.real * abs(k.pole))):
        if not any(_same(one, other) for other in kept):
            kept.append(one)
    return sorted(kept, key=lambda k: abs(k.pole))


def _same(one: JudgedPole, other: JudgedPole) -> bool:
    sd = 2.0 * np.pi * float(np.hypot(one.sd[0], other.sd[0]))
    width = min(abs(one.pole.real), abs(other.pole.real))
    near = abs(abs(one.pole) - abs(other.pole)) < max(width, 2.0 * sd)
    return near and (one.shape.size == 1 or mac(one.shape, other.shape) > _ALIKE)


def correlation_poles(
    data: Correlations,
    correlation: FloatArray,
    orders: Sequence[int],
    band: tuple[float, float],
) -> tuple[OrderPoles, ...]:
    """Return the poles of scaled correlations; see `subspace.subspace_poles`."""
    return subspace_poles(
        correlation,
        orders,
        sample_rate=data.sample_rate,
        band=band,
        scale=data.scale,
    )


def _jackknife(pole: ComplexArray) -> FloatArray:
    """Return the sd of frequency [Hz] and damping ratio from leave-one-out poles."""
    count = pole.size
    columns = np.stack((np.abs(pole) / (2.0 * np.pi), -pole.real / np.abs(pole)))
    away = columns - columns.mean(axis=1, keepdims=True)
    variance = (count - 1) / count * np.sum(away**2, axis=1)
    few = t_quantile(0.975, count - 1) / normal_quantile(0.975)
    return np.asarray(np.sqrt(variance) * few)


def _known(pole: complex, sd: FloatArray) -> bool:
    damping = -pole.real / abs(pole)
    half_width = abs(pole.real) / (2.0 * np.pi)
    return bool(sd[1] < _VAGUE * damping and sd[0] < _ADRIFT * half_width)
