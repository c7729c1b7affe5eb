# SPDX-License-Identifier: MIT
"""The poles that are chosen, and how a choice changes them."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, ComplexArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.modal.stabilisation import PoleCandidate, Stabilisation
from jointbench.station.desk.desk_choice import ChoiceAction, DeskChoice

# Largest distance of a pole from a frequency that is asked for, as a share of it.
_REACH = 0.01
# Two poles of different orders closer than this share of the half-power half-width are
# the same peak, whatever tracks they are on.
_ONE_PEAK = 0.25


@dataclass(frozen=True, slots=True)
class ChosenPole:
    """One chosen pole.

    Attributes:
        candidate: pole, scatter over orders, who chose it.
        pinned: whether frequency and damping stay as they are.
    """

    candidate: PoleCandidate
    pinned: bool = False

    @property
    def frequency(self) -> float:
        """Natural frequency [Hz]."""
        return abs(self.candidate.pole) / (2.0 * np.pi)


ChosenSet = tuple[ChosenPole, ...]


def pins_of(chosen: ChosenSet) -> BoolArray:
    """Return which poles are pinned, shape (n_chosen,)."""
    return np.array([one.pinned for one in chosen], bool)


def automatic_set(poles: ComplexArray, table: Stabilisation) -> ChosenSet:
    """Return what the automatic selection chose, each pole with its track.

    Args:
        poles: refined [rad/s], shape (n_modes,).
        table: the diagram.
    """
    return _sorted(_automatic(complex(pole), table) for pole in poles)


def pole_row(table: Stabilisation, frequency: float, order: int, ratio: float) -> int:
    """Return the row of the diagram nearest to a place in it.

    Args:
        table: the diagram.
        frequency: [Hz].
        order: of the fit; 0 for the best one: the last stable pole of the track.
        ratio: damping ratio, to part poles of one frequency; nan where not known.

    Raises:
        UsageError: no pole within 1 %.
    """
    rows = np.arange(table.order.size)
    if order:
        rows = rows[table.order == order]
    if rows.size == 0:
        raise UsageError(
            f"no order {order} was fitted; the orders are {table.orders[0]} to "
            f"{table.orders[-1]}"
        )
    if order == 0 and table.stable.any():
        rows = rows[table.stable]
    away = np.abs(table.frequency[rows] - frequency)
    if not np.isnan(ratio):
        away = away + frequency * 0.01 * np.abs(table.damping_ratio[rows] - ratio)
    near = int(rows[np.argmin(away)])
    if abs(table.frequency[near] - frequency) > _REACH * frequency:
        raise UsageError(
            f"there is no pole within 1 % of {frequency:g} Hz"
            + (f" at order {order}" if order else "")
            + f"; the nearest is at {table.frequency[near]:.6g} Hz"
        )
    if order:
        return near
    track = np.flatnonzero((table.track == table.track[near]) & table.stable)
    return int(track[-1]) if track.size else near


def located(choice: DeskChoice, table: Stabilisation) -> DeskChoice:
    """Return a choice of a pole with the values of the pole that it means.

    The log then holds which one it was, whoever asked for it and how.

    Raises:
        UsageError: no pole within 1 %.
    """
    if choice.action not in {ChoiceAction.CHOOSE, ChoiceAction.PIN}:
        return choice
    row = pole_row(table, choice.frequency, choice.order, choice.damping_ratio)
    return replace(
        choice,
        frequency=float(table.frequency[row]),
        damping_ratio=float(table.damping_ratio[row]),
        order=int(table.order[row]),
    )


def with_pole_choice(
    chosen: ChosenSet, table: Stabilisation, choice: DeskChoice
) -> ChosenSet:
    """Return the chosen poles after a choice; others leave them as they are.

    A pole replaces the one on its track, or on its peak: a peak is chosen once.

    Raises:
        UsageError: there is nothing at the place of the choice.
    """
    if choice.action in {ChoiceAction.CHOOSE, ChoiceAction.PIN}:
        row = pole_row(table, choice.frequency, choice.order, choice.damping_ratio)
        pole = ChosenPole(_of_row(table, row), choice.action is ChoiceAction.PIN)
        left = [one for one in chosen if not _same_peak(one, pole)]
        return _sorted([*left, pole])
    if choice.action is ChoiceAction.CLEAR:
        low, high = sorted((choice.frequency, choice.second))
        left = [one for one in chosen if not low <= one.frequency <= high]
        if len(left) == len(chosen):
            raise UsageError(f"no pole is chosen between {low:.6g} and {high:.6g} Hz")
        return tuple(left)
    if choice.action is ChoiceAction.MERGE:
        return _merged(chosen, choice)
    return chosen


def _merged(chosen: ChosenSet, choice: DeskChoice) -> ChosenSet:
    one, other = (_nearest(chosen, f) for f in (choice.frequency, choice.second))
    if one == other:
        raise UsageError(
            f"{choice.frequency:.6g} and {choice.second:.6g} Hz are one chosen pole; "
            "a merge needs two"
        )
    pair = [chosen[one].candidate, chosen[other].candidate]
    steady = max(pair, key=lambda c: c.stable_orders)
    weight = [max(1, c.stable_orders) for c in pair]
    middle = sum(w * c.pole for w, c in zip(weight, pair, strict=True)) / sum(weight)
    made = ChosenPole(replace(steady, pole=complex(middle), by_hand=True))
    left = [c for i, c in enumerate(chosen) if i not in {one, other}]
    return _sorted([*left, made])


def _nearest(chosen: ChosenSet, frequency: float) -> int:
    away = [abs(one.frequency - frequency) for one in chosen]
    if not away or min(away) > _REACH * frequency:
        raise UsageError(f"no chosen pole within 1 % of {frequency:g} Hz")
    return int(np.argmin(away))


def _same_peak(one: ChosenPole, other: ChosenPole) -> bool:
    a, b = one.candidate, other.candidate
    near = abs(a.pole.imag - b.pole.imag) < _ONE_PEAK * abs(b.pole.real)
    return near or (a.track == b.track and a.track >= 0)


def _sorted(poles: Iterable[ChosenPole]) -> ChosenSet:
    return tuple(sorted(poles, key=lambda one: one.frequency))


def _of_row(table: Stabilisation, row: int) -> PoleCandidate:
    return _candidate(complex(table.pole[row]), table, int(table.track[row]), hand=True)


def _automatic(pole: complex, table: Stabilisation) -> ChosenPole:
    """Return an automatic pole with the track that passes nearest, -1 for none."""
    rows = np.flatnonzero(
        table.stable & (np.abs(table.pole.imag - pole.imag) < abs(pole.real))
    )
    track = -1
    if rows.size:
        track = int(table.track[rows[np.argmin(np.abs(table.pole[rows] - pole))]])
    return ChosenPole(_candidate(pole, table, track, hand=False))


def _candidate(
    pole: complex, table: Stabilisation, track: int, *, hand: bool
) -> PoleCandidate:
    own = (table.track == track) & table.stable if track >= 0 else table.track == -2
    if not own.any():
        return PoleCandidate(pole, (0.0, 0.0), 0, track, hand)
    frequency, ratio = table.frequency[own], table.damping_ratio[own]
    scatter = float(np.std(frequency)), float(np.std(ratio))
    return PoleCandidate(pole, scatter, int(np.count_nonzero(own)), track, hand)
