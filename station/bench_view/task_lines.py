# SPDX-License-Identifier: MIT
"""What to do next in block letters, and the verdict in a band of colour."""

from collections.abc import Iterator

from rich.text import Text

from jointbench.acquisition.file_access.quoting import visible
from jointbench.acquisition.records.recordings import Verdict
from jointbench.station.bench_view.big_letters import big_lines, big_width
from jointbench.station.bench_view.verdict_words import verdict_word
from jointbench.station.session_events.condition_states import (
    ConditionMark,
    condition_states,
)
from jointbench.station.session_events.session_state import SessionState

GOOD, TRIAL, BAD = "bold black on green", "bold black on cyan", "bold white on red"


def task_lines(state: SessionState, *, width: int, tall: bool) -> Iterator[Text]:
    """Yield what the operator does next: block letters, then one line of words.

    Args:
        state: of the session.
        width: columns.
        tall: whether there is room for large letters.
    """
    letters, words, style = _task(state)
    large = tall and big_width(letters, large=True) <= width
    if big_width(letters, large=large) <= width:
        for line in big_lines(letters, large=large):
            yield Text(line, style=style)
    else:
        yield Text(visible(letters).ljust(width), style=f"{style} reverse")
    yield Text(visible(words), style="bold")


def verdict_lines(state: SessionState, *, width: int, tall: bool) -> Iterator[Text]:
    """Yield the verdict on the last hit in a band of its colour, and the reason."""
    average = state.average
    if average is None or average.hit not in state.hits:
        return
    hit = state.hits[average.hit]
    word = verdict_word(hit, trial=average.trial)
    style = GOOD if hit.verdict == Verdict.OK else TRIAL if word == "trial" else BAD
    empty = Text(" " * width, style=style)
    title = f"HIT {average.hit + 1}  {word.upper()}  {average.good}/{average.wanted}"
    yield from (empty,) if tall else ()
    yield Text(visible(title).center(width), style=style)
    yield from (empty,) if tall else ()
    yield Text(visible(f"{hit.peak_force:.4g} N at {hit.point}; {hit.reason}"))


def gain_lines(state: SessionState, *, width: int) -> Iterator[Text]:
    """Yield what further hits would buy, in one line; the worst resonances come first.

    Only resonances that fit the width whole are named, one at least.
    """
    gain = state.gains[-1] if state.gains else None
    average = state.average
    if gain is None or not gain.peaks or average is None or gain.hit != average.hit:
        return
    peaks = sorted(gain.peaks, key=lambda peak: -peak["damping_sd"])
    words = [_gain(peak) for peak in peaks]
    line = f"{gain.more} more hits: {words[0]}"
    for more in words[1:]:
        if len(line) + len(more) + 2 > width:
            break
        line += f"; {more}"
    yield Text(line)


def _gain(peak: dict[str, float]) -> str:
    """Return a resonance with its scatter now and after further hits."""
    damping, after = 100 * peak["damping_sd"], 100 * peak["damping_sd_after"]
    return (
        f"{peak['frequency']:.1f} Hz ±{peak['frequency_sd']:.2g} to "
        f"±{peak['frequency_sd_after']:.2g} Hz, damping ±{damping:.2g} to "
        f"±{after:.2g} %"
    )


def _task(state: SessionState) -> tuple[str, str, str]:
    """Return the task in block letters and in words, and its style."""
    if state.ended is not None:
        how = "interrupted" if state.ended.interrupted else "all is recorded"
        words = f"the recording has ended: {how}"
        if state.finishing is not None:
            words += f"; {100 * state.finishing:.0f} % of the session file is written"
        return "END", words, "bold"
    if state.begun is None and state.last < 0:
        return "WAIT", "the device and the session file are opened", "bold"
    if state.disconnected:
        words = "the connection to the device is lost; hits wait until it is back"
        return "LOST", words, "bold red"
    if state.open_loops:
        words = f"sensor loop open: {state.open_loops}; hits wait for the cable"
        return "CABLE", words, "bold red"
    if state.paused:
        return "PAUSE", "hits are ignored; space continues", "bold yellow"
    if state.tighten is not None:
        bolt = state.tighten
        letters = f"BOLT {bolt.bolt} {bolt.target:g} Nm"
        return letters, f"tighten bolt {bolt.bolt} of {bolt.bolts}", "bold magenta"
    if state.run is not None and state.run.duration is not None:
        words = f"{state.run.purpose} run {state.run.name!r} is recorded"
        return "REC", f"{words}, {state.run.duration:g} s", "bold red"
    if not state.asked:
        return "WAIT", "keep the hammer still: its noise is measured", "bold"
    return _strike(state)


def _strike(state: SessionState) -> tuple[str, str, str]:
    now = next(
        (c for c in condition_states(state) if c.mark is ConditionMark.NOW), None
    )
    if now is None:
        if state.asked in state.finished:
            return "WAIT", f"{state.asked} is done; the next point follows", "bold"
        return "HIT", f"hit {state.asked}", "bold"
    direction = state.begun.direction if state.begun is not None else ""
    torque = "" if now.torque is None else f" {now.torque:g} Nm"
    letters = f"{now.point} {direction}{torque}"
    words = f"{'trial hit: ' if state.on_trial else ''}strike point {now.point}"
    words += f" in {direction}" if direction else ""
    words += f", bolts at {now.torque:g} N m" if torque else ""
    words += f", peak {now.level:g} N" if now.level is not None else ""
    return letters, words, "bold cyan" if state.on_trial else "bold"
