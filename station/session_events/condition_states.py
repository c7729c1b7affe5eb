# SPDX-License-Identifier: MIT
"""The conditions of a session: which are done, open, or incomplete."""

from collections import Counter
from dataclasses import dataclass
from enum import StrEnum

from jointbench.station.session_events.session_state import SessionState

_GOOD = "ok"


class ConditionMark(StrEnum):
    """Where a condition stands."""

    DONE = "done"
    OPEN = "open"
    INCOMPLETE = "incomplete"
    NOW = "now"


@dataclass(frozen=True, slots=True)
class ConditionState:
    """One condition of the plan.

    Attributes:
        name: of the condition.
        point: to strike.
        torque: on each bolt [N m], None if not given.
        level: peak force to aim at [N], None for any.
        good: accepted hits.
        wanted: accepted hits that it needs.
        mark: where it stands.
    """

    name: str
    point: str
    torque: float | None
    level: float | None
    good: int
    wanted: int
    mark: ConditionMark

    @property
    def left(self) -> int:
        """Accepted hits that are still needed."""
        closed = self.mark in {ConditionMark.DONE, ConditionMark.INCOMPLETE}
        return 0 if closed else max(0, self.wanted - self.good)


def condition_states(state: SessionState) -> tuple[ConditionState, ...]:
    """Return the conditions in the order of the plan; none in older recordings."""
    begun = state.begun
    if begun is None:
        return ()
    good = Counter(
        state.struck_for[number]
        for number, hit in state.hits.items()
        if hit.verdict == _GOOD
    )
    return tuple(
        ConditionState(
            name=str(row["name"]),
            point=str(row["point"]),
            torque=row.get("torque"),
            level=row.get("level"),
            good=good[str(row["name"])],
            wanted=begun.repeats,
            mark=_mark(state, str(row["name"])),
        )
        for row in begun.conditions
    )


def seconds_left(state: SessionState, now: float) -> float | None:
    """Estimate the remaining time from the time that each good hit has taken.

    Args:
        state: of the session.
        now: time since 1970 [s].

    Returns:
        The time [s]; None before the first good hit.
    """
    conditions = condition_states(state)
    good = sum(one.good for one in conditions)
    if not good or state.first_time is None:
        return None
    left = sum(one.left for one in conditions)
    return left * (now - state.first_time) / good


def _mark(state: SessionState, name: str) -> ConditionMark:
    if name in state.finished:
        given_up = state.finished[name]
        return ConditionMark.INCOMPLETE if given_up else ConditionMark.DONE
    return ConditionMark.NOW if name == state.asked else ConditionMark.OPEN
