# SPDX-License-Identifier: MIT
"""The report's sections on FRFs, stabilisation and modes."""

import numpy as np

from jointbench.signal.frf.frf_of_functions import noise_source
from jointbench.station.drawing.palette import GOOD, GUIDE, MEASURED, MODEL
from jointbench.station.pipeline.chain import ModalChain
from jointbench.station.pipeline.modal_summary import (
    STAGE_COLUMNS,
    stage_cells,
    synthesis_error,
)
from jointbench.station.report.amplitude_section import amplitude_sections
from jointbench.station.report.checks_section import checks_section, systematic_words
from jointbench.station.report.figures.frf_figures import (
    frf_figures,
    shown_band,
)
from jointbench.station.report.figures.small_multiples import small_multiples
from jointbench.station.report.shapes_section import shapes_section
from jointbench.station.schemas.geometry_file import Geometry
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page_parts import DataTable, Item, Plot, Section, Text
from jointbench.station.screen.plot_numbers import thin
from jointbench.station.screen.traces import line, markers
from jointbench.station.screen.value_text import with_sd

MOST_POINTS = 4000


def modal_sections(
    chain: ModalChain, geometry: Geometry | None = None
) -> tuple[Section, ...]:
    """Return the sections FRF, stabilisation, modes, amplitude, shapes, checks."""
    return (
        Section(
            "frf",
            "Frequency response",
            (*_frf_items(chain), Text(_window(chain))),
        ),
        Section("stabilisation", "Stabilisation", (_stabilisation_plot(chain),)),
        Section(
            "modes",
            "Modes",
            (modes_table(chain), Text(_systematic(chain)), Text(_kalman(chain))),
        ),
        *amplitude_sections(chain),
        shapes_section(chain, geometry),
        checks_section(chain),
    )


def _frf_items(chain: ModalChain) -> list[Item]:
    """Return a small figure of each FRF; those of the driving point come first."""
    frf = chain.frf
    title = (
        f"{frf.kind.value.capitalize()} from {_source(chain)}: magnitude, measured "
        "(solid) and synthesised from the modes (dashed); phase; ordinary coherence."
    )
    plots = frf_figures(frf, chain.result.synthesis)
    return small_multiples(title, plots, "FRFs")


def _source(chain: ModalChain) -> str:
    """Name what the FRFs come from: hits and the estimator, or files."""
    detail = _estimate(chain)
    if detail is None:
        averages = chain.frf.averages
        return "files" + (f", {averages} averages" if averages else "")
    return (
        f"{chain.frf.averages} accepted hits per point "
        f"({detail['estimator']}, {detail['bias']})"
    )


def _estimate(chain: ModalChain) -> dict[str, str | float | int] | None:
    """Return how FRFs were estimated from hits; None for FRFs from files."""
    steps = (dict(s.detail) for s in chain.provenance if s.name == "estimate_frf")
    return next(steps, None)


def _stabilisation_plot(chain: ModalChain) -> Plot:
    table = chain.result.stabilisation
    frf = chain.frf
    lines = shown_band(frf)
    total = np.sqrt(np.mean(np.abs(frf.response[:, :, lines]) ** 2, axis=(0, 1)))
    x, y = thin(frf.frequency[lines], total, MOST_POINTS)
    loose = ~table.stable
    traces = [
        line(x, y, "mean |H|", color=MEASURED, width=1.2, axes=("x", "y2")),
        markers(
            table.frequency[loose],
            table.order[loose],
            "not stable",
            color=GUIDE,
            symbol="x-thin-open",
            size=4,
        ),
        markers(
            table.frequency[table.stable],
            table.order[table.stable],
            "stable in frequency, damping and shape",
            color=GOOD,
            size=5,
        ),
    ]
    plot = figure(
        traces,
        axis("frequency [Hz]", range=[float(x[0]), float(x[-1])]),
        axis("model order"),
        yaxis2=axis(
            f"mean |H| [{frf.kind.unit}]",
            log=True,
            overlaying="y",
            side="right",
            showgrid=False,
        ),
        shapes=[_mode_line(f) for f in chain.result.model.natural_frequency],
    )
    caption = (
        "Poles of every model order of the least-squares complex frequency estimator. "
        "Vertical lines: selected modes."
    )
    return Plot("stabilisation-plot", caption, plot, 440)


def _mode_line(frequency: float) -> Figure:
    return {
        "type": "line",
        "x0": float(frequency),
        "x1": float(frequency),
        "y0": 0,
        "y1": 1,
        "yref": "paper",
        "layer": "below",
        "line": {"color": MODEL, "width": 1},
    }


def modes_table(chain: ModalChain) -> DataTable:
    """Return the table of modes with standard deviations and the Kalman gain there."""
    model = chain.result.model
    rows = tuple(
        (
            str(number + 1),
            with_sd(model.natural_frequency[number], model.frequency_sd[number]),
            with_sd(
                100 * model.damping_ratio[number], 100 * model.damping_ratio_sd[number]
            ),
            *stage_cells(chain, number),
            "user" if model.by_hand[number] else "program",
        )
        for number in range(len(model.natural_frequency))
    )
    return DataTable(
        "Identified modes with one standard deviation; gain and phase of the Kalman "
        "stage at each mode.",
        ("mode", "frequency [Hz]", "damping ratio [%]", *STAGE_COLUMNS, "selected by"),
        rows,
    )


def _window(chain: ModalChain) -> str:
    detail, source = _estimate(chain), noise_source(chain.provenance)
    added = chain.frf.added_decay_rate
    text = "Windows: not stated by the files."
    if detail is not None:
        text = f"Windows: {detail['window_reason']}."
    elif source is not None and source.sentence:
        text = f"{text} Noise: {source.sentence}."
    if added > 0:
        text += (
            f" The exponential window adds {added:.4g} 1/s to the decay rate of every "
            "pole; this is subtracted exactly."
        )
    missed = 100 * synthesis_error(chain)
    return f"{text} Synthesis error: {missed:.2g} % of the FRF (rms over the band)."


def _systematic(chain: ModalChain) -> str:
    """Name systematic intervals; results of earlier versions do not hold this."""
    if np.isnan(chain.result.model.residual_ratio).all():
        return "The results file does not hold the systematic part of the intervals."
    return systematic_words(chain)


def _kalman(chain: ModalChain) -> str:
    gain = chain.result.stage_gain
    if gain is None:
        if any(step.name == "kalman_stage" for step in chain.provenance):
            return "The results file does not hold the gain of the Kalman stage."
        return "No Kalman stage was used."
    return (
        f"Kalman stage: {gain.settings.model.value.replace('_', ' and ')} smoother of "
        "zero phase on force and responses; its gain W cancels in the FRF and biases "
        "neither frequency nor damping."
    )
