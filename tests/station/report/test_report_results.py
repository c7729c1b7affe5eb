"""A report shows the results that exist, of every preload, and says from which run."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.station.archive.process_file import Task, process_task
from jointbench.station.commands.modal_command import run_modal
from jointbench.station.pipeline.chain import run_chain
from jointbench.station.pipeline.modal_options import modal_settings
from jointbench.station.report.session_report import run_report
from jointbench.station.results.results_file import results_path
from jointbench.station.results.results_modes import read_run
from jointbench.station.schemas.recipe import Recipe

KEPT = Path(__file__).parents[2] / "fixtures"


def page_of(session: Path, **how: Path) -> tuple[str, dict[str, list[object]]]:
    """Return a report as text, and its JSON."""
    reported = session.with_suffix(".json")
    page = run_report(session, out=None, model=None, json_target=str(reported), **how)
    content = json.loads(reported.read_text(encoding="utf-8"))
    return page.read_text(encoding="utf-8"), content


def test_what_was_stored_is_read_back_to_the_last_bit(make_session) -> None:
    """Modes, shapes, evidence, poles of all orders and the synthesis."""
    session = make_session("s.h5")
    run_modal([session])
    result = run_chain(read_session(session).recordings).result
    stored = read_run(results_path(session)).modes[0].result
    for name in (
        "natural_frequency",
        "frequency_sd",
        "shapes",
        "shapes_sd",
        "residual_ratio",
    ):
        wanted = getattr(result.model, name)
        assert np.array_equal(getattr(stored.model, name), wanted), name
    assert np.array_equal(stored.stabilisation.stable, result.stabilisation.stable)
    assert np.array_equal(stored.synthesis.response, result.synthesis.response)
    assert np.array_equal(stored.synthesis_error, result.synthesis_error)
    assert stored.band == result.band
    assert (stored.stage_gain is None) is (result.stage_gain is None)


def test_a_report_shows_what_was_dropped_and_asked_for(make_session) -> None:
    """One mode of two, H2, a band and an order: as `modal` left them."""
    session = make_session("s.h5")
    text, content = page_of(session)
    assert content["modes"] == [{"preload_n": None, "results": None}]
    run_modal([session], modal_settings("50:600", None, "H1", (), ()))
    assert "mode 2" in page_of(session)[0]
    run_modal([session], modal_settings("50:600", 24, "H2", (), (420.0,)))
    text, content = page_of(session)
    assert "mode 2" not in text
    assert "(H2, " in text
    words = str(content["modes"][0]["results"])  # type: ignore[index]
    for part in ("s.results.h5", "H2", "50", "600", "order 24", "dropped by hand 420"):
        assert part in words
    assert "s.results.h5" in text


def test_every_preload_is_shown_and_each_from_its_own_results(make_session) -> None:
    """Two preloads, one of them with results: two of each section, one run named."""
    path = make_session("s.h5")
    session = read_session(path)
    recordings = tuple(
        replace(session.recordings[0], name=f"run-{n}", preload=1e3 * n) for n in (5, 9)
    )
    write_session(replace(session, recordings=recordings), path, overwrite=True)
    run_modal([path])
    path.with_name("s.9000N.results.h5").unlink()
    text, content = page_of(path)
    for anchor in ("frf", "stabilisation", "modes", "shapes", "checks"):
        for at in ("5000", "9000"):
            assert text.count(f'id="{anchor}-at-{at}-N"') == 1
    named = [row["results"] for row in content["modes"]]  # type: ignore[index]
    assert str(named[0]).startswith("s.5000N.results.h5")
    assert named[1] is None


def test_results_of_another_state_of_the_session_are_not_shown(make_session) -> None:
    """The session was recorded again under the same name; the report states it."""
    session = make_session("s.h5")
    run_modal([session], modal_settings(None, None, "H2", (), ()))
    session.unlink()
    make_session("s.h5", seed=2)
    text, content = page_of(session)
    assert "another state of the session" in text
    assert content["modes"][0]["results"] is None  # type: ignore[index]
    with pytest.raises(UsageError, match="was not made of"):
        page_of(session, results=results_path(session))


def test_results_of_a_recipe_are_shown_where_modal_left_none(make_session) -> None:
    """And named, with --results, beside those of `modal`."""
    session = make_session("s.h5")
    # The force of these hits has no power at 500 Hz.
    recipe = Recipe(name="banded", modes={"band": ("300 Hz", "470 Hz")})
    result = session.with_suffix(".banded.results.h5")
    process_task(Task(session, result), recipe)
    text, content = page_of(session)
    assert "mode 2" not in text
    assert "banded" in str(content["modes"][0]["results"])  # type: ignore[index]
    run_modal([session])
    text, content = page_of(session)
    assert "mode 2" in text
    assert "s.banded.results.h5 lies there, too" in text
    text, _ = page_of(session, results=result)
    assert "mode 2" not in text


def test_a_band_over_a_null_of_the_force_keeps_its_mode(make_session) -> None:
    """The mode is there although the FRF has a peak where the force has no power."""
    session = make_session("s.h5")
    recipe = Recipe(name="banded", modes={"band": ("300 Hz", "600 Hz")})
    result = session.with_suffix(".banded.results.h5")
    process_task(Task(session, result), recipe)
    assert "mode 2" not in page_of(session)[0]
    found = read_run(result).modes[0].result.model
    off = abs(found.damping_ratio[0] - 0.012)
    assert off < 3.0 * found.damping_ratio_sd[0] < 5e-5


@pytest.mark.parametrize("name", ["modal-1", "processed-2"])
def test_a_report_shows_results_of_2026(tmp_path: Path, name: str) -> None:
    """What those files do not hold is reported as missing, not made up."""
    session = tmp_path / "v.h5"
    shutil.copy(KEPT / "session-1.h5", session)
    shutil.copy(KEPT / f"{name}.results.h5", tmp_path / "v.results.h5")
    text, content = page_of(session)
    assert "v.results.h5" in str(content["modes"][0]["results"])  # type: ignore[index]
    assert "does not hold the systematic part of the intervals" in text
