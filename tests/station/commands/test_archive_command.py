"""Results of many sessions: tables, trends, comparisons."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.io

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.station.archive.archive_table import (
    read_results,
    table_rows,
    write_table,
)
from jointbench.station.archive.compare_results import compare_results, match_modes
from jointbench.station.archive.process_file import Task, process_task
from jointbench.station.archive.trends import (
    Trend,
    TrendPoint,
    fit_with_scatter,
    trends_of,
)
from jointbench.station.commands.archive_command import torque_words, ways_of
from jointbench.station.files.archive_patterns import result_files
from jointbench.station.results.result_rows import ResultQuantity
from jointbench.station.results.results_read import is_results, without_copies
from jointbench.station.schemas.recipe import Recipe
from jointbench.station.schemas.recipe_modal_parts import WindowsPart

PLAIN = Recipe(name="plain")


def two_recipes(make_session, tmp_path: Path):
    """Return the results of two sessions under two recipes."""
    sets = []
    for recipe in (PLAIN, Recipe(name="short", windows=WindowsPart(lead="none"))):
        for number in range(2):
            if recipe is PLAIN:
                make_session(f"in/{number}.h5", seed=number + 1)
            task = Task(
                tmp_path / "in" / f"{number}.h5",
                tmp_path / f"{number}.{recipe.name}.results.h5",
            )
            process_task(task, recipe)
        sets.append(read_results(sorted(tmp_path.glob(f"*.{recipe.name}.results.h5"))))
    return [found for found, _ in sets]


def test_a_comparison_says_what_differs_and_pairs_by_content(
    make_session, tmp_path: Path
) -> None:
    """Two sessions, one setting that changed, the stages that hang on it."""
    before, after = two_recipes(make_session, tmp_path)
    found = compare_results(before, after)
    assert found.pairs == 2
    assert found.causes["windows.lead: chosen by the data -> 0.0"] == 2
    assert {d.since for d in found.differences if d.moved} == {"frf"}
    assert set(found.stages) == {"frf", "modes", "fill", "amplitude"}
    assert compare_results(before, before).moved == ()
    with pytest.raises(BadData, match="no session is in both"):
        compare_results(before[:1], after[1:])


def test_a_session_under_two_names_counts_once(make_session, tmp_path: Path) -> None:
    """Its copy is left out of trends, and no obstacle to a comparison."""
    path = make_session("in/a.h5")
    (tmp_path / "in" / "copy.h5").write_bytes(path.read_bytes())
    for name in ("a", "copy"):
        result = tmp_path / "out" / f"{name}.plain.results.h5"
        result.parent.mkdir(exist_ok=True)
        process_task(Task(tmp_path / "in" / f"{name}.h5", result), PLAIN)
    results, _ = read_results(sorted(tmp_path.glob("out/*.results.h5")))
    kept, copies = without_copies(results)
    assert [r.path.name for r in kept] == ["a.plain.results.h5"]
    assert [r.path.name for r in copies] == ["copy.plain.results.h5"]
    assert compare_results(results, results[:1]).pairs == 1
    other = [replace(results[0], key="another recipe's"), results[1]]
    with pytest.raises(BadData, match="same file"):
        compare_results(other, results)


def test_trends_of_two_recipes_are_kept_apart(make_session, tmp_path: Path) -> None:
    """One value under each recipe is no trend, and no second measurement."""
    before, after = two_recipes(make_session, tmp_path)
    rows = table_rows([*before, *after])
    assert set(ways_of(rows).values()) == {"plain: ", "short: "}
    assert set(ways_of(table_rows(before)).values()) == {""}
    edited = [replace(row, recipe="plain") for row in rows]
    assert all(len(way.split()) == 2 for way in ways_of(edited).values())


def test_a_change_without_a_deviation_is_distinguished(
    make_session, tmp_path: Path
) -> None:
    """What has no standard deviation cannot move beyond it, but is not passed over."""
    one = two_recipes(make_session, tmp_path)[0][0]
    bare = [ResultQuantity("contact", "ke", "stiffness", "N/m", v) for v in (1.0, 2.0)]
    first, second = (replace(one, quantities=(q,)) for q in bare)
    found = compare_results([first], [second])
    assert found.moved == ()
    assert [d.after for d in found.unjudged] == [2.0]


def test_a_result_of_any_name_is_taken_where_it_is_named(
    make_session, tmp_path: Path
) -> None:
    """`process --out r.h5` makes one that a pattern would not find."""
    path = make_session("in/a.h5")
    result = tmp_path / "r.h5"
    process_task(Task(path, result), PLAIN)
    assert result_files([str(result)]) == (result,)
    assert is_results(result)
    assert not is_results(path)
    with pytest.raises(UsageError, match="names no results"):
        result_files([str(tmp_path / "*.h5")])


def test_modes_of_one_preload_are_those_of_a_result_that_names_none(
    make_session, tmp_path: Path
) -> None:
    """A result of `modal`, which knows neither preload nor recipe, beside another."""
    one = two_recipes(make_session, tmp_path)[0][0]
    known = tuple(replace(q, preload=2000.0) for q in one.quantities)
    bare = replace(one, recipe={}, facts={**one.facts, "recipe_name": ""})
    found = compare_results([bare], [replace(one, quantities=known)])
    assert found.moved == ()
    assert list(found.causes) == ["recipe name: - -> plain"]


def test_modes_are_paired_by_frequency_not_by_number() -> None:
    """A mode that came in below shifts the numbers, not the pairs."""
    assert match_modes([100.0, 300.0], [50.0, 101.0, 299.0]) == {0: 1, 1: 2}
    assert match_modes([100.0], [120.0]) == {}


def test_one_table_opens_in_pandas_and_xarray(make_session, tmp_path: Path) -> None:
    """CSV, netCDF, Parquet and MAT hold the same rows."""
    pandas = pytest.importorskip("pandas", reason="pandas opens the table")
    xarray = pytest.importorskip("xarray", reason="xarray opens the table")
    pytest.importorskip("pyarrow", reason="Parquet is an extra")
    rows = table_rows(two_recipes(make_session, tmp_path)[0])
    for name in ("t.csv", "t.nc", "t.parquet", "t.mat"):
        write_table(tmp_path / name, rows)
    plain = scipy.io.loadmat(tmp_path / "t.mat")
    assert plain["value"].ravel() == pytest.approx([r.value for r in rows], nan_ok=True)
    assert [name.strip() for name in plain["name"]] == [row.name for row in rows]
    frames = [
        pandas.read_csv(tmp_path / "t.csv"),
        xarray.open_dataset(tmp_path / "t.nc", engine="h5netcdf").to_dataframe(),
        pandas.read_parquet(tmp_path / "t.parquet"),
    ]
    for frame in frames:
        assert len(frame) == len(rows)
        assert np.allclose(frame["torque"], 20.0)
        wanted = [row.value for row in rows]
        assert np.array_equal(frame["value"].to_numpy(float), wanted, equal_nan=True)


def test_a_trend_over_days_is_not_hidden_by_two_torques(
    make_session, tmp_path: Path
) -> None:
    """A frequency that falls at both torques; torques that were read are not apart."""
    made = table_rows(two_recipes(make_session, tmp_path)[0][:1])
    one = next(row for row in made if row.name == "natural_frequency")
    rows = [
        replace(
            one,
            torque=torque,
            day=float(day),
            input_sha256=f"{torque} {day}",
            value=f - 0.1 * day,
            sd=1e-3,
        )
        for day in range(4)
        for torque, f in ((20.0, 700.0), (50.0, 900.0))
    ]
    words = torque_words(rows)
    assert words == {20.0: " at 20 N m", 50.0: " at 50 N m"}
    found = trends_of([Trend.point(r, "day", "", words[r.torque]) for r in rows])
    assert [trend.count for trend in found] == [4, 4]
    assert all(trend.significance > 100 for trend in found)
    together = trends_of([Trend.point(row, "day") for row in rows])
    assert together[0].significance < 1
    read = [replace(row, torque=20.0 + k / 10) for k, row in enumerate(rows)]
    assert torque_words(read) == torque_words(rows[::2]) == {}


def test_a_trend_finds_the_slope_it_was_given() -> None:
    """100 + 0.2 T with a scatter of 0.01: the slope within three of its sd."""
    rng = np.random.default_rng(3)
    points = [
        TrendPoint(
            "modes 1 f", "Hz", float(t), 100 + 0.2 * t + rng.normal(0, 0.01), 1e-3
        )
        for t in np.tile([20.0, 40.0, 60.0, 80.0], 6)
    ]
    trend = trends_of(points)[0]
    assert abs(trend.slope - 0.2) < 3 * trend.slope_sd < 3e-3
    assert trend.scatter == pytest.approx(0.01, rel=0.5)
    assert trend.significance > 100


def test_specimens_that_agree_are_not_distinguished() -> None:
    """Equal means within their sd: no change seen."""
    points = [
        TrendPoint("f", "Hz", name, 100.0 + d, 0.1)
        for name in ("A", "B")
        for d in (-0.05, 0.05)
    ]
    trend = trends_of(points)[0]
    assert trend.significance < 1
    assert [g[0] for g in trend.groups] == ["A", "B"]


def test_the_scatter_makes_chi_squared_what_it_should_be() -> None:
    """Values +-1 about a mean, exact by themselves: scatter sqrt(n / (n - 1))."""
    value = np.array([1.0, -1.0, 1.0, -1.0])
    found, covariance, scatter = fit_with_scatter(np.ones((4, 1)), value, np.zeros(4))
    assert found[0] == pytest.approx(0.0, abs=1e-12)
    assert scatter == pytest.approx(math.sqrt(4 / 3), rel=1e-9)
    assert covariance[0, 0] == pytest.approx(1 / 3, rel=1e-9)


def test_a_trend_over_nothing_known_is_refused() -> None:
    """The message lists what there is."""
    with pytest.raises(UsageError, match="specimen"):
        Trend.point(None, "colour")  # type: ignore[arg-type]
