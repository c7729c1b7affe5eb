# SPDX-License-Identifier: MIT
"""The report's section on modes over their amplitude."""

from jointbench.signal.amplitude.amplitude_curve import AmplitudeMode
from jointbench.station.drawing.palette import MEASURED
from jointbench.station.pipeline.amplitude_summary import COLUMNS, amplitude_rows
from jointbench.station.pipeline.chain import ModalChain
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page_parts import DataTable, Plot, Section
from jointbench.station.screen.traces import Trace, band, line

_NORMAL_95 = 1.959964


def amplitude_sections(chain: ModalChain) -> tuple[Section, ...]:
    """Return the section on amplitude dependence; none where it was not looked at."""
    if not chain.amplitude:
        return ()
    table = DataTable(
        "Whether each mode depends on amplitude, from the decays of all hits; changes "
        "from the softest to the hardest amplitude that the decays hold.",
        COLUMNS,
        amplitude_rows(chain.amplitude),
    )
    plots = [
        _curve_plot(number, mode)
        for number, mode in enumerate(chain.amplitude, 1)
        if mode.curve is not None
    ]
    return (Section("amplitude", "Modes over amplitude", (table, *plots)),)


def _curve_plot(number: int, mode: AmplitudeMode) -> Plot:
    """Return f(a) and zeta(a) of a mode with 95 % bands."""
    curve = mode.curve
    assert curve is not None
    x = curve.amplitude
    traces: list[Trace] = []
    for row, (value, sd, name) in enumerate(
        (
            (curve.frequency, curve.frequency_sd, "natural frequency"),
            (100 * curve.damping_ratio, 100 * curve.damping_sd, "damping ratio"),
        )
    ):
        y = ("y", "y2")[row]
        shade = band(
            x,
            value - _NORMAL_95 * sd,
            value + _NORMAL_95 * sd,
            f"{name}, 95 % band",
            color=MEASURED,
        )
        traces += [{**trace, "yaxis": y} for trace in shade]
        traces.append(line(x, value, name, color=MEASURED, axes=("x", y)))
    plot = figure(
        traces,
        axis(f"amplitude at {curve.channel} [{curve.unit}]", log=True, anchor="y2"),
        axis("frequency [Hz]", domain=[0.55, 1.0]),
        yaxis2=axis("damping ratio [%]", domain=[0.0, 0.45]),
    )
    caption = f"Mode {number} near {mode.soft.frequency:.5g} Hz: {mode.words()}."
    return Plot(f"amplitude-plot-{number}", caption, plot, 460)
