"""Figures as markup: every trace is drawn, and every text is text."""

import re

import numpy as np
import pytest

from jointbench.station.drawing.figure_markup import figure_markup
from jointbench.station.drawing.svg_paths import dots_path, line_path
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.traces import band, heatmap, line, markers

X = np.linspace(0.0, 1.0, 5)


def drawn(*traces, **more):
    """Return a figure of traces as markup."""
    return figure_markup(
        figure(traces, axis("x [s]"), axis("y [N]"), **more), height=300
    )[0]


def test_a_line_is_broken_where_a_value_is_not_known():
    """Two runs, each with its own start."""
    y = np.array([0.0, 0.5, np.nan, 0.5, 1.0])
    assert line_path(X, y).count("M") == 2


def test_a_long_line_keeps_its_envelope():
    """A peak of one sample among 100,000 is drawn."""
    y = np.zeros(100_000)
    y[77_777] = 1.0
    path = line_path(np.linspace(0, 1, y.size), y)
    assert len(path) < 20_000
    heights = np.cumsum([int(v) for v in re.findall(r"-?\d+", path)][1::2])
    assert heights.min() == 0


def test_dots_are_one_path():
    """A point of no length, whose round end is the dot."""
    assert dots_path(X, X).count("h0") == X.size


@pytest.mark.parametrize(
    ("trace", "kind"),
    [
        ([line(X, X, "l")], 'class="ln'),
        ([markers(X, X, "m")], 'class="dots'),
        ([markers(X, X, "m", error=0.1 * X)], 'class="ln span'),
        ([markers(X, X, "m", symbol="diamond")], "◆"),
        (band(X, X, X + 1, "b", color="var(--model)"), 'class="area'),
        ([{"type": "bar", "x": ["a", "b"], "y": [1, 2], "name": "n"}], 'class="bar'),
        ([heatmap(X, X, np.outer(X, X), "u")], 'href="data:image/png;base64,'),
    ],
)
def test_every_kind_of_trace_is_drawn(trace, kind):
    """Lines, points, intervals, marks, areas, bars and maps."""
    assert kind in drawn(*trace)


def test_names_of_points_stand_at_one_side_or_each_at_its_own():
    """Sides are stated for a trace or for each of its points, as in Plotly."""
    named = {**markers(X[:2], X[:2], "m"), "mode": "markers+text", "text": ["a", "b"]}
    once = drawn({**named, "textposition": "bottom center"})
    each = drawn({**named, "textposition": ["middle left", "top center"]})
    assert re.findall(r'class="tx (\w+)"', once) == ["below", "below"]
    assert re.findall(r'class="tx (\w+)"', each) == ["left", "above"]


def test_an_interval_along_x_is_a_level_line_within_the_axis():
    """From its left end to its right one, both of which the axis holds."""
    trace = {**markers([2.0], [1.0], "m"), "error_x": {"array": [1.0]}}
    (span,) = re.findall(r'class="ln span[^>]* d="M(\d+) \d+H(\d+)"', drawn(trace))
    assert 0 < int(span[0]) < int(span[1]) < 8000


def test_a_pair_of_axes_is_a_panel_and_an_axis_over_another_is_none():
    """Stacked panels share one axis, whose marks stand below the last."""
    traces = (line(X, X, "a"), line(X, X, "b", axes=("x", "y2")))
    apart = drawn(*traces, yaxis2=axis("phase [deg]", domain=[0.0, 0.4]))
    assert apart.count('class="panel"') == 2
    assert apart.count("x [s]") == 1
    over = drawn(*traces, yaxis2=axis("right [m]", overlaying="y", side="right"))
    assert over.count('class="panel"') == 1
    assert "right [m]" in over


def test_shapes_lie_in_the_panel_of_their_axes():
    """A line at a value, and one across the page."""
    at = {"type": "line", "x0": 0.5, "x1": 0.5, "y0": 0, "y1": 1, "yref": "paper"}
    assert "M4000 4000L4000 0" in drawn(line(X, X, "a"), shapes=[at])


def test_the_words_of_a_figure_name_axes_and_traces():
    """What is read aloud in place of the picture."""
    made = figure([line(X, X, "force")], axis("time [s]"), axis("F [N]"))
    words = figure_markup(made, height=200, caption="One hit.")[1]
    assert words == "One hit. Axes: F [N] over time [s]. Shown: force"


def test_a_body_is_a_still_view_and_data_to_turn_it():
    """Triangles from the far to the near, and the numbers of the script."""
    corner = {"x": [0, 1, 0, 0], "y": [0, 0, 1, 0], "z": [0, 0, 0, 1]}
    faces = {"i": [0, 0, 0, 1], "j": [1, 1, 2, 2], "k": [2, 3, 3, 3]}
    body = {"type": "mesh3d", "intensity": [0, 0.2, 0.4, 1], **corner, **faces}
    made = figure_markup({"data": [body], "layout": {}}, height=200)[0]
    assert made.count("z") >= 4
    assert '"t":[0,1,2,0,1,3,0,2,3,1,2,3]' in made


def test_a_figure_that_is_empty_or_odd_is_still_a_figure():
    """No data, no layout, values that are none."""
    odd = {"data": [{"x": None, "y": ["a", None]}, {"type": "pie"}, 5], "layout": 3}
    for one in ({}, {"data": []}, odd):
        assert figure_markup(one, height=200)[0]
