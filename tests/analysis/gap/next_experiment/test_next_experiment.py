"""Expected gain in closed cases, candidate series, and the plan that is written."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from joint_campaigns import LAW, joint

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.design.expected_gain import Forecast, expected_gain
from jointbench.analysis.gap.contact_bench.joint_states import JointData
from jointbench.analysis.gap.law_diagnosis.contact_diagnosis import diagnose_contact
from jointbench.analysis.gap.law_diagnosis.contact_search import fit_effect
from jointbench.analysis.gap.next_experiment.contact_forecast import rank_series
from jointbench.analysis.gap.next_experiment.contact_series import (
    joined_data,
    torque_series,
    with_series,
)
from jointbench.analysis.gap.search.screening import screen
from jointbench.station.joint_states.next_plan import plan_text, write_plan
from jointbench.station.joint_states.next_session import run_next
from jointbench.station.measure.plan import read_plan

PLATES = Path(__file__).parents[4] / "examples" / "plates.toml"


def test_distant_forecasts_decide_and_equal_ones_do_not() -> None:
    """Twenty sd apart one explanation is left; at the same place nothing is gained."""
    near = Forecast(0.0, np.zeros(1), np.eye(1))
    far = Forecast(0.0, np.full(1, 20.0), np.eye(1))
    clear = expected_gain([near, far], 15.0, draws=300)
    assert clear.decided > 0.99
    assert clear.wrong == 0.0
    assert clear.gain == pytest.approx(0.5, abs=0.01)
    none = expected_gain([near, near], 15.0, draws=300)
    assert none.decided == 0.0
    assert none.gain == pytest.approx(0.0, abs=1e-12)


def test_the_share_of_decisions_is_that_of_the_normal_distribution() -> None:
    """With forecasts d sd apart the difference of costs is d^2 + 2 d z."""
    first = Forecast(0.0, np.zeros(1), np.eye(1))
    other = Forecast(0.0, np.full(1, 4.0), np.eye(1))
    found = expected_gain([first, other], 15.0, draws=300)
    # 16 + 8 z >= 15, or as clearly the wrong way.
    assert found.decided == pytest.approx(0.55, abs=0.08)


def test_new_states_are_a_new_assembly_with_errors_as_before() -> None:
    """Only the new rows are marked, and no measured value moves."""
    data = joint(seed=5)
    series = torque_series(data.states)[0]
    wider, fresh = with_series(data, series)
    assert fresh.sum() == series.torque.size * np.unique(data.rows.quantity).size
    assert np.array_equal(wider.rows.value[~fresh], data.rows.value)
    new = wider.states.assembly[data.states.torque.size :]
    assert np.all(new == data.states.assembly.max() + 1)


def short_joint() -> JointData:
    """Return the rising states of the first assembly of a joint with bodies."""
    data = joint("series_compliance", 0.8, seed=6)
    own = (data.states.assembly == 0) & ~data.states.falling
    keep = own[data.rows.state] & (data.rows.quantity == 0)
    return JointData(data.name, data.facts, data.states, data.rows.chosen(keep))


def test_a_higher_torque_separates_a_compliance_from_an_exponent() -> None:
    """Both are forecast from one session; repeating it decides less often."""
    done = diagnose_contact(short_joint(), LAW)
    names = {"series_compliance", "law_exponent"}
    tests = screen(done.bench, done.base, done.bench.candidates)
    fits = [
        fit_effect(done.bench, done.base, tests, c)
        for c in done.bench.candidates
        if c.effect.name in names
    ]
    found = rank_series(done.bench, fits, accepted=True)
    shares = {one.name: one.expected.decided for one in found}
    assert shares["to 4 x the highest"] > shares["repeat"]


def test_a_series_below_a_prevailing_torque_is_no_forecast_of_it() -> None:
    """The joint stays open there: the other explanations are ranked without it."""
    done = diagnose_contact(short_joint(), LAW)
    tests = screen(done.bench, done.base, done.bench.candidates)
    fits = {
        c.effect.name: fit_effect(done.bench, done.base, tests, c)
        for c in done.bench.candidates
        if c.effect.name in {"series_compliance", "law_exponent", "prevailing_torque"}
    }
    stuck = fits["prevailing_torque"]
    x = np.append(stuck.x[: stuck.n_base], 50.0)
    fits["prevailing_torque"] = replace(stuck, x=x)
    assert rank_series(done.bench, list(fits.values()), accepted=True)


def test_two_sessions_are_one_joint_with_more_assemblies() -> None:
    """Assemblies of the second are new, and errors of both are independent."""
    one, other = joint(seed=5), joint(seed=6)
    both = joined_data(one, other)
    size = one.rows.value.size
    assert both.rows.value.size == size + other.rows.value.size
    assert both.states.assembly.max() > one.states.assembly.max()
    assert not both.rows.covariance[:size, size:].any()


def test_the_plan_is_one_that_measure_takes(tmp_path: Path) -> None:
    """Sensors and points are those of the first plan, torques those of the series."""
    series = torque_series(joint(seed=5).states)[1]
    target = tmp_path / "next.toml"
    write_plan(PLATES, series, target)
    plan = read_plan(target)
    assert len(plan.hits.torques) == series.torque.size
    assert plan.hits.torques[-1] == pytest.approx(series.torque[-1], rel=1e-3)
    assert plan.hits.points == read_plan(PLATES).hits.points


def test_a_plan_without_hits_is_refused() -> None:
    """The message names the table."""
    with pytest.raises(BadData, match="hits"):
        plan_text("operator = 'a'\n", torque_series(joint(seed=5).states)[0])


def test_a_plan_needs_the_first_one(tmp_path: Path) -> None:
    """--out alone has no sensors."""
    with pytest.raises(UsageError, match="--plan"):
        run_next([PLATES], plan=None, out=tmp_path / "n.toml", json_target=None)
