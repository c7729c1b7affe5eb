"""Axes of figures: where values lie and which are written."""

import pytest
from numpy.testing import assert_allclose

from jointbench.station.drawing.axis_scale import axis_marks, axis_scale


def test_a_linear_axis_has_round_marks_within_its_ends():
    """Steps of 1, 2 or 5."""
    scale = axis_scale({}, [[0.0, 1913.0]], room=0.0)
    places, texts = zip(*axis_marks(scale, {}), strict=True)
    assert texts == ("0", "500", "1000", "1500")
    assert_allclose(places, [0.0, 500 / 1913, 1000 / 1913, 1500 / 1913])


def test_a_logarithmic_axis_marks_decades_and_leaves_gaps_for_what_is_not_positive():
    """A value of nothing has no place."""
    scale = axis_scale({"type": "log"}, [[1e-3, 1e4, 0.0, -1.0]], room=0.0)
    assert_allclose(scale.places([1e-3, 1e4, 0.0, -1.0, None])[:2], [0.0, 1.0])
    assert str(scale.places([0.0])[0]) == "nan"
    texts = [text for _, text in axis_marks(scale, {})]
    assert texts == ["10⁻³", "0.1", "10", "1000"]


def test_a_short_logarithmic_axis_has_marks_within_its_decade():
    """From 3 to 60: 5, 10, 20 and 50."""
    scale = axis_scale({"type": "log"}, [[3.0, 60.0]], room=0.0)
    assert [text for _, text in axis_marks(scale, {})] == ["5", "10", "20", "50"]


def test_categories_stand_in_the_order_met():
    """Names of all traces, each once."""
    scale = axis_scale({"type": "category"}, [["b", "a"], ["a", "c"]])
    assert scale.names == ("b", "a", "c")
    assert_allclose(scale.places(["b", "c", "x"])[:2], [1 / 6, 5 / 6])


@pytest.mark.parametrize("ends", [[3.0, 3.0], [], [None]])
def test_an_axis_without_a_span_is_an_axis(ends):
    """One value lies inside; none leave 0 to 1."""
    scale = axis_scale({}, [ends])
    assert scale.low < scale.high


def test_a_range_that_runs_down_turns_the_axis():
    """The larger end comes first."""
    assert_allclose(axis_scale({"range": [10, 0]}, []).places([0.0, 10.0]), [1.0, 0.0])
