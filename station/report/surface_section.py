# SPDX-License-Identifier: MIT
"""The report's section on surfaces: heights, spectra, structure function, verdict."""

from collections.abc import Sequence

from jointbench.acquisition.records.session import software_version
from jointbench.station.pipeline.roughness_words import HEADING, roughness_words
from jointbench.station.pipeline.surface_stages import SurfaceChain, chain_cautions
from jointbench.station.roughness.texture_figures import texture_items
from jointbench.station.screen.band_limited_words import COLUMNS as BAND_COLUMNS
from jointbench.station.screen.band_limited_words import band_lines, band_rows
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    Plot,
    Report,
    Section,
    Text,
)
from jointbench.station.screen.surface_figures import height_plot, spectrum_plots
from jointbench.station.screen.traces import GREY, PALETTE, Trace, line, markers
from jointbench.station.screen.value_text import engineering, with_sd

BAD = frozenset({"no scaling range", "instrument-limited"})


def surface_section(chains: Sequence[SurfaceChain]) -> Section:
    """Return the section: heights and spectrum of each surface, then all in one."""
    items: list[Item] = []
    for number, chain in enumerate(chains):
        items += _shown(chain, number)
    items += [_structure_plot(chains), _slope_plot(chains), _table(chains)]
    items += [_band_table(chains), _instrument_table(chains)]
    items += texture_items([(c.surface.name, c.texture) for c in chains])
    items += [Text(said, "notice") for c in chains for said in chain_cautions(c)]
    items += [Text(f"{c.surface.name}: {c.fit.reason}") for c in chains]
    items += [
        Text(f"{c.surface.name}: {said}")
        for c in chains
        for said in band_lines(c.band, c.no_band or "none was asked for")
    ]
    return Section("surfaces", "Surfaces", tuple(items))


def surface_report(chains: Sequence[SurfaceChain]) -> Report:
    """Return the report of surfaces without a session."""
    names = ", ".join(chain.surface.name for chain in chains)
    return Report(
        title="Surfaces",
        lead=names,
        software=software_version(),
        simulated=False,
        tiles=(),
        sections=(surface_section(chains),),
    )


def _shown(chain: SurfaceChain, number: int) -> list[Item]:
    """Return heights, spectrum and residuals of one surface."""
    lay = None if chain.band is None else chain.band.lay
    heights = height_plot(chain.surface, lay, number)
    return [heights, *spectrum_plots(chain.surface, chain.band, number)]


def _structure_plot(chains: Sequence[SurfaceChain]) -> Plot:
    traces: list[Trace] = []
    for number, chain in enumerate(chains):
        color = PALETTE[number % len(PALETTE)]
        structure = chain.structure
        name = chain.surface.name
        traces.append(
            markers(
                structure.lag * 1e6, structure.value * 1e12, name, color=color, size=5
            )
        )
        curve = chain.fit.curve
        if curve is not None:
            traces.append(
                line(curve.lag * 1e6, curve.value * 1e12, f"{name}, fit", color=color)
            )
            traces.append(
                line(
                    curve.lag * 1e6,
                    curve.surface * 1e12,
                    f"{name}, without instrument",
                    color=GREY,
                    dash="dot",
                )
            )
    plot = figure(
        traces, axis("lag [µm]", log=True), axis("structure function S [µm²]", log=True)
    )
    caption = (
        "Structure function: measured (points), fitted surface as seen through the "
        "instrument (line) and without the instrument (dotted)."
    )
    return Plot("structure-plot", caption, plot, 420)


def _slope_plot(chains: Sequence[SurfaceChain]) -> Plot:
    traces = [
        markers(
            chain.fit.local_slope.lag * 1e6,
            chain.fit.local_slope.slope,
            chain.surface.name,
            color=PALETTE[number % len(PALETTE)],
            size=5,
            error=chain.fit.local_slope.sd,
        )
        for number, chain in enumerate(chains)
    ]
    plot = figure(
        traces,
        axis("lag [µm]", log=True),
        axis("local slope 4 - 2D [-]", range=[-0.2, 2.2]),
    )
    caption = (
        "Local slope of ln S over ln lag: constant where the surface is self-affine, "
        "2 where it is smooth, 0 for white noise and beyond its longest wavelength."
    )
    return Plot("slope-plot", caption, plot, 300)


def _table(chains: Sequence[SurfaceChain]) -> DataTable:
    rows = []
    for chain in chains:
        fit = chain.fit
        row = [chain.surface.name, fit.verdict.value, "-", "-", "-", fit.instrument]
        if fit.scaling is not None and fit.fit_band is not None:
            row[2] = with_sd(fit.scaling.dimension, fit.scaling.dimension_sd)
            row[3] = roughness_words(fit.scaling)
            row[4] = " to ".join(engineering(end, "m") for end in fit.fit_band)
        rows.append(tuple(row))
    return DataTable(
        "Fractal parameters of a profile of each surface; D with one standard "
        "deviation, G with its 95 % interval; S at the pivot lag where that interval "
        "exceeds a decade.",
        ("surface", "verdict", "D [-]", HEADING, "fit band", "instrument model"),
        tuple(rows),
        BAD,
    )


def _band_table(chains: Sequence[SurfaceChain]) -> DataTable:
    rows = [row for c in chains for row in band_rows(c.surface.name, c.band)]
    return DataTable(
        "Band-limited surfaces: each number with its 95 % interval.",
        BAND_COLUMNS,
        tuple(rows),
    )


def _instrument_table(chains: Sequence[SurfaceChain]) -> DataTable:
    """Return what the files state of the instruments."""

    def said(length: float | None) -> str:
        return "-" if length is None else engineering(length, "m")

    rows = []
    for chain in chains:
        given = chain.surface.instrument
        aperture = given.numerical_aperture
        spacing = chain.surface.spacing
        pitch = spacing if isinstance(spacing, float) else spacing[1]
        rows.append(
            (
                chain.surface.name,
                given.name or "-",
                said(pitch),
                said(given.stylus_radius),
                "-" if aperture is None else f"{aperture:g}",
                said(given.cutoff_short),
                said(given.cutoff_long),
            )
        )
    return DataTable(
        "What the files state of the instruments.",
        ("surface", "instrument", "pitch", "stylus", "NA [-]", "lambda_s", "lambda_c"),
        tuple(rows),
    )
