# SPDX-License-Identifier: MIT
"""The result of a machine as sentences and rows, for the terminal and the report."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.machine.machine_result import (
    AXES,
    MachineResult,
    VariantModes,
)

_NANO, _MICRO = 1e9, 1e6
_OVERDAMPED = "overdamped"
# Modes at speed that are named.
_SPLIT = 6
# Shapes with a smaller MAC have no partner.
_SIMILAR = 0.5


@dataclass(frozen=True, slots=True)
class TextTable:
    """A table as text.

    Attributes:
        title: with units where they are not in the columns.
        columns: heads.
        rows: cells.
        words: numbers of the columns of text.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: frozenset[int] = frozenset({0})


def mode_table(result: MachineResult) -> TextTable:
    """Return the jointed modes with their glued partners and weakest regions."""
    soft, rigid = result.jointed.modes, result.glued.modes
    rows = []
    for at, frequency in enumerate(soft.natural_frequency):
        partner, mac = int(result.pairs[at, 0]), result.pairs[at, 1]
        rows.append(
            (
                str(at + 1),
                f"{frequency:.4g}{_interval(result.frequency_interval, at)}",
                _damping_text(soft, at),
                _weakest(soft, at, {one.name for one in result.costs}),
                *_partner(rigid, partner, float(mac)),
            )
        )
    columns = (
        "mode",
        "jointed [Hz]",
        "damping [%]",
        "weakest region",
        "glued [Hz]",
        "MAC",
        "weakest if glued",
    )
    title = "Modes with joints, and the glued mode of the most similar shape (* joint)"
    return TextTable(title, columns, tuple(rows), frozenset({2, 3, 6}))


def _partner(modes: VariantModes, at: int, mac: float) -> tuple[str, str, str]:
    """Return frequency, MAC and weakest region of a glued mode that is similar."""
    if mac < _SIMILAR:
        return "-", "-", "-"
    return f"{modes.natural_frequency[at]:.4g}", f"{mac:.2f}", _weakest(modes, at)


def glued_table(result: MachineResult) -> TextTable:
    """Return the modes of the glued machine in order."""
    modes = result.glued.modes
    rows = tuple(
        (
            str(at + 1),
            f"{frequency:.4g}",
            _damping_text(modes, at),
            _weakest(modes, at),
            modes.motion.text(at),
        )
        for at, frequency in enumerate(modes.natural_frequency)
    )
    columns = ("mode", "glued [Hz]", "damping [%]", "weakest region", "detail")
    return TextTable("Modes with rigid joints", columns, rows, frozenset({3, 4}))


def shape_table(result: MachineResult) -> TextTable:
    """Return what moves and turns in the jointed modes."""
    modes = result.jointed.modes
    rows = tuple(
        (
            f"{frequency:.4g}",
            f"{100 * modes.motion.moving(at):.0f}",
            f"{100 * modes.motion.turning(at):.0f}",
            modes.motion.text(at),
        )
        for at, frequency in enumerate(modes.natural_frequency)
    )
    columns = ("jointed [Hz]", "moves [%]", "turns [%]", "detail")
    title = "Shapes with joints, by kinetic energy"
    return TextTable(title, columns, rows, frozenset({3}))


def tool_table(result: MachineResult) -> TextTable:
    """Return static and largest receptance at the tool."""
    soft, rigid = result.jointed.tool, result.glued.tool
    rows = []
    for at, axis in enumerate(AXES):
        static = _plain(_NANO * soft.static[at, at])
        if soft.static_interval is not None:
            low, high = _NANO * soft.static_interval[:, at]
            static += f" ({_plain(low)} to {_plain(high)})"
        rows.append(
            (
                axis,
                _plain(_NANO * rigid.static[at, at]),
                static,
                f"{_plain(_NANO * rigid.largest[at])} at {rigid.at[at]:.4g} Hz",
                f"{_plain(_NANO * soft.largest[at])} at {soft.at[at]:.4g} Hz",
            )
        )
    columns = (
        "axis",
        "static glued",
        "static jointed",
        "largest glued",
        "largest jointed",
    )
    title = "Receptance at the tool [nm/N]"
    return TextTable(title, columns, tuple(rows))


def _plain(value: float) -> str:
    """Return three digits, without an exponent up to a million."""
    text = f"{value:.3g}"
    return f"{float(text):.0f}" if 1e3 <= abs(value) < 1e6 else text


def cost_table(result: MachineResult) -> TextTable:
    """Return what each joint costs at the tool."""
    rows = tuple(
        (
            one.name,
            _three(100 * one.static, "{:.1f}"),
            _three(100 * (1 - one.static_gain), "{:.1f}"),
            _three(100 * (1 - one.dynamic_gain), "{:.1f}"),
        )
        for one in result.costs
    )
    columns = (
        "joint",
        "share of static compliance [%]",
        "static less if rigid [%]",
        "largest less if rigid [%]",
    )
    return TextTable("Joints at the tool, along x, y, z", columns, rows)


def motion_table(result: MachineResult) -> TextTable | None:
    """Return the largest displacements of the tool under the loads."""
    soft, rigid = result.jointed.motion, result.glued.motion
    if soft is None or rigid is None:
        return None
    rows = tuple(
        (
            axis,
            f"{_MICRO * rigid.largest[at]:.3g} at {rigid.largest_at[at]:.3g} s",
            f"{_MICRO * rigid.late[at]:.3g}",
            f"{_MICRO * soft.largest[at]:.3g} at {soft.largest_at[at]:.3g} s",
            f"{_MICRO * soft.late[at]:.3g}",
            f"{soft.late[at] / max(rigid.late[at], 1e-300):.2f}",
        )
        for at, axis in enumerate(AXES)
    )
    columns = (
        "axis",
        "largest glued",
        "last fifth",
        "largest jointed",
        "last fifth",
        "ratio",
    )
    title = "Displacement of the tool under the loads [um]"
    return TextTable(title, columns, rows)


def sentences(result: MachineResult) -> list[str]:
    """Return what the tables do not show: overdamped modes, chatter, accuracy."""
    found = [*mode_sentences(result), *chatter_sentences(result)]
    return found + bound_sentences(result)


def mode_sentences(result: MachineResult) -> list[str]:
    """Return overdamped modes, the size of the model and the accuracy of its modes."""
    size = (
        f"{result.freedoms} degrees of freedom, reduced to {result.size[0]}; jointed "
        f"frequencies are at most {100 * result.bound:.2g} % above those of the mesh"
    )
    return [_damping_sentence(result.jointed.modes), size, *_speed_sentence(result)]


def chatter_sentences(result: MachineResult) -> list[str]:
    """Return the widths of cut that are stable at every speed."""
    found = []
    for word, one in (("glued", result.glued), ("jointed", result.jointed)):
        if one.chatter is None:
            continue
        text = f"Chatter, {word}: "
        if not np.isfinite(one.chatter.limit):
            found.append(
                text + "the real part of the receptance is not negative in the band"
            )
            continue
        text += f"stable at every speed up to a width of {_width(one.chatter.limit)}"
        if word == "jointed" and result.limit_interval is not None:
            low, high = result.limit_interval
            text += f" (95 %: {_width(low)} to {_width(high)})"
        found.append(f"{text}; limited at {one.chatter.frequency:.4g} Hz")
    return found


def _speed_sentence(result: MachineResult) -> list[str]:
    """Return the lowest modes of a machine whose bodies turn."""
    if not result.speeds:
        return []
    turning = ", ".join(
        f"{name} at {30.0 * speed / np.pi:.4g} rpm"
        for name, speed in result.speeds.items()
    )
    lowest = ", ".join(
        f"{one:.4g}" for one in result.jointed.modes.oscillating[0, :_SPLIT]
    )
    return [
        f"Turning: {turning}. Tables of modes are those at rest; receptance, chatter "
        "and motion include gyroscopic moments. At speed the lowest modes with joints "
        f"have {lowest} Hz"
    ]


def bound_sentences(result: MachineResult) -> list[str]:
    """Return the bound of the error of the receptance at the tool."""
    bound = result.jointed.tool.bound
    if bound is None:
        return []
    text = "The jointed receptance at the tool is within "
    if np.isfinite(bound.largest):
        return [
            f"{text}{100 * bound.largest:.2g} % of that of the mesh, away from "
            "antiresonances"
        ]
    return [
        "The error of the receptance at the tool has no bound at "
        f"{np.isinf(bound.error).any(axis=0).sum()} of {bound.frequency.size} lines: "
        "choose a wider band"
    ]


def _damping_sentence(modes: VariantModes) -> str:
    """Return how many poles do not oscillate, and the lowest that do."""
    if not modes.overdamped:
        return "All modes oscillate."
    text = f"{modes.overdamped} real poles do not oscillate: modes are overdamped."
    over = modes.first_order > 1.0
    if over.any():
        largest = modes.first_order[over]
        text += (
            f" To first order {over.sum()} of {over.size} modes have a damping ratio "
            f"above 1 ({largest.min():.3g} to {largest.max():.3g})."
        )
    if modes.oscillating.shape[1]:
        frequency, ratio = modes.oscillating[:, 0]
        text += (
            f" The lowest mode that oscillates has {frequency:.4g} Hz and a damping "
            f"ratio of {ratio:.3g}."
        )
    return text


def _damping_text(modes: VariantModes, at: int) -> str:
    """Return the damping of a mode in per cent, or that it is overdamped."""
    if np.isnan(modes.damping_ratio[at]):
        return f"{_OVERDAMPED} ({modes.first_order[at]:.2g} x critical)"
    return f"{100 * modes.damping_ratio[at]:.3g}"


def _interval(interval: FloatArray | None, at: int) -> str:
    if interval is None or at >= interval.shape[1]:
        return ""
    return f" ({interval[0, at]:.4g} to {interval[1, at]:.4g})"


def _weakest(modes: VariantModes, at: int, joints: Collection[str] = ()) -> str:
    """Return the region with most of the energy, joints marked, and its share."""
    name, share = modes.energy.weakest(at)
    return f"{name}{'*' if name in joints else ''} {100 * share:.0f} %"


def _three(values: Sequence[float] | FloatArray, form: str) -> str:
    return ", ".join(
        form.format(abs(one) if abs(one) < 0.05 else one) for one in values
    )


def _width(value: float) -> str:
    return f"{1e3 * value:.3g} mm"
