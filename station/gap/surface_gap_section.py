# SPDX-License-Identifier: MIT
"""Report sections of a surface: structure function and spectrum, before and after."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.law_diagnosis.surface_diagnosis import SurfaceDiagnosis
from jointbench.analysis.gap.model.effect import words_of
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.surface_bench.predicted_structure import (
    predicted_spectrum,
    predicted_structure,
)
from jointbench.station.drawing.palette import MEASURED, MODEL, REFUSED
from jointbench.station.report.gap_sentences import effect_words
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page_parts import DataTable, Item, Plot, Section, Text
from jointbench.station.screen.traces import Trace, line, markers

_TWO_SD = 2.0


def surface_gap_sections(done: SurfaceDiagnosis) -> tuple[Section, ...]:
    """Return the pictures of a surface and the waves that were held out."""
    plots: list[Item] = [
        Plot(
            "structure_function",
            "Structure function over the lag. Points: measured. Lines: the self-affine "
            "surface alone, and with the effect, of levelled heights.",
            structure_figure(done),
            420,
        ),
        Plot(
            "spectrum",
            "Power spectral density along lines. Points: measured in bins, with 95 % "
            "intervals. Lines as above.",
            spectrum_figure(done),
            420,
        ),
    ]
    return (
        Section("surface", "Surface before and after", tuple(plots)),
        Section("held-out", "Waves that were held out", _held_out(done)),
    )


def structure_figure(done: SurfaceDiagnosis) -> Figure:
    """Return the structure function with its explanations."""
    rows = done.bench.rows
    lag = rows.structure.lag
    traces: list[Trace] = [
        markers(
            1e6 * lag, 1e12 * rows.structure.value, "measured", color=MEASURED, size=5
        )
    ]
    for fit, label, color in _fits(done):
        value = 1e12 * predicted_structure(done.bench, fit, lag)
        traces.append(line(1e6 * lag, value, label, color=color))
    return figure(traces, axis("lag [µm]", log=True), axis("S [µm^2]", log=True))


def spectrum_figure(done: SurfaceDiagnosis) -> Figure:
    """Return the spectrum with its explanations."""
    sample = done.bench.rows.sample
    wave = 2e6 * np.pi * sample.pitch / sample.omega
    unit = 1e18 * 4 * np.pi * sample.pitch * sample.scale**2
    power = unit * sample.power
    error = _TWO_SD * power / np.sqrt(sample.count)
    traces: list[Trace] = [
        markers(
            wave, power, "measured", color=MEASURED, size=5, error=_shown(error, power)
        )
    ]
    for fit, label, color in _fits(done):
        density = unit * predicted_spectrum(done.bench, fit)
        traces.append(line(wave, density, label, color=color))
    return figure(
        traces, axis("wavelength [µm]", log=True), axis("density [µm^3]", log=True)
    )


def _shown(error: FloatArray, power: FloatArray) -> FloatArray:
    """Return intervals that stay above zero on a logarithmic axis."""
    return np.asarray(np.minimum(error, 0.95 * power))


def _fits(done: SurfaceDiagnosis) -> list[tuple[Fit, str, str]]:
    found = [(done.base, "self-affine", REFUSED)]
    if done.best is not done.base:
        words = effect_words(words_of(done.best.candidates))
        found.append((done.best, f"with {words}", MODEL))
    return found


def _held_out(done: SurfaceDiagnosis) -> tuple[Item, ...]:
    before, after = done.before, done.after
    text = (
        "Every bin of the spectrum is predicted from the bins of three other parts. "
        f"Within the 95 % interval: {100 * before.share_inside:.0f} % of "
        f"{before.omega.size} bins by the self-affine surface alone"
    )
    if done.best is not done.base:
        text += f", {100 * after.share_inside:.0f} % with the effect"
    view = done.found.gap_before.views[0]
    later = done.found.gap_after.views[0].chi2_per_dof
    rows = tuple(
        (label, f"{value:.3g}", f"{later[label]:.3g}")
        for label, value in view.chi2_per_dof.items()
        if label in later
    )
    columns = ("part", "chi2/dof before", "chi2/dof after")
    return (Text(f"{text}."), DataTable("Of the fits to all rows.", columns, rows))
