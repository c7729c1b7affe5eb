"""Headings of panels that stand in rows and columns."""

from jointbench.station.drawing.figure_markup import figure_markup
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.traces import line


def test_each_panel_of_a_column_has_its_own_heading() -> None:
    """The lower heading stands between the upper panel and the lower one."""
    shown = figure(
        [
            line([0.0, 1.0], [0.0, 1.0], "a", color="#000"),
            line([0.0, 1.0], [0.0, 1.0], "b", color="#000", axes=("x2", "y2")),
        ],
        axis("upper x", anchor="y"),
        axis("upper y", domain=[0.6, 1.0], anchor="x"),
        xaxis2=axis("lower x", anchor="y2"),
        yaxis2=axis("lower y", domain=[0.0, 0.4], anchor="x2"),
        annotations=[
            {"text": text, "xref": "paper", "x": 0.0, "y": y}
            for text, y in (("2 below", 0.41), ("1 above", 1.01))
        ],
    )
    markup, _ = figure_markup(shown, height=400)
    order = [
        markup.index(word) for word in ("1 above", "upper x", "2 below", "lower x")
    ]
    assert order == sorted(order)
