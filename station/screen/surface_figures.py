# SPDX-License-Identifier: MIT
"""Figures of a surface: levelled heights, a lay, spectrum with fit and residuals."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Areal, Profile, Surface
from jointbench.signal.band_limited.band_records import BandLimitedFit, SurfaceLay
from jointbench.signal.band_limited.spectrum_sections import (
    SpectrumSection,
    spectrum_sections,
)
from jointbench.signal.surface.levelling import level
from jointbench.station.drawing.palette import GUIDE, MEASURED, MEMBERS, MODEL
from jointbench.station.screen.band_limited_words import lay_words
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page_parts import Plot
from jointbench.station.screen.plot_numbers import thin
from jointbench.station.screen.traces import (
    Trace,
    heatmap,
    line,
    markers,
)
from jointbench.station.screen.value_text import engineering

MOST_POINTS = 3000
MOST_PIXELS = 260
"""Pixels of a map along its longer side."""
_LAY_LENGTH = 0.3
"""Length of the line that shows a lay, over the shorter side of the map [-]."""
_CLIPPED = 0.1
"""Percentage of the heights at each end beyond the colours of a map."""
_TWO_SD = 2.0


def height_plot(surface: Surface, lay: SurfaceLay | None, number: int) -> Plot:
    """Return levelled heights: without the tilt the roughness is seen."""
    flat = level(surface)
    if isinstance(flat, Profile):
        return _profile_plot(flat, number)
    return _map_plot(flat, lay, number)


def _profile_plot(profile: Profile, number: int) -> Plot:
    position = np.arange(profile.heights.size) * profile.spacing * 1e3
    heights = np.where(profile.valid, profile.heights * 1e6, np.nan)
    kept = np.isfinite(heights)
    trace = line(
        *thin(position[kept], heights[kept], MOST_POINTS),
        profile.name,
        color=MEASURED,
        width=1,
    )
    caption = (
        f"Profile {profile.name}, levelled: {profile.heights.size} heights every "
        f"{engineering(profile.spacing, 'm')}, {np.sum(~profile.valid)} missing."
    )
    plot = figure([trace], axis("x [mm]"), axis("z [µm]"))
    return Plot(f"heights-{number}", caption, plot, 280)


def _map_plot(areal: Areal, lay: SurfaceLay | None, number: int) -> Plot:
    rows, columns = areal.heights.shape
    coarse = max(1, -(-max(rows, columns) // MOST_PIXELS))
    heights = np.where(areal.valid, areal.heights, np.nan)[::coarse, ::coarse] * 1e6
    y, x = (
        np.arange(n) * coarse * d * 1e6
        for n, d in zip(heights.shape, areal.spacing, strict=True)
    )
    caption = (
        f"Map {areal.name}, levelled: {rows} x {columns} heights every "
        f"{engineering(areal.spacing[1], 'm')}, {np.sum(~areal.valid)} missing."
    )
    seen = heights[np.isfinite(heights)]
    low, high = np.percentile(seen, [_CLIPPED, 100 - _CLIPPED])
    traces: list[Trace] = [
        {**heatmap(x, y, heights, "z [µm]"), "zmin": float(low), "zmax": float(high)}
    ]
    if lay is not None:
        traces += _lay_traces(lay, x, y)
        caption += f" Line: {lay_words(lay)}."
    plot = figure(
        traces,
        axis("x [µm]", constrain="domain"),
        axis("y [µm]", scaleanchor="x", constrain="domain"),
        showlegend=False,
    )
    return Plot(f"heights-{number}", caption, plot, 420)


def _lay_traces(lay: SurfaceLay, x: FloatArray, y: FloatArray) -> list[Trace]:
    """Return the lay through the middle, and an ellipse of equal density about it."""
    centre = 0.5 * (x[0] + x[-1]), 0.5 * (y[0] + y[-1])
    half = _LAY_LENGTH * min(float(np.ptp(x)), float(np.ptp(y)))
    turn = np.linspace(0, 2 * np.pi, 73)
    along, across = 0.5 * half * np.cos(turn), 0.5 * half * np.sin(turn)
    across = across / lay.ratio.value
    angle = lay.angle.value
    curves = [
        (np.array([-half, half]), np.zeros(2)),
        (along, across),
    ]
    traces = []
    for width, color in ((5.0, "#ffffff"), (2.2, "#0b5cab")):
        for u, v in curves:
            traces.append(
                line(
                    centre[0] + u * np.cos(angle) - v * np.sin(angle),
                    centre[1] + u * np.sin(angle) + v * np.cos(angle),
                    "lay",
                    color=color,
                    width=width,
                )
            )
    return traces


SPECTRUM_TITLE = (
    "Power spectral density: measured (points), fitted as the instrument shows it "
    "(line); grey: wavelengths of the stated height, slope and curvature. Below: ln of "
    "measured over fitted density; bars: two standard deviations of the mean in each "
    "bin."
)


def spectrum_plots(
    surface: Surface, fit: BandLimitedFit | None, number: int
) -> list[Plot]:
    """Return the spectrum with fit and band over its residuals; none without one."""
    sections = spectrum_sections(surface, fit)
    if not sections:
        return []
    areal = fit is not None and fit.mapped
    unit, power = ("µm⁴", 1e24) if areal else ("µm³", 1e18)
    what = "over both wavenumbers" if areal else "along the lines, over 1 / wavelength"
    residuals = _residual_traces(sections)
    shapes, more = _band_shapes(fit), {}
    if residuals:
        ends = {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": 0, "y1": 0}
        line_ = {"color": GUIDE, "width": 1}
        shapes.append({**ends, "yref": "y2", "line": line_})
        more = {
            "yaxis2": axis(
                "ln measured / fitted [-]", range=[-1.5, 1.5], domain=[0.0, 0.34]
            )
        }
    plot = figure(
        [*_spectrum_traces(sections, power), *residuals],
        axis("wavelength [µm]", log=True),
        axis(
            f"power spectral density [{unit}]",
            log=True,
            domain=[0.34 if residuals else 0.0, 1.0],
        ),
        shapes=shapes,
        **more,
    )
    return [Plot(f"spectrum-{number}", f"{surface.name}, {what}", plot, 470)]


def _spectrum_traces(sections: Sequence[SpectrumSection], power: float) -> list[Trace]:
    traces: list[Trace] = []
    for k, one in enumerate(sections):
        color = _section_colour(k, len(sections))
        place = 1e6 * one.wavelength
        name = one.name or "measured"
        traces.append(markers(place, power * one.measured, name, color=color, size=4))
        if one.fitted is not None:
            said = f"{one.name}, fit" if one.name else "fit"
            traces.append(line(place, power * one.fitted, said, color=MODEL))
    return traces


def _section_colour(at: int, count: int) -> str:
    """Return the colour of one of several sections of a spectrum."""
    return MEASURED if count == 1 else MEMBERS[at % len(MEMBERS)]


def _residual_traces(sections: Sequence[SpectrumSection]) -> list[Trace]:
    traces: list[Trace] = []
    for k, one in enumerate(sections):
        residual = one.residual
        if residual is not None:
            points = markers(
                1e6 * one.wavelength,
                residual,
                "",
                color=_section_colour(k, len(sections)),
                size=4,
                axes=("x", "y2"),
                error=_TWO_SD / np.sqrt(one.count),
            )
            traces.append({**points, "showlegend": False})
    return traces


def _band_shapes(fit: BandLimitedFit | None) -> list[dict[str, object]]:
    """Return the stated wavelengths as a grey band."""
    if fit is None or fit.moments is None:
        return []
    return [
        {
            "type": "rect",
            "yref": "paper",
            "x0": 1e6 * fit.moments.shortest,
            "x1": 1e6 * fit.moments.longest,
            "y0": 0,
            "y1": 1,
            "fillcolor": GUIDE,
            "line": {"width": 0},
            "layer": "below",
        }
    ]
