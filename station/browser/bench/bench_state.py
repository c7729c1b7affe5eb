# SPDX-License-Identifier: MIT
"""The state of a session as JSON types, for a screen: a function of its events."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from jointbench.station.bench_view.verdict_words import verdict_word
from jointbench.station.session_events.condition_states import condition_states
from jointbench.station.session_events.hit_events import GainForecast, HitJudged
from jointbench.station.session_events.session_state import SessionState

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_HITS = 24
"""Latest hits that are listed."""


def bench_state(state: SessionState) -> dict[str, Any]:
    """Return what a screen shows of a session, without what changes by the clock.

    Args:
        state: after the last event.
    """
    average = state.average
    return {
        "last": state.last,
        "begun": None if state.begun is None else _fields(state.begun),
        "asked": state.asked,
        "done": state.done,
        "planned": state.planned,
        "conditions": [
            {**_fields(one), "left": one.left} for one in condition_states(state)
        ],
        "hits": [_hit(state, n) for n in sorted(state.hits)[-_HITS:]],
        "struck": len(state.hits),
        "verdicts": dict(Counter(hit.verdict for hit in state.hits.values())),
        "trial": state.on_trial,
        "run": None if state.run is None else _fields(state.run),
        "tighten": None if state.tighten is None else _fields(state.tighten),
        "average": None if average is None else _fields(average),
        "gain": _gain(state),
        "settings": [_fields(one) for one in state.settings.values()],
        "checks": [_fields(one) for one in state.checks],
        "warnings": list(state.warnings[state.warnings_seen :]),
        "warnings_seen": state.warnings_seen,
        "messages": list(state.messages),
        "notes": list(state.notes),
        "answers": [_fields(one) for one in state.answers],
        "paused": state.paused,
        "lost": state.lost,
        "open_loops": state.open_loops,
        "ended": None if state.ended is None else _fields(state.ended),
        "first_time": state.first_time,
    }


def _fields(record: "DataclassInstance") -> dict[str, Any]:
    """Return a record of JSON types; long curves are not copied."""
    return {one.name: getattr(record, one.name) for one in fields(record)}


def _hit(state: SessionState, number: int) -> dict[str, Any]:
    hit: HitJudged = state.hits[number]
    condition = state.struck_for.get(number, "")
    return {
        "number": number,
        "point": hit.point,
        "condition": condition,
        "peak": hit.peak_force,
        "verdict": hit.verdict,
        "word": verdict_word(hit, trial=not condition),
        "reason": hit.reason,
    }


def _gain(state: SessionState) -> dict[str, Any] | None:
    """Return what the last hit bought, and what further ones would buy.

    The forecast before is comparable where it is of the same condition, and of the
    same resonances.
    """
    if not state.gains:
        return None
    now = state.gains[-1]
    before = state.gains[0] if len(state.gains) > 1 else None
    if before is not None and _condition(state, before) != _condition(state, now):
        before = None
    return {
        "hit": now.hit,
        "more": now.more,
        "peaks": [_peak(peak, before) for peak in now.peaks],
    }


def _condition(state: SessionState, gain: GainForecast) -> str:
    return state.struck_for.get(gain.hit, "")


def _peak(
    peak: Mapping[str, float], before: GainForecast | None
) -> dict[str, float | None]:
    """Return a resonance with its standard deviations before the last hit."""
    near = None
    if before is not None:
        near = min(
            before.peaks,
            key=lambda old: abs(old["frequency"] - peak["frequency"]),
            default=None,
        )
    if near is not None:
        apart = abs(near["frequency"] - peak["frequency"])
        if apart > 2 * near["damping"] * near["frequency"]:
            near = None
    return {
        **peak,
        "frequency_sd_before": None if near is None else near["frequency_sd"],
        "damping_sd_before": None if near is None else near["damping_sd"],
    }
