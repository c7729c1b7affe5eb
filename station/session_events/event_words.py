# SPDX-License-Identifier: MIT
"""Events as lines of text."""

from jointbench.station.session_events.event_codec import Event
from jointbench.station.session_events.flow_events import (
    Asked,
    CableChanged,
    ConditionDone,
    RunBegun,
    Said,
    SamplesMissing,
    SessionEnded,
    Warned,
)
from jointbench.station.session_events.hit_events import (
    BoltRead,
    CheckDone,
    GainForecast,
    HitJudged,
    PreloadRead,
    SettingProposed,
)
from jointbench.station.session_events.operator_events import (
    CommandAnswered,
    ConditionReopened,
    NoteAdded,
    PauseChanged,
    WarningsSeen,
)
from jointbench.station.session_events.view_events import (
    BoltAsked,
    FileFinishing,
    HitAveraged,
    SessionBegun,
)


def event_words(event: Event) -> str:
    """Return an event in one line."""
    return f"{event.kind}: {_words(event)}"


def _words(event: Event) -> str:
    match event:
        case HitJudged():
            verdict = event.verdict.replace("_", " ")
            return (
                f"{event.number + 1} at point {event.point} {verdict}: {event.reason}"
            )
        case SettingProposed(name=name, value=value, reason=reason):
            return f"{name} {value:.4g}: {reason}"
        case CheckDone(name=name, passed=passed, value=value, limit=limit):
            word = "good" if passed else "LOOK AT IT"
            return f"{name} {word}, {value:.3g} (limit {limit:g})"
        case BoltRead(bolt=bolt, raw=raw, kept=kept):
            return f"{bolt} {raw}{'' if kept else ', not kept'}"
        case PreloadRead(name=name, preload=preload, preload_sd=sd, bolts=bolts):
            return (
                f"{name}: {preload / 1e3:.4g} kN, sd {sd / 1e3:.2g} kN, by {len(bolts)}"
                " bolts"
            )
        case RunBegun(name=name):
            return name
        case Asked(name=name, done=done, planned=planned):
            return f"{name} ({done} of {planned} conditions are done)"
        case ConditionDone(name=name, given_up=given_up):
            return f"{name} {'is given up' if given_up else 'is done'}"
        case Said(words=words) | Warned(words=words) | NoteAdded(words=words):
            return words
        case CableChanged(channels=channels):
            return channels
        case SamplesMissing(what=what, samples=samples, words=words):
            return f"{what}, {samples} samples missing ({words})"
        case FileFinishing(share=share):
            return f"{100 * share:.0f} % of the session file is written"
        case SessionEnded(interrupted=interrupted, reason=reason):
            return " ".join(("interrupted" if interrupted else "regularly", reason))
    return _view_words(event)


def _view_words(event: Event) -> str:
    match event:
        case SessionBegun(channels=channels, conditions=conditions):
            return f"{len(channels)} channels, {len(conditions)} conditions"
        case GainForecast(more=more, peaks=peaks):
            return f"{more} more hits: " + "; ".join(map(_gain, peaks))
        case HitAveraged(hit=hit, good=good, wanted=wanted):
            mean = event.mean_coherence
            coherence = "" if mean is None else f", coherence {mean:.3f}"
            return f"after hit {hit + 1}, {good} of {wanted} good{coherence}"
        case CommandAnswered(number=number, by=by, done=done, words=words):
            kind = event.command.get("command", "")
            answer = "done" if done else "refused"
            return f"{number} of {by}: {kind}, {answer}: {words}"
        case PauseChanged(paused=paused):
            return "hits are ignored" if paused else "over"
        case WarningsSeen(count=count):
            return f"{count} warnings"
        case ConditionReopened(name=name):
            return name
        case BoltAsked(bolt=bolt, bolts=bolts, target=target):
            return f"bolt {bolt} of {bolts} to {target:g} N m"
    return ""


def _gain(peak: dict[str, float]) -> str:
    """Return the scatter of one resonance now and after further hits."""
    now, later = peak["frequency_sd"], peak["frequency_sd_after"]
    damping = 100 * peak["damping_sd"], 100 * peak["damping_sd_after"]
    return (
        f"{peak['frequency']:.1f} Hz from {now:.2g} to {later:.2g} Hz, damping from "
        f"{damping[0]:.2g} to {damping[1]:.2g} %"
    )
