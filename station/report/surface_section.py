# SPDX-License-Identifier: MIT
"""The report's section on surfaces: heights, structure function, verdict."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.records.surfaces import Areal, Profile
from jointbench.signal.surface.levelling import level
from jointbench.signal.surface.line_spectrum import line_spectrum
from jointbench.station.pipeline.roughness_words import HEADING, roughness_words
from jointbench.station.pipeline.surface_stages import SurfaceChain, chain_cautions
from jointbench.station.roughness.texture_figures import texture_items
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page_parts import DataTable, Item, Plot, Section, Text
from jointbench.station.screen.plot_numbers import thin
from jointbench.station.screen.traces import (
    GREY,
    PALETTE,
    Trace,
    heatmap,
    line,
    markers,
)
from jointbench.station.screen.value_text import engineering, with_sd

MOST_POINTS = 3000
MOST_PIXELS = 260
"""Pixels of a map along its longer side."""
BAD = frozenset({"no scaling range", "instrument-limited"})


def surface_section(chains: Sequence[SurfaceChain]) -> Section:
    """Return the section: heights of each surface, then all structure functions."""
    items: list[Item] = [_heights(chain, n) for n, chain in enumerate(chains)]
    items += [_structure_plot(chains), _spectrum_plot(chains)]
    items += [_slope_plot(chains), _table(chains)]
    items += texture_items([(c.surface.name, c.texture) for c in chains])
    items += [Text(said, "notice") for c in chains for said in chain_cautions(c)]
    items += [Text(f"{c.surface.name}: {c.fit.reason}") for c in chains]
    return Section("surfaces", "Surfaces", tuple(items))


def _heights(chain: SurfaceChain, number: int) -> Plot:
    surface = chain.surface
    if isinstance(surface, Profile):
        return _profile_plot(surface, number)
    return _map_plot(surface, number)


def _profile_plot(profile: Profile, number: int) -> Plot:
    position = np.arange(profile.heights.size) * profile.spacing * 1e3
    heights = np.where(profile.valid, profile.heights * 1e6, np.nan)
    kept = np.isfinite(heights)
    trace = line(
        *thin(position[kept], heights[kept], MOST_POINTS),
        profile.name,
        width=1,
    )
    caption = (
        f"Profile {profile.name}: {profile.heights.size} heights every "
        f"{engineering(profile.spacing, 'm')}, {np.sum(~profile.valid)} missing."
    )
    plot = figure([trace], axis("x [mm]"), axis("z [µm]"))
    return Plot(f"heights-{number}", caption, plot, 280)


def _map_plot(areal: Areal, number: int) -> Plot:
    rows, columns = areal.heights.shape
    coarse = max(1, -(-max(rows, columns) // MOST_PIXELS))
    heights = np.where(areal.valid, areal.heights, np.nan)[::coarse, ::coarse] * 1e6
    y, x = (
        np.arange(n) * coarse * d * 1e6
        for n, d in zip(heights.shape, areal.spacing, strict=True)
    )
    caption = (
        f"Map {areal.name}: {rows} x {columns} heights every "
        f"{engineering(areal.spacing[1], 'm')}, {np.sum(~areal.valid)} missing."
    )
    plot = figure(
        [heatmap(x, y, heights - np.nanmean(heights), "z [µm]")],
        axis("x [µm]", constrain="domain"),
        axis("y [µm]", scaleanchor="x", constrain="domain"),
    )
    return Plot(f"heights-{number}", caption, plot, 300)


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


def _spectrum_plot(chains: Sequence[SurfaceChain]) -> Plot:
    traces = []
    for number, chain in enumerate(chains):
        found = line_spectrum(level(chain.surface))
        if found is not None:
            color = PALETTE[number % len(PALETTE)]
            density = 1e18 * found.density
            name = chain.surface.name
            traces.append(line(1e6 / found.frequency, density, name, color=color))
    plot = figure(
        traces,
        axis("wavelength [µm]", log=True),
        axis("power spectral density [µm³]", log=True),
    )
    caption = (
        "Power spectral density along the lines, one-sided over 1 / wavelength: its "
        "integral is the variance of the heights."
    )
    return Plot("spectrum-plot", caption, plot, 300)


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
