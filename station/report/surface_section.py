# SPDX-License-Identifier: MIT
"""The report's section on surfaces: heights, spectra, structure function, verdict."""

from collections.abc import Sequence

from jointbench.acquisition.records.session import software_version
from jointbench.station.pipeline.roughness_words import HEADING, roughness_words
from jointbench.station.pipeline.surface_stages import SurfaceChain, chain_cautions
from jointbench.station.report.figures.scaling_figures import scaling_figures
from jointbench.station.report.figures.small_multiples import small_multiples
from jointbench.station.report.findings.surface_findings import (
    surface_sentence,
    surface_tiles,
)
from jointbench.station.roughness.texture_figures import texture_items
from jointbench.station.screen.band_limited_words import COLUMNS as BAND_COLUMNS
from jointbench.station.screen.band_limited_words import band_lines, band_rows
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    ItemGroup,
    Report,
    Section,
    Text,
)
from jointbench.station.screen.surface_figures import (
    SPECTRUM_TITLE,
    height_plot,
    spectrum_plots,
)
from jointbench.station.screen.surface_kind_words import kind_lines
from jointbench.station.screen.value_text import engineering, with_sd

_SCALING = (
    "Structure function: measured (points), fitted surface as seen through the "
    "instrument (line) and without the instrument (dotted). Below: local slope of ln S "
    "over ln lag: constant where the surface is self-affine, 2 where it is smooth, 0 "
    "for white noise and beyond its longest wavelength."
)
BAD = frozenset({"no scaling range", "instrument-limited"})


def surface_section(chains: Sequence[SurfaceChain]) -> Section:
    """Return the section: verdicts, heights, spectra, scaling, then every table."""
    items: list[Item] = [_table(chains), _band_table(chains)]
    items += [Text(said, "notice") for c in chains for said in chain_cautions(c)]
    for number, chain in enumerate(chains):
        lay = None if chain.band is None else chain.band.lay
        items.append(height_plot(chain.surface, lay, number))
    spectra = [
        plot
        for number, chain in enumerate(chains)
        for plot in spectrum_plots(chain.surface, chain.band, number)
    ]
    items += small_multiples(SPECTRUM_TITLE, spectra, "spectra")
    items += small_multiples(_SCALING, scaling_figures(chains), "surfaces")
    items += texture_items([(c.surface.name, c.texture) for c in chains])
    items.append(_instrument_table(chains))
    said = [Text(f"{c.surface.name}: {c.fit.reason}") for c in chains]
    said += [
        Text(f"{c.surface.name}: {words}")
        for c in chains
        for words in (
            *band_lines(c.band, c.no_band or "none was asked for"),
            *kind_lines(c.kinds),
        )
    ]
    items.append(ItemGroup("Reasons and remarks on each surface", tuple(said)))
    return Section("surfaces", "Surfaces", tuple(items))


def surface_report(chains: Sequence[SurfaceChain]) -> Report:
    """Return the report of surfaces without a session."""
    names = ", ".join(chain.surface.name for chain in chains)
    return Report(
        title="Surfaces",
        lead=names,
        software=software_version(),
        simulated=False,
        tiles=surface_tiles(chains),
        sections=(surface_section(chains),),
        findings=tuple(surface_sentence(chain) for chain in chains),
    )


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
