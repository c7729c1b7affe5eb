# SPDX-License-Identifier: MIT
"""Small figures of the scaling of surfaces: structure function and its local slope."""

from collections.abc import Sequence

from jointbench.station.drawing.palette import GUIDE, MEASURED, MODEL
from jointbench.station.pipeline.surface_stages import SurfaceChain
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page_parts import Plot
from jointbench.station.screen.traces import Trace, line, markers

_HEIGHT = 430


def scaling_figures(chains: Sequence[SurfaceChain]) -> list[Plot]:
    """Return structure function and slope of each surface, over one another."""
    return [_scaling(chain, number) for number, chain in enumerate(chains)]


def _scaling(chain: SurfaceChain, number: int) -> Plot:
    structure, slope = chain.structure, chain.fit.local_slope
    traces: list[Trace] = [
        markers(
            structure.lag * 1e6,
            structure.value * 1e12,
            "measured",
            color=MEASURED,
            size=5,
        )
    ]
    curve = chain.fit.curve
    if curve is not None:
        lag = curve.lag * 1e6
        traces.append(
            line(lag, curve.value * 1e12, "fit, through the instrument", color=MODEL)
        )
        traces.append(
            line(
                lag,
                curve.surface * 1e12,
                "fit, without the instrument",
                color=GUIDE,
                dash="dot",
            )
        )
    traces.append(
        {
            **markers(
                slope.lag * 1e6,
                slope.slope,
                "",
                color=MEASURED,
                size=5,
                axes=("x", "y2"),
                error=slope.sd,
            ),
            "showlegend": False,
        }
    )
    plot = figure(
        traces,
        axis("lag [µm]", log=True),
        axis("structure function S [µm²]", log=True, domain=[0.42, 1.0]),
        yaxis2=axis("local slope 4 - 2D [-]", range=[-0.2, 2.2], domain=[0.0, 0.42]),
    )
    return Plot(f"structure-plot-{number}", chain.surface.name, plot, _HEIGHT)
