# SPDX-License-Identifier: MIT
"""Report section: modes over amplitude, as measured and as explanations predict."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.curve_records import (
    CurveEvidence,
    CurveMatch,
    ModeEvidence,
)
from jointbench.signal.amplitude.amplitude_curve import AmplitudeCurve
from jointbench.station.drawing.palette import GUIDE, MEASURED, MEMBERS, MODEL
from jointbench.station.report.gap_sentences import effect_words
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page_parts import DataTable, Item, Plot, Section, Text
from jointbench.station.screen.traces import Trace, band, line

_NORMAL_95 = 1.959964
_COLOURS = (MODEL, *MEMBERS)
_NO_LAW = "without a law"
_CAPTION = (
    "Change of natural frequency, and damping ratio, over the amplitude of the "
    "response. Shaded: measured, 95 %. Lines: the explanations at the same amplitudes, "
    "by the first harmonics of their laws, moved to the mean of the measured curve: a "
    "constant difference belongs to the base."
)


def curve_section(evidence: CurveEvidence) -> Section:
    """Return sentences, table and one figure for each mode with a curve."""
    items: list[Item] = [Text(words) for words in evidence.words]
    shown = [mode for mode in evidence.modes if mode.matches]
    if shown:
        items.append(_table(shown))
    items += [
        Plot(f"curve{mode.number}", f"{_name(mode)}. {_CAPTION}", curve_figure(mode))
        for mode in shown
    ]
    return Section("curves", "Modes over amplitude", tuple(items))


def _name(mode: ModeEvidence) -> str:
    return f"Mode {mode.number}, {mode.frequency:.4g} Hz"


def _table(modes: list[ModeEvidence]) -> DataTable:
    rows = [
        (
            _name(mode),
            _label(match),
            f"{100.0 * match.change:+.2g} %",
            f"{match.scale:.2f} ± {match.scale_sd:.2g}"
            if np.isfinite(match.scale)
            else "-",
            f"{match.chi2_per_dof:.2g}",
            match.words,
        )
        for mode in modes
        for match in mode.matches
    ]
    return DataTable(
        "Measured curves and explanations. The verdict does not depend on them",
        (
            "mode",
            "explanation",
            "predicted change of frequency",
            "measured over predicted",
            "chi2/dof",
            "outcome",
        ),
        tuple(rows),
    )


def _label(match: CurveMatch) -> str:
    if match.explanation == ("none",):
        return _NO_LAW
    return " + ".join(effect_words(one) for one in match.explanation)


def curve_figure(mode: ModeEvidence) -> Figure:
    """Return measured bands and predicted curves of one mode, in two panels.

    Args:
        mode: with a measured curve.

    Raises:
        ValueError: it has none.
    """
    curve = None if mode.measured is None else mode.measured.curve
    if curve is None:
        raise ValueError(f"mode {mode.number} has no curve")
    first = float(curve.frequency[0])
    percent = 100.0 * (curve.frequency / first - 1.0)
    panels = (
        ("x", "y", percent, 100.0 * curve.frequency_sd / first),
        ("x2", "y2", 100.0 * curve.damping_ratio, 100.0 * curve.damping_sd),
    )
    traces: list[Trace] = []
    for number, (x, y, value, sd) in enumerate(panels):
        traces += _measured(curve, value, sd, (x, y), legend=number == 0)
        for place, match in enumerate(mode.matches, 1):
            own, own_sd = _predicted(match, first, number)
            weight = 1.0 / (sd**2 + own_sd**2)
            level = own + float(weight @ (value - own) / weight.sum())
            last = place == len(mode.matches)
            traces.append(
                line(
                    curve.amplitude,
                    level,
                    _label(match),
                    color=GUIDE if last else _COLOURS[(place - 1) % len(_COLOURS)],
                    dash="dash" if last else "solid",
                    axes=(x, y),
                    legend=number == 0,
                )
            )
    label = f"amplitude at {curve.channel} [{curve.unit}]"
    return figure(
        traces,
        axis(label, log=True, domain=[0.0, 0.45]),
        axis("change of natural frequency [%]"),
        xaxis2=axis(label, log=True, domain=[0.55, 1.0], anchor="y2"),
        yaxis2=axis("damping ratio [%]", anchor="x2"),
    )


def _predicted(
    match: CurveMatch, first: float, panel: int
) -> tuple[FloatArray, FloatArray]:
    """Return a predicted curve and its sd [%]."""
    curve = match.curve
    if panel == 0:
        return 100.0 * (curve.frequency / first - 1.0), (
            100.0 * curve.frequency_sd / first
        )
    return 100.0 * curve.damping, 100.0 * curve.damping_sd


def _measured(
    curve: AmplitudeCurve,
    value: FloatArray,
    sd: FloatArray,
    axes: tuple[str, str],
    *,
    legend: bool,
) -> list[Trace]:
    """Return a measured curve with its band."""
    wide = _NORMAL_95 * sd
    shade = band(curve.amplitude, value - wide, value + wide, "", color=MEASURED)
    placed: list[Trace] = [
        {**trace, "xaxis": axes[0], "yaxis": axes[1], "showlegend": False}
        for trace in shade
    ]
    drawn = line(
        curve.amplitude, value, "measured", color=MEASURED, axes=axes, legend=legend
    )
    return [*placed, drawn]
