# SPDX-License-Identifier: MIT
"""The frozen boundary-element table: it is what its script makes, and what it says."""

import importlib.util
import json
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

FOLDER = Path(__file__).parents[3] / "benchmarks" / "contact"
TABLE = json.loads((FOLDER / "oracle.json").read_text(encoding="utf-8"))
ROWS = TABLE["rows"]


def script(name):
    """Load a script of the benchmarks by its path."""
    if str(FOLDER) not in sys.path:
        sys.path.append(str(FOLDER))
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def ratios(top, bottom):
    """Return one quantity over another, every map and load."""
    return np.array([[one[top] / one[bottom] for one in r["loads"]] for r in ROWS])


def test_a_row_of_the_table_is_what_the_solver_gives():
    """One map, one load; needs the extra `oracle`."""
    pytest.importorskip("tamaas")
    oracle = script("oracle")
    row = ROWS[0]
    heights = oracle.self_affine(row["hurst"], row["seed"])
    assert_allclose(heights.std(), row["rms_height"], rtol=1e-9)
    found = oracle.solve(heights, row["loads"][0]["pressure"])
    assert_allclose(found["area"], row["loads"][0]["area"], rtol=1e-3)


def test_stiffness_is_nearly_proportional_to_pressure():
    """Exponents of elastic rough contact lie a little below one; mean of all maps."""
    pressure = [one["pressure"] for one in ROWS[0]["loads"]]
    stiffness = [[one["stiffness"] for one in row["loads"]] for row in ROWS]
    slopes = np.polyfit(np.log(pressure), np.log(stiffness).T, 1)[0]
    assert 0.85 < slopes.mean() < 1.0


def test_interaction_stiffens_at_equal_load_by_the_gap():
    """More and larger contacts than the same summits alone."""
    assert np.all(ratios("stiffness", "independent_stiffness") > 1)
    assert np.all(ratios("area", "independent_area") > 1)


def test_the_sum_of_contacts_is_not_the_slope_by_the_gap():
    """Summed at their present sizes they leave out the contacts to come."""
    assert np.all(ratios("sum_of_contacts", "stiffness") < 1)


def test_the_closed_form_softens_where_all_is_elastic():
    """The disagreement that the page reports."""
    page = script("oracle_page")
    for row in ROWS:
        found = page.columns(row)
        assert np.all(np.array(found["interacting"]) < np.array(found["plain"]))
