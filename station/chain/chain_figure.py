# SPDX-License-Identifier: MIT
"""One figure of the chain: surfaces, stiffness over preload, FRF, ring-down."""

import textwrap

import numpy as np

from jointbench.acquisition.records.surfaces import Areal, Surface
from jointbench.analysis.gap.chain.chain_records import ChainLink
from jointbench.station.chain.chain_words import chain_headline
from jointbench.station.chain.examine_chain import ExaminedChain
from jointbench.station.drawing.palette import MEASURED, MEMBERS
from jointbench.station.report.gap_bars import AFTER, BEFORE, LEGEND
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.traces import Trace, line, markers
from jointbench.station.screen.value_text import engineering

HEIGHT = 620
_TITLE_WIDTH = 84
_LEFT, _RIGHT = [0.0, 0.44], [0.56, 1.0]
_TOP, _BOTTOM = [0.58, 0.93], [0.0, 0.36]
_SHOWN_TIME = 0.03
_HEADINGS = {
    ChainLink.SURFACE: ("1 surfaces", 0.0, 0.93),
    ChainLink.CONTACT: ("2 contact law: stiffness of the joint", 0.56, 0.93),
    ChainLink.STRUCTURE: ("3 structure: FRF", 0.0, 0.36),
}
_MARK = "  ◄ enters here"


def chain_figure(done: ExaminedChain) -> Figure:
    """Return the figure of a chain, before and after, for a report or a talk.

    Args:
        done: the chain.
    """
    lines = textwrap.wrap(chain_headline(done), _TITLE_WIDTH)
    traces = [*_heights(done.surfaces), *_stiffness(done)]
    lower: dict[str, object] = {}
    if done.response is not None:
        more, lower = _response(done)
        traces += more
    else:
        more, lower = _modes(done)
        traces += more
    x = axis("place [mm]", domain=_LEFT, anchor="y")
    y = axis("height [µm]", domain=_TOP, anchor="x")
    return figure(
        traces,
        x,
        y,
        xaxis2=axis("preload [N]", log=True, domain=_RIGHT, anchor="y2"),
        yaxis2=axis("stiffness [N/m]", log=True, domain=_TOP, anchor="x2"),
        **lower,
        annotations=_headings(done),
        title={
            "text": "<br>".join(lines),
            "font": {"size": 19},
            "pad": {"t": 16},
            **{"x": 0.0, "xanchor": "left", "y": 1.0, "yanchor": "top"},
        },
        margin={"l": 76, "r": 24, "t": 66 + 25 * len(lines), "b": 54},
        legend=LEGEND | {"y": 1.02},
    )


def _headings(done: ExaminedChain) -> list[dict[str, object]]:
    headings = [
        (text + (_MARK if link in done.found.links else ""), x, y)
        for link, (text, x, y) in _HEADINGS.items()
    ]
    last = "4 hits: ring-down" if done.response is not None else "4 modes"
    found = [
        {
            "text": text,
            "showarrow": False,
            **_corner(x, y),
        }
        for text, x, y in headings
    ]
    found.append(
        {
            "text": last,
            "showarrow": False,
            **_corner(0.56, 0.36),
        }
    )
    return found


def _corner(x: float, y: float) -> dict[str, object]:
    return {
        "x": x,
        "y": y + 0.005,
        "xref": "paper",
        "yref": "paper",
        "xanchor": "left",
        "yanchor": "bottom",
    }


def _heights(surfaces: tuple[Surface, ...]) -> list[Trace]:
    """Return a line of each surface, apart from each other."""
    found, shift = [], 0.0
    for k, one in enumerate(surfaces):
        if isinstance(one, Areal):
            z, step = one.heights[one.heights.shape[0] // 2], one.spacing[1]
            seen = one.valid[one.heights.shape[0] // 2]
        else:
            z, step, seen = one.heights, one.spacing, one.valid
        place = 1e3 * step * np.arange(z.size)
        height = 1e6 * np.where(seen, z - np.median(z[seen]), np.nan)
        shift = shift - (np.nanmax(height) if k else 0.0)
        color = MEMBERS[k % len(MEMBERS)]
        found.append(
            line(place, height + shift, one.name, color=color, width=1, legend=False)
        )
        shift += float(np.nanmin(height))
    return found


def _stiffness(done: ExaminedChain) -> list[Trace]:
    s, axes = done.stiffness, ("x2", "y2")
    order = np.argsort(s.preload, kind="stable")
    error = 1.96 * s.after_sd * s.after
    return [
        line(s.preload[order], s.before[order], "law of the surfaces alone",
             color=BEFORE, axes=axes),
        markers(s.preload, s.after, "predicted, each from the others", color=AFTER,
                axes=axes, symbol="square-open", size=10, error=error),
        markers(s.preload, s.measured, "measured", color=MEASURED, axes=axes, size=6),
    ]  # fmt: skip


def _response(done: ExaminedChain) -> tuple[list[Trace], dict[str, object]]:
    r = done.response
    assert r is not None
    curves = ((r.measured, MEASURED, 3.2, "solid"), (r.before, BEFORE, 1.6, "solid"),
              (r.after, AFTER, 1.6, "dot"))  # fmt: skip
    traces = [
        line(r.frequency, np.abs(h), "", color=color, width=width, dash=dash,
             axes=("x3", "y3"), legend=False)
        for h, color, width, dash in curves
    ]  # fmt: skip
    shown = r.time <= _SHOWN_TIME
    for record, (_, color, width, dash) in zip(r.ring_down, curves, strict=True):
        traces.append(
            line(1e3 * r.time[shown], record[shown], "", color=color, width=width,
                 dash=dash, axes=("x4", "y4"), legend=False)
        )  # fmt: skip
    where = f"{r.channel}, hits on {r.body}, {engineering(r.preload, 'N')}"
    return traces, {
        "xaxis3": axis(f"frequency [Hz]; {where}", domain=_LEFT, anchor="y3"),
        "yaxis3": axis("|FRF| [m/(N s²)]", log=True, domain=_BOTTOM, anchor="x3"),
        "xaxis4": axis("time [ms]", domain=_RIGHT, anchor="y4"),
        "yaxis4": axis("acceleration [m/s²]", domain=_BOTTOM, anchor="x4"),
    }


def _modes(done: ExaminedChain) -> tuple[list[Trace], dict[str, object]]:
    """Return the natural frequencies over the preload, where there are no hits."""
    traces: list[Trace] = []
    preload = np.array([one.preload for one in done.modes])
    count = min(min(one.measured.size for one in done.modes), 6)
    for k in range(count):
        kinds = (("measured", MEASURED, "circle"), ("before", BEFORE, "x"),
                 ("after", AFTER, "square-open"))  # fmt: skip
        for name, color, symbol in kinds:
            values = np.array([getattr(one, name)[k] for one in done.modes])
            place = ("x3", "y3") if k < (count + 1) // 2 else ("x4", "y4")
            one = markers(preload, values, name, color=color, symbol=symbol, axes=place)
            traces.append({**one, "showlegend": False})
    title = "natural frequency [Hz]"
    return traces, {
        "xaxis3": axis("preload [N]", log=True, domain=_LEFT, anchor="y3"),
        "yaxis3": axis(title, domain=_BOTTOM, anchor="x3"),
        "xaxis4": axis("preload [N]", log=True, domain=_RIGHT, anchor="y4"),
        "yaxis4": axis(title, domain=_BOTTOM, anchor="x4"),
    }
