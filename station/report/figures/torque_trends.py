# SPDX-License-Identifier: MIT
"""Modes and links over the torque, or the preload, where a session has several."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.signal.modal.shape_checks import mac_matrix
from jointbench.station.drawing.palette import MODEL
from jointbench.station.pipeline.recordings_by_preload import preload_sd
from jointbench.station.report.figures.small_multiples import small_multiples
from jointbench.station.report.findings.interval_words import NORMAL_95
from jointbench.station.report.session_analysis import PreloadAnalysis
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.joint_text import parameter_text
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    Plot,
    Section,
)
from jointbench.station.screen.traces import markers
from jointbench.station.screen.value_text import with_sd

SAME_MODE = 0.2
"""Largest ln ratio of the frequencies of one mode at two torques [-]."""
_LEAST_MAC = 0.5
_HEIGHT = 330


@dataclass(frozen=True, slots=True, eq=False)
class TorqueStates:
    """States of a joint in the order of what clamps it.

    Attributes:
        title: torque or preload, with its unit.
        at: torque [N m] or preload [N], ascending, shape (n,).
        at_sd: standard uncertainty of measured preloads [N], else 0, shape (n,).
        states: modes and links there.
    """

    title: str
    at: FloatArray
    at_sd: FloatArray
    states: tuple[PreloadAnalysis, ...]

    def cells(self) -> list[str]:
        """Return what clamps each state as text, with one sd where measured."""
        pairs = zip(self.at.tolist(), self.at_sd.tolist(), strict=True)
        return [with_sd(value, sd) if sd else f"{value:g}" for value, sd in pairs]


def torque_states(preloads: Sequence[PreloadAnalysis]) -> TorqueStates | None:
    """Return states by their preload where it was measured, else by torque if stated.

    None where fewer than two states can be put in order.
    """
    torques = [_torque(one) for one in preloads]
    known = [t for t in torques if t is not None]
    by_torque = len(known) == len(preloads) and len(set(known)) == len(known)
    if all(_measured_sd(one) is not None for one in preloads):
        by_torque = False
    title = "torque on each bolt [N m]" if by_torque else "preload [N]"
    values = torques if by_torque else [one.preload for one in preloads]
    pairs = [
        (value, one)
        for value, one in zip(values, preloads, strict=True)
        if value is not None
    ]
    if len(pairs) < 2:
        return None
    pairs.sort(key=lambda pair: pair[0])
    at = np.array([value for value, _ in pairs])
    spread = [0.0 if by_torque else _measured_sd(one) or 0.0 for _, one in pairs]
    return TorqueStates(title, at, np.array(spread), tuple(one for _, one in pairs))


def _measured_sd(one: PreloadAnalysis) -> float | None:
    """Return the sd of a preload that was measured [N]; None where it was not."""
    recordings = one.modal.recordings
    if not all(r.preload_sd is not None for r in recordings):
        return None
    return preload_sd(recordings)


def _torque(one: PreloadAnalysis) -> float | None:
    """Return the torque that all recordings of a state were made at [N m]."""
    found = {
        float(value)
        for recording in one.modal.recordings
        for step in recording.provenance
        for name, value in step.detail
        if name == "torque" and not isinstance(value, str)
    }
    return found.pop() if len(found) == 1 else None


def trends_section(preloads: Sequence[PreloadAnalysis]) -> Section | None:
    """Return modes and links over torque or preload; None for fewer than two states.

    Args:
        preloads: modes and links at each.
    """
    states = torque_states(preloads)
    if states is None:
        return None
    models = [one.modal.result.model for one in states.states]
    tracks = track_modes(models)
    what = states.title.partition(" [")[0]
    title = (
        f"Each mode over the {what}: natural frequency and damping ratio with 95 % "
        "intervals. Modes are followed by frequency and shape."
    )
    plots = [
        _mode_plot(states, models, track, number)
        for number, track in enumerate(tracks, 1)
    ]
    items: list[Item] = small_multiples(title, plots, "modes")
    items.append(_mode_table(states, models, tracks))
    names = list(
        dict.fromkeys(
            one.name
            for state in states.states
            if state.joint is not None
            for one in state.joint.parameters
        )
    )
    links = [plot for at, name in enumerate(names) if (plot := _link(states, name, at))]
    said = f"Identified links over the {what}, with 95 % intervals."
    items += small_multiples(said, links, "parameters")
    if names:
        items.append(_link_table(states, names))
    return Section("trends", f"Modes and joint over {what}", tuple(items))


def track_modes(models: Sequence[ModalModel]) -> list[IntArray]:
    """Follow modes through states.

    Args:
        models: in the order of the states.

    Returns:
        For each mode its index in every state, -1 where it was not found; modes in
        order of frequency.
    """
    most = int(np.argmax([one.natural_frequency.size for one in models]))
    order = [*range(most, len(models)), *range(most - 1, -1, -1)]
    count = models[most].natural_frequency.size
    tracks = [np.full(len(models), -1) for _ in range(count)]
    for number in range(count):
        tracks[number][most] = number
    for state in order[1:]:
        before = state - 1 if state > most else state + 1
        own = [int(track[before]) for track in tracks]
        for row, column in _pairs(models[before], models[state], own, models[most]):
            tracks[row][state] = column
    return tracks


def _pairs(
    one: ModalModel, other: ModalModel, own: Sequence[int], first: ModalModel
) -> list[tuple[int, int]]:
    """Return pairs of a track and a mode of the next state.

    Args:
        one: the state before.
        other: the next state.
        own: index of each track in the state before, -1 where it was lost.
        first: the state that all tracks come from.
    """
    frequency = np.array(
        [
            one.natural_frequency[at] if at >= 0 else first.natural_frequency[track]
            for track, at in enumerate(own)
        ]
    )
    shapes = np.array(
        [one.shapes[at] if at >= 0 else first.shapes[t] for t, at in enumerate(own)]
    )
    if not frequency.size or not other.natural_frequency.size:
        return []
    ratio = np.abs(np.log(other.natural_frequency[None, :] / frequency[:, None]))
    cost = ratio / SAME_MODE
    alike = np.ones_like(ratio, bool)
    if shapes.shape[1:] == other.shapes.shape[1:] and shapes.shape[1] > 1:
        mac = mac_matrix(shapes, other.shapes)
        cost, alike = cost + (1.0 - mac), mac >= _LEAST_MAC
    rows, columns = linear_sum_assignment(cost)
    return [
        (int(i), int(j))
        for i, j in zip(rows, columns, strict=True)
        if ratio[i, j] < SAME_MODE and alike[i, j]
    ]


def _mode_plot(
    states: TorqueStates, models: Sequence[ModalModel], track: IntArray, number: int
) -> Plot:
    seen = np.flatnonzero(track >= 0)
    picked = [(models[s], int(track[s])) for s in seen.tolist()]
    frequency = np.array([m.natural_frequency[k] for m, k in picked])
    damping = np.array([100 * m.damping_ratio[k] for m, k in picked])
    wide = NORMAL_95 * np.array([m.frequency_sd[k] for m, k in picked])
    ratio_wide = 100 * NORMAL_95 * np.array([m.damping_ratio_sd[k] for m, k in picked])
    at, at_wide = states.at[seen], NORMAL_95 * states.at_sd[seen]
    traces = [
        _points(at, frequency, wide, "y", at_wide),
        _points(at, damping, ratio_wide, "y2", at_wide),
    ]
    plot = figure(
        traces,
        axis(states.title),
        axis("natural frequency [Hz]", domain=[0.5, 1.0]),
        yaxis2=axis("damping ratio [%]", domain=[0.0, 0.5]),
    )
    caption = f"mode {number}, {frequency[0]:.5g} to {frequency[-1]:.5g} Hz"
    return Plot(f"trend-mode-{number}", caption, plot, _HEIGHT)


def _points(
    x: FloatArray, y: FloatArray, wide: FloatArray, place: str, x_wide: FloatArray
) -> Figure:
    trace = markers(x, y, "", color=MODEL, size=7, axes=("x", place), error=wide)
    line = {"color": MODEL, "width": 1, "dash": "dot"}
    if x_wide.any():
        trace = {**trace, "error_x": {"array": x_wide.tolist()}}
    return {**trace, "mode": "lines+markers", "line": line, "showlegend": False}


def _link(states: TorqueStates, name: str, number: int) -> Plot | None:
    """Return one parameter over its states; None where it is never identifiable."""
    found, unit = [], ""
    clamped = zip(states.at, states.at_sd, states.states, strict=True)
    for at, at_sd, state in clamped:
        joint = state.joint
        known = [] if joint is None else [p for p in joint.parameters if p.name == name]
        if known and known[0].identifiable:
            low, high = known[0].interval
            value = known[0].value
            found.append((at, at_sd, value, low or value, high or value))
            unit = known[0].unit
    if not found:
        return None
    x, x_sd, y, lower, upper = np.array(found, float).T
    trace = {
        **_points(x, y, upper - y, "y", NORMAL_95 * x_sd),
        "error_y": {
            "symmetric": False,
            "array": (upper - y).tolist(),
            "arrayminus": (y - lower).tolist(),
        },
    }
    kind = name.rpartition(".")[2] or name
    plot = figure([trace], axis(states.title), axis(f"{kind} [{unit}]"))
    return Plot(f"trend-link-{number}", name, plot, 240)


def _mode_table(
    states: TorqueStates, models: Sequence[ModalModel], tracks: Sequence[IntArray]
) -> DataTable:
    rows = []
    for number, track in enumerate(tracks, 1):
        for at, model, k in zip(states.cells(), models, track.tolist(), strict=True):
            if k >= 0:
                f, sd = model.natural_frequency[k], model.frequency_sd[k]
                zeta, zeta_sd = model.damping_ratio[k], model.damping_ratio_sd[k]
                cells = with_sd(f, sd), with_sd(100 * zeta, 100 * zeta_sd)
            else:
                cells = "-", "-"
            rows.append((str(number), at, *cells))
    return DataTable(
        "Modes by state, with one standard deviation; - where a mode was not found.",
        ("mode", states.title, "frequency [Hz]", "damping ratio [%]"),
        tuple(rows),
    )


def _link_table(states: TorqueStates, names: Sequence[str]) -> DataTable:
    rows = []
    for name in names:
        for at, state in zip(states.cells(), states.states, strict=True):
            joint = state.joint
            known = [] if joint is None else joint.parameters
            for one in known:
                if one.name == name:
                    rows.append((name, at, parameter_text(one), one.unit))
    return DataTable(
        "Identified links by state (± one standard deviation; admissible range if not "
        "identifiable).",
        ("parameter", states.title, "value", "unit"),
        tuple(rows),
    )
