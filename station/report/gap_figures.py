# SPDX-License-Identifier: MIT
"""Figures of a gap: before and after, in the representative record and view."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.evidence_records import RecordEstimates, Spectra
from jointbench.station.drawing.palette import GUIDE, MEASURED
from jointbench.station.report.gap_bars import (
    AFTER,
    BEFORE,
    LOWEST_BAR,
    SMALLEST_TOP,
)
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.traces import Trace, line, markers


def pretty(unit: str) -> str:
    """Write powers in a unit as raised figures.

    >>> pretty("m/s^2/N")
    'm/s²/N'
    """
    for power, raised in (("^2", "²"), ("^3", "³")):
        unit = unit.replace(power, raised)
    return unit


def residual_spectrum(spectra: Spectra, *, tried: str) -> Figure:
    """Return the residual of all records over the noise against frequency."""
    x, y = spectrum_axes(spectra)
    return figure(spectrum(spectra, tried, shown=True), x, y)


def spectrum(
    spectra: Spectra,
    tried: str,
    *,
    axes: tuple[str, str] = ("x", "y"),
    shown: bool = False,
) -> list[Trace]:
    """Return residual over noise before and after, and the noise, as lines."""
    f = spectra.frequency
    floor = line(
        f[[0, -1]],
        np.ones(2),
        "noise",
        color=GUIDE,
        dash="dash",
        axes=axes,
        legend=shown,
    )
    traces = [floor]
    for values, name, color in (
        (spectra.residual_before, "base model", BEFORE),
        (spectra.residual_after, tried, AFTER),
    ):
        if name:
            traces.append(line(f, values, name, color=color, axes=axes, legend=shown))
    return traces


def spectrum_axes(spectra: Spectra) -> tuple[dict[str, object], dict[str, object]]:
    """Return the axes of `spectrum`, both logarithmic."""
    top = max(float(spectra.residual_before.max()), SMALLEST_TOP)
    span = [float(np.log10(LOWEST_BAR)), float(np.log10(2.0 * top))]
    return axis("frequency [Hz]", log=True), axis(
        "residual over noise [-]", log=True, range=span
    )


def response_function(spectra: Spectra, *, tried: str) -> Figure:
    """Return measured and predicted FRFs of the representative condition."""
    kept = np.isfinite(spectra.measured)
    f = spectra.frequency[kept]
    traces = [
        line(f, spectra.measured[kept], "measured", color=MEASURED, width=3.4),
        line(f, spectra.before[kept], "base model", color=BEFORE),
    ]
    if tried:
        traces.append(line(f, spectra.after[kept], tried, color=AFTER, dash="dot"))
    return figure(
        traces,
        axis("frequency [Hz]", log=True),
        axis(f"{spectra.channel} over force [{pretty(spectra.unit)}]", log=True),
    )


def record_estimate_figure(
    estimates: RecordEstimates, *, against: str, tried: str, unit: str
) -> Figure:
    """Return joint stiffness and damping estimated from each record separately.

    Args:
        estimates: of the records.
        against: `level` or `preload`.
        tried: legend of the model with the effects; empty where there is none.
        unit: of level and preload.
    """
    x = estimates.level if against == "level" else estimates.preload
    met = [float(value) for value in np.unique(x)]
    ticks: dict[str, Any] = {"tickvals": met, "ticktext": [f"{v:g}" for v in met]}
    traces: list[Trace] = []
    for column, (name, color) in enumerate((("base model", BEFORE), (tried, AFTER))):
        if name:
            shift = 1.0 + 0.03 * column
            traces += _estimate_points(estimates, x * shift, column, name, color)
    return figure(
        traces,
        axis(f"{against} [{unit}]", log=True, domain=[0.0, 0.45], **ticks),
        axis("change of stiffness [%]"),
        xaxis2=axis(
            f"{against} [{unit}]", log=True, domain=[0.56, 1.0], anchor="y2", **ticks
        ),
        yaxis2=axis("change of damping [%]", anchor="x2"),
    )


def _estimate_points(
    estimates: RecordEstimates, x: FloatArray, column: int, name: str, color: str
) -> Sequence[Trace]:
    return [
        {
            **markers(
                x,
                100 * values[:, column],
                name,
                color=color,
                axes=axes,
                error=100 * sd[:, column],
            ),
            "showlegend": legend,
        }
        for values, sd, axes, legend in (
            (estimates.stiffness, estimates.stiffness_sd, ("x", "y"), True),
            (estimates.damping, estimates.damping_sd, ("x2", "y2"), False),
        )
    ]
