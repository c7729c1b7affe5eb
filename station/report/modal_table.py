# SPDX-License-Identifier: MIT
"""What ``jointbench modal`` prints: verdicts, modes by confidence, notes."""

import numpy as np
from rich.console import Console
from rich.text import Text

from jointbench.acquisition.basics.arrays import BoolArray
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.amplitude.amplitude_curve import Dependence
from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.mode_ranking import (
    FEW_ORDERS,
    Grade,
    ModeConfidence,
    rate_modes,
)
from jointbench.station.pipeline.amplitude_summary import (
    COLUMNS as COLUMNS_OVER_AMPLITUDE,
)
from jointbench.station.pipeline.amplitude_summary import amplitude_rows
from jointbench.station.pipeline.chain import ModalChain
from jointbench.station.pipeline.modal_notes import ModalNotes
from jointbench.station.screen.terminal import console, table
from jointbench.station.screen.value_text import with_sd

COLUMNS = (
    "mode",
    "natural frequency [Hz]",
    "systematic part",
    "damping ratio [%]",
    "systematic",
    "orders",
    "rank",
    "confidence",
    "remark",
)


def show_modal(chain: ModalChain, notes: ModalNotes, json_target: str | None) -> None:
    """Print verdicts, modes and notes."""
    screen = console(json_target)
    for recording in chain.recordings:
        for line in _hit_lines(recording):
            screen.print(line)
    if not chain.recordings:
        screen.print(Text(frf_words(chain.frf)))
    for words in notes.limits:
        screen.print(Text(f"warning: {words}"))
    model = chain.result.model
    orders = chain.result.stabilisation.orders.size
    rated = rate_modes(model, orders)
    doubtful = np.array([grade is Grade.DOUBTFUL for grade in rated.grades], bool)
    apart: BoolArray = doubtful & ~model.by_hand
    low, high = chain.result.band
    title = f"Modes between {low:.0f} and {high:.0f} Hz (± one standard deviation)"
    _show_modes(screen, title, chain, rated, ~apart)
    _show_modes(
        screen,
        f"Doubtful: stable at less than {100 * FEW_ORDERS:.0f} % of {orders} orders",
        chain,
        rated,
        apart,
    )
    screen.print()
    for line in (*_legend(chain), *(f"note: {words}" for words in notes.remarks())):
        screen.print(Text(line))
    _show_amplitude(screen, chain)
    _show_beyond(screen, notes)


def frf_words(frf: Frf) -> str:
    """Return one line on FRFs that come from files, or from runs with a shaker."""
    outputs, inputs, lines = frf.response.shape
    done = [dict(one.detail) for one in frf.provenance if one.name == "frf"]
    blocks = done[-1].get("blocks") if done else None
    origin = "FRFs from files"
    if blocks is not None:
        origin = f"FRFs of a shaker run, {blocks} blocks of {done[-1]['block_s']:.3g} s"
    return (
        f"{origin}: {frf.kind.value}, {outputs} output{'s' * (outputs > 1)} x "
        f"{inputs} input{'s' * (inputs > 1)}, {lines} lines from "
        f"{frf.frequency[0]:g} to {frf.frequency[-1]:g} Hz"
    )


def _show_modes(
    screen: Console,
    title: str,
    chain: ModalChain,
    rated: ModeConfidence,
    shown: BoolArray,
) -> None:
    if not shown.any():
        return
    rows = [_row(chain, rated, int(i)) for i in np.flatnonzero(shown)]
    last = len(COLUMNS) if any(row[-1] for row in rows) else len(COLUMNS) - 1
    screen.print(table(title, COLUMNS[:last], [row[:last] for row in rows]))


def _row(chain: ModalChain, rated: ModeConfidence, number: int) -> tuple[str, ...]:
    model = chain.result.model
    frequency, ratio = model.natural_frequency[number], model.damping_ratio[number]
    error = rated.frequency_error[number]
    return (
        str(number + 1),
        with_sd(frequency, model.frequency_sd[number]),
        f"{error:.2g} Hz, {100 * error / frequency:.1g} %",
        with_sd(100 * ratio, 100 * model.damping_ratio_sd[number]),
        f"{100 * rated.damping_error[number] / abs(ratio):.2g} %",
        f"{model.stable_orders[number]}",
        f"{rated.rank[number]}",
        rated.grades[number].value,
        remark(chain, rated, number),
    )


def remark(chain: ModalChain, rated: ModeConfidence, number: int) -> str:
    """Note a mode kept by the user, and one that may be background."""
    words = ["kept by user"] if chain.result.model.by_hand[number] else []
    if rated.broad[number]:
        words.append("broad: background?")
    return ", ".join(words)


def _show_amplitude(screen: Console, chain: ModalChain) -> None:
    """Show modes that depend on amplitude or may; count those that do not."""
    shown = [m for m in chain.amplitude if m.dependence is not Dependence.NONE]
    plain = len(chain.amplitude) - len(shown)
    reasons = {mode.reason for mode in shown}
    if len(reasons) == 1 and not any(mode.curve for mode in shown):
        words = f"amplitude dependence not decided: {reasons.pop()}"
        screen.print(Text(words))
    elif shown:
        title = "Modes over amplitude"
        screen.print(table(title, COLUMNS_OVER_AMPLITUDE, amplitude_rows(shown)))
    if plain:
        screen.print(
            Text(f"{plain} of {len(chain.amplitude)} modes do not depend on amplitude")
        )


def _show_beyond(screen: Console, notes: ModalNotes) -> None:
    rows = [
        (
            f"{peak.frequency:.1f}",
            f"{peak.height:.2g}",
            "-" if peak.coherence is None else f"{peak.coherence:.3f}",
            "-" if peak.force_drop is None else f"{peak.force_drop:.0f}",
        )
        for peak in notes.beyond.peaks
    ]
    if rows:
        columns = (
            "peak [Hz]",
            "height [of highest in band]",
            "coherence [-]",
            "force [dB]",
        )
        screen.print(table("Above the band, not fitted", columns, rows))


def _legend(chain: ModalChain) -> tuple[str, ...]:
    gain = chain.result.stage_gain
    words = (
        "systematic: part of the interval from model error around a mode (leakage, a "
        "missing neighbour, nonlinearity); more hits do not reduce it"
    )
    if gain is None:
        return (words,)
    least, most, phase = gain.gain.min(), gain.gain.max(), np.abs(gain.phase).max()
    stage = (
        f"Kalman stage at the modes: |W| {least:.4f} to {most:.4f}, phase within "
        f"{np.degrees(phase):.1f} deg; equal on all channels, so it cancels in the FRF"
    )
    return (words, stage)


def _hit_lines(recording: Recording) -> list[str]:
    good = sum(hit.verdict == "ok" for hit in recording.hits)
    bad = [
        f"  hit {number} {hit.verdict.value}: {hit.reason}"
        for number, hit in enumerate(recording.hits, 1)
        if hit.verdict != "ok"
    ]
    line = f"{recording.name}: {good} of {len(recording.hits)} hits accepted"
    return [line, *bad]
