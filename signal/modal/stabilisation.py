# SPDX-License-Identifier: MIT
"""The stabilisation diagram as a table, and the tracks of poles through it.

A structural pole recurs at every order; a noise pole scatters. From each order to the
next, poles are matched one to one (so that two modes 0.8 % apart cannot share a pole),
and a chain of matches is a track. A track that is stable over enough orders is a
candidate mode, for `mode_selection` to test on the FRF.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import linear_sum_assignment

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.signal.modal.lscf import OrderPoles

# Poles further apart than this from one order to the next are not the same.
_LINK_FREQUENCY = 0.004
_LINK_DAMPING = 4.0
# Prior scatter of a track: this share of the distance above, this much in 1 - MAC, and
# its weight as a number of orders.
_USUAL_SHARE, _USUAL_SHAPE, _USUAL_ORDERS = 1.0 / 3.0, 0.03, 2.0
# Orders a track may miss before it ends.
_MISSED = 3
_UNMATCHED = 1e6
# A pole from a residual recurs where this share of the orders has one within its width
# and this factor of its damping.
_RECURS, _ALIKE = 0.1, 3.0


@dataclass(frozen=True, slots=True)
class StabilityLimits:
    """Criteria of a pole that is the same as its match at the order before.

    Attributes:
        frequency: largest relative change of frequency [-].
        damping: largest relative change of damping ratio [-].
        mac: smallest agreement of shapes [-]; needs two outputs.
        highest_damping: poles at or above this damping ratio are not modes [-].
        persistence: share of all orders in which a mode must be stable [-].
    """

    frequency: float = 0.002
    damping: float = 0.15
    mac: float = 0.9
    highest_damping: float = 0.2
    persistence: float = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Stabilisation:
    """The poles of all orders, one row each, in rising order and frequency.

    Attributes:
        order: shape (n,).
        pole: [rad/s], shape (n,).
        frequency: natural frequency [Hz], shape (n,).
        damping_ratio: [-], shape (n,).
        stable_frequency: same frequency as its match one order down, shape (n,).
        stable_damping: same damping ratio as its match, shape (n,).
        stable_shape: same shape as its match (true for one output), shape (n,).
        track: number of its track, shape (n,).
        orders: all orders that were fitted, shape (n_orders,).
    """

    order: IntArray
    pole: ComplexArray
    frequency: FloatArray
    damping_ratio: FloatArray
    stable_frequency: BoolArray
    stable_damping: BoolArray
    stable_shape: BoolArray
    track: IntArray
    orders: IntArray

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        columns = (
            "order",
            "pole",
            "frequency",
            "damping_ratio",
            "stable_frequency",
            "stable_damping",
            "stable_shape",
            "track",
        )
        for name in columns:
            require_shape(name, getattr(self, name), (self.order.size,))
        freeze(self, *columns, "orders")

    @property
    def stable(self) -> BoolArray:
        """True where frequency, damping and shape are all stable, shape (n,)."""
        stable: BoolArray = (
            self.stable_frequency & self.stable_damping & self.stable_shape
        )
        return stable


@dataclass(frozen=True, slots=True)
class PoleCandidate:
    """A stable track.

    Attributes:
        pole: median over the last third of its stable orders [rad/s].
        scatter: sd of frequency [Hz] and of damping ratio [-] over those orders.
        stable_orders: number of orders at which it was stable.
        track: its number in the table.
        by_hand: True if kept by the operator.
    """

    pole: complex
    scatter: tuple[float, float]
    stable_orders: int
    track: int
    by_hand: bool = False


@dataclass(slots=True, eq=False)
class _Track:
    """The last pole of a track during the matching.

    Attributes:
        moved: sums of squared steps from order to order: relative frequency, logarithm
            of damping, and 1 - MAC as it is, shape (3,).
        steps: how many.
    """

    number: int
    pole: complex
    shape: ComplexArray
    seen: int
    moved: FloatArray = field(default_factory=lambda: np.zeros(3))
    steps: int = 0

    @property
    def variance(self) -> FloatArray:
        """Variance of a step in frequency, damping and shape, prior included."""
        usual = np.array(
            [
                (_USUAL_SHARE * _LINK_FREQUENCY) ** 2,
                (_USUAL_SHARE * np.log(_LINK_DAMPING)) ** 2,
                _USUAL_SHAPE,
            ]
        )
        total = _USUAL_ORDERS * usual + self.moved
        return np.asarray(total / (_USUAL_ORDERS + self.steps))

    def move(self, pole: complex, shape: ComplexArray, position: int) -> None:
        """Extend the track to a pole of a later order."""
        ratio = _damping(np.array([pole, self.pole]))
        frequency = abs(pole) / abs(self.pole) - 1.0
        damping = float(np.log(ratio[0] / ratio[1]))
        turned = 1.0 - abs(np.vdot(shape, self.shape)) ** 2
        self.moved = self.moved + np.array([frequency**2, damping**2, turned])
        self.steps += 1
        self.pole, self.shape, self.seen = pole, shape, position


def stabilise(
    orders: Sequence[OrderPoles], limits: StabilityLimits | None = None
) -> Stabilisation:
    """Match poles from order to order.

    Args:
        orders: poles of each order, orders ascending.
        limits: criteria of stability; None for the defaults.

    Returns:
        The table of all poles below the highest damping.
    """
    limits = limits or StabilityLimits()
    tracks: list[_Track] = []
    rows: list[tuple[int, complex, bool, bool, bool, int]] = []
    opened = 0
    for position, found in enumerate(orders):
        keep = _damping(found.pole) < limits.highest_damping
        poles, shapes = found.pole[keep], found.shape[keep]
        matched = _match(tracks, poles, shapes)
        for i, (pole, shape) in enumerate(zip(poles, shapes, strict=True)):
            before = matched.get(i)
            if before is None:
                before = _Track(opened, complex(pole), shape, position)
                tracks.append(before)
                flags, opened = (False, False, False), opened + 1
            else:
                flags = _flags(before, pole, shape, limits)
                before.move(complex(pole), shape, position)
            rows.append((found.order, complex(pole), *flags, before.number))
        tracks = [t for t in tracks if position - t.seen <= _MISSED]
    return _table(rows, [found.order for found in orders])


def candidates(
    table: Stabilisation, limits: StabilityLimits | None = None
) -> tuple[PoleCandidate, ...]:
    """Return the stable tracks, by ascending frequency.

    Args:
        table: from `stabilise`.
        limits: `persistence` sets how long a track must be; None for the defaults.

    Returns:
        One candidate per track, without repeats and without splinters of broader ones.
    """
    limits = limits or StabilityLimits()
    least = max(3, round(limits.persistence * table.orders.size))
    stable, found = table.stable, []
    for number in np.unique(table.track[stable]):
        members = np.flatnonzero(stable & (table.track == number))
        if members.size >= least:
            found.append(_candidate(table, members, int(number)))
    found = _without_repeats(sorted(found, key=lambda c: c.pole.imag), table)
    return tuple(c for c in found if not any(_splinter(c, host) for host in found))


def from_residual(table: Stabilisation, pole: complex) -> PoleCandidate:
    """Return a candidate that the residual of a fit showed and no stable track did.

    Args:
        table: from `stabilise`.
        pole: [rad/s].

    Returns:
        Its stable orders are those with a stable pole within its half-power width.
    """
    near = np.abs(table.pole.imag - pole.imag) < abs(pole.real)
    orders = np.unique(table.order[near & table.stable])
    return PoleCandidate(pole, (0.0, 0.0), int(orders.size), -1)


def recurs(table: Stabilisation, pole: complex) -> bool:
    """Return whether a pole of its frequency and damping is found at many orders.

    What the residual of a fit suggests may be leakage, or a resonance that is not that
    of a linear mode; poles of the FRF itself do not place a mode there.

    Args:
        table: from `stabilise`.
        pole: [rad/s].
    """
    near = np.abs(table.pole.imag - pole.imag) < abs(pole.real)
    alike = np.abs(np.log(table.pole.real / pole.real)) < np.log(_ALIKE)
    seen = np.unique(table.order[near & alike]).size
    return bool(seen >= _RECURS * table.orders.size)


def mac(one: ComplexArray, other: ComplexArray) -> float:
    """Return the modal assurance criterion of two shapes [-].

    Source:
        Allemang and Brown, IMAC 1 (1982) 110.
    """
    together = abs(np.vdot(one, other)) ** 2
    apart = np.vdot(one, one).real * np.vdot(other, other).real
    return float(together / apart) if apart > 0.0 else 0.0


def _match(
    tracks: Sequence[_Track], poles: ComplexArray, shapes: ComplexArray
) -> dict[int, _Track]:
    """Pair poles with tracks one to one; return the track of each matched pole.

    Distances are in standard deviations of each track's own steps, so that of two close
    modes the steady one is not exchanged for the scattered one.
    """
    if not tracks or poles.size == 0:
        return {}
    last = np.array([t.pole for t in tracks])
    frequency = np.abs(poles[:, None]) / np.abs(last) - 1.0
    damping = np.log(_damping(poles)[:, None] / _damping(last))
    overlap = np.abs(shapes.conj() @ np.array([t.shape for t in tracks]).T) ** 2
    variance = np.array([t.variance for t in tracks]).T
    cost = frequency**2 / variance[0] + damping**2 / variance[1]
    cost += (1.0 - overlap) / variance[2] + np.log(variance).sum(axis=0)
    near = np.abs(frequency) < _LINK_FREQUENCY
    near &= np.abs(damping) < np.log(_LINK_DAMPING)
    pairs = linear_sum_assignment(np.where(near, cost, _UNMATCHED))
    return {int(i): tracks[int(j)] for i, j in zip(*pairs, strict=True) if near[i, j]}


def _flags(
    before: _Track, pole: complex, shape: ComplexArray, limits: StabilityLimits
) -> tuple[bool, bool, bool]:
    one, other = np.array([before.pole]), np.array([pole])
    frequency = abs(abs(pole) / abs(before.pole) - 1.0)
    damping = abs(float(_damping(other)[0] / _damping(one)[0]) - 1.0)
    return (
        frequency < limits.frequency,
        damping < limits.damping,
        shape.size < 2 or mac(before.shape, shape) > limits.mac,
    )


def _table(
    rows: Sequence[tuple[int, complex, bool, bool, bool, int]], orders: Sequence[int]
) -> Stabilisation:
    columns = list(zip(*rows, strict=True)) if rows else [()] * 6
    pole = np.array(columns[1], complex)
    return Stabilisation(
        order=np.array(columns[0], np.int64),
        pole=pole,
        frequency=np.abs(pole) / (2.0 * np.pi),
        damping_ratio=_damping(pole),
        stable_frequency=np.array(columns[2], bool),
        stable_damping=np.array(columns[3], bool),
        stable_shape=np.array(columns[4], bool),
        track=np.array(columns[5], np.int64),
        orders=np.array(orders, np.int64),
    )


def _candidate(table: Stabilisation, members: IntArray, number: int) -> PoleCandidate:
    late = members[-max(3, members.size // 3) :]
    frequency, damping = table.frequency[late], table.damping_ratio[late]
    omega = 2.0 * np.pi * float(np.median(frequency))
    ratio = float(np.median(damping))
    return PoleCandidate(
        pole=complex(-ratio * omega, omega * np.sqrt(1.0 - ratio**2)),
        scatter=(float(np.std(frequency)), float(np.std(damping))),
        stable_orders=int(members.size),
        track=number,
    )


def _without_repeats(
    found: Sequence[PoleCandidate], table: Stabilisation
) -> list[PoleCandidate]:
    """Keep the longer of two tracks of one pole with a break in between.

    Tracks that share an order are two poles, however close.
    """
    kept: list[PoleCandidate] = []
    for candidate in found:
        if kept and _same_pole(kept[-1], candidate, table):
            if candidate.stable_orders > kept[-1].stable_orders:
                kept[-1] = candidate
        else:
            kept.append(candidate)
    return kept


def _splinter(one: PoleCandidate, host: PoleCandidate) -> bool:
    """Return whether a pole only improves the fit of a broader, steadier one.

    High orders place a second, narrow pole on a broad peak that is not exactly that of
    a single mode. A separate mode is stable at nearly as many orders.
    """
    inside = abs(one.pole.imag - host.pole.imag) < abs(host.pole.real)
    narrow = abs(one.pole.real) < 0.5 * abs(host.pole.real)
    return inside and narrow and one.stable_orders < 0.4 * host.stable_orders


def _same_pole(one: PoleCandidate, other: PoleCandidate, table: Stabilisation) -> bool:
    near = abs(abs(one.pole) / abs(other.pole) - 1.0) < _LINK_FREQUENCY
    ratio = _damping(np.array([one.pole])) / _damping(np.array([other.pole]))
    alike = abs(np.log(float(ratio[0]))) < np.log(_LINK_DAMPING)
    orders = [set(table.order[table.track == c.track]) for c in (one, other)]
    return near and alike and not orders[0] & orders[1]


def _damping(pole: ComplexArray) -> FloatArray:
    """Return the damping ratio of poles [-]."""
    ratio: FloatArray = -pole.real / np.abs(pole)
    return ratio
