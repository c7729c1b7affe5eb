# SPDX-License-Identifier: MIT
"""Poles chosen by the operator instead of the automatic selection."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.modal.stabilisation import PoleCandidate, Stabilisation

# Largest distance of a pole from a given frequency, as a share of it.
_REACH = 0.01


@dataclass(frozen=True, slots=True)
class Choices:
    """Manual changes to the selection.

    Attributes:
        keep: frequencies [Hz] of poles to keep as modes.
        drop: frequencies [Hz] of poles to drop.
    """

    keep: tuple[float, ...] = ()
    drop: tuple[float, ...] = ()


def overrule(
    found: Sequence[PoleCandidate], table: Stabilisation, choices: Choices
) -> tuple[PoleCandidate, ...]:
    """Apply manual choices to the candidates.

    Args:
        found: automatic candidates.
        table: poles of all orders, to keep one that is not among the candidates.
        choices: manual.

    Returns:
        Candidates by ascending frequency; those kept by hand are marked.

    Raises:
        UsageError: no pole within 1 % of a frequency given.
    """
    left = list(found)
    for frequency in choices.drop:
        near = _nearest(left, frequency)
        if near is None:
            raise _nothing_at(frequency, [_hertz(c) for c in left], "drop")
        del left[near]
    for frequency in choices.keep:
        near = _nearest(left, frequency)
        if near is None:
            left.append(_from_table(table, frequency))
        else:
            left[near] = replace(left[near], by_hand=True)
    return tuple(sorted(left, key=lambda c: c.pole.imag))


def _hertz(candidate: PoleCandidate) -> float:
    return abs(candidate.pole) / (2.0 * np.pi)


def _nearest(found: Sequence[PoleCandidate], frequency: float) -> int | None:
    """Return the candidate nearest to a frequency, or None if none is near."""
    if not found:
        return None
    away = [abs(_hertz(c) - frequency) for c in found]
    near = int(np.argmin(away))
    return near if away[near] <= _REACH * frequency else None


def _from_table(table: Stabilisation, frequency: float) -> PoleCandidate:
    """Return the pole of the table nearest to a frequency."""
    if table.order.size == 0:
        raise _nothing_at(frequency, [], "keep")
    away = np.abs(table.frequency - frequency)
    near = int(np.argmin(away))
    if away[near] > _REACH * frequency:
        raise _nothing_at(frequency, [float(table.frequency[near])], "keep")
    track = table.track == table.track[near]
    return PoleCandidate(
        pole=complex(table.pole[near]),
        scatter=(
            float(np.std(table.frequency[track])),
            float(np.std(table.damping_ratio[track])),
        ),
        stable_orders=int(np.count_nonzero(table.stable & track)),
        track=int(table.track[near]),
        by_hand=True,
    )


def _nothing_at(frequency: float, there: Sequence[float], verb: str) -> UsageError:
    """Return the error that names the nearest poles."""
    near = sorted(there, key=lambda f: abs(f - frequency))[:3]
    places = ", ".join(f"{f:.6g}" for f in near) or "none at all"
    return UsageError(
        f"there is no pole within 1 % of {frequency:g} Hz to {verb}; nearest: {places}"
    )
