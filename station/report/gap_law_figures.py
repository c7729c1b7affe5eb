# SPDX-License-Identifier: MIT
"""Figures of the force laws of an explanation: loops, f(a) and zeta(a) with bands."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.evidence_records import GapEvidence
from jointbench.analysis.gap.model.law_curves import LawCurves
from jointbench.station.drawing.palette import MEMBERS, MODEL
from jointbench.station.report.gap_sentences import effect_words
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page_parts import Plot
from jointbench.station.screen.traces import Trace, band, line

_NORMAL_95 = 1.959964
_MICRO = 1e6


def law_plots(evidence: GapEvidence | None) -> tuple[Plot, ...]:
    """Return one figure for each force law of an explanation; none without one."""
    if evidence is None:
        return ()
    return tuple(
        Plot(f"law{number}", _caption(curves), law_figure(curves), 380)
        for number, curves in enumerate(evidence.laws, 1)
    )


def _caption(curves: LawCurves) -> str:
    largest = _MICRO * float(curves.amplitude[-1])
    return (
        f"{effect_words(curves.label)}: force of the law over the motion across the "
        "joint, without its linear spring and dashpot; natural frequency and damping "
        "ratio over the amplitude of that motion, by its first harmonic, this law "
        f"alone. Bands: 95 %. Range: up to {largest:.3g} µm, the largest motion in the "
        f"records. Source: {curves.source}."
    )


def law_figure(curves: LawCurves) -> Figure:
    """Return loops, and change of frequency and damping ratio over amplitude."""
    traces = _loops(curves)
    amplitude = _MICRO * curves.amplitude
    for mode, frequency in enumerate(curves.frequency):
        first = float(frequency[0])
        name = f"mode {mode + 1}, {first:.4g} Hz"
        change = 100.0 * (frequency / first - 1.0)
        change_sd = 100.0 * curves.frequency_sd[mode] / first
        ratio, ratio_sd = 100.0 * curves.damping[mode], 100.0 * curves.damping_sd[mode]
        traces += _curve(amplitude, change, change_sd, name, mode, ("x2", "y2"))
        traces += _curve(amplitude, ratio, ratio_sd, "", mode, ("x3", "y3"))
    label = "amplitude [µm]"
    return figure(
        traces,
        axis("motion [µm]", domain=[0.0, 0.27]),
        axis("force of the law [N]"),
        xaxis2=axis(label, log=True, domain=[0.37, 0.64], anchor="y2"),
        yaxis2=axis("change of natural frequency [%]", anchor="x2"),
        xaxis3=axis(label, log=True, domain=[0.73, 1.0], anchor="y3"),
        yaxis3=axis("damping ratio [%]", anchor="x3"),
    )


def _loops(curves: LawCurves) -> list[Trace]:
    """Return the loops, the widest first, between thin lines of their bands."""
    traces: list[Trace] = []
    for number, motion in enumerate(curves.motion):
        x, force = _MICRO * motion, curves.force[number]
        wide = _NORMAL_95 * curves.force_sd[number]
        name = f"{x.max():.3g} µm"
        color = MODEL
        for edge in (force - wide, force + wide):
            traces.append(line(x, edge, "", color=color, width=0.6, legend=False))
        traces.append(line(x, force, name, color=color, legend=False))
    return traces


def _curve(
    x: FloatArray,
    value: FloatArray,
    sd: FloatArray,
    name: str,
    mode: int,
    axes: tuple[str, str],
) -> list[Trace]:
    """Return a curve with its band; a mode that has no pole is left out."""
    seen = np.isfinite(value) & np.isfinite(sd)
    x, value, wide = x[seen], value[seen], _NORMAL_95 * sd[seen]
    shade = band(x, value - wide, value + wide, "", color=MEMBERS[mode % len(MEMBERS)])
    placed: list[Trace] = [
        {**trace, "xaxis": axes[0], "yaxis": axes[1], "showlegend": False}
        for trace in shade
    ]
    color = MEMBERS[mode % len(MEMBERS)]
    return [*placed, line(x, value, name, color=color, axes=axes, legend=bool(name))]
