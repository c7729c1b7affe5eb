"""After "none" the largest effects are reported; every winner is predicted twice."""

from functools import cache

import gap_bench as made
import gap_outcomes as outcomes
import numpy as np
import pytest

from jointbench.analysis.gap.diagnosis.diagnose import conclude
from jointbench.analysis.gap.diagnosis.effect_limits import effect_limits
from jointbench.analysis.gap.diagnosis.winner_check import check_winner
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Finding,
    diagnosis_json,
)
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.search.screening import screen
from jointbench.station.report.gap_sentences import limit_rows, second_method_words


@cache
def nothing() -> Diagnosis:
    """Return the diagnosis of a campaign without an effect."""
    outcome, bench = outcomes.outcome_of([])
    return conclude(outcome, bench)


def test_after_none_every_effect_has_a_limit_in_its_unit() -> None:
    """JSON and page hold a limit for each effect at each site, none elsewhere."""
    found = nothing()
    assert found.verdict is Finding.NONE
    limits = {(one.name, one.site): one for one in found.limits}
    mass = limits["added_mass", "body:m2"].parameters[0]
    assert (mass.name, mass.unit) == ("m", "kg")
    assert 0.001 < mass.value < 0.1
    assert len(limit_rows(found)) == len(found.limits)
    assert diagnosis_json(found)["upper_limits"][0]["parameters"]
    outcome, bench = outcomes.outcome_of(
        [("delay", "channel:a1", [4e-5])], ("delay", "channel:a1")
    )
    assert conclude(outcome, bench).limits == ()


@pytest.mark.parametrize("share", [0.8, 3.0])
def test_a_limit_is_where_the_directed_test_begins_to_object(share: float) -> None:
    """A delay below its limit leaves chi2 almost as it is; three times it does not."""
    outcome, bench = outcomes.outcome_of([])
    limits = effect_limits(bench, outcome.base_screening)
    one = next(x for x in limits if (x.name, x.site) == ("delay", "channel:a1"))
    term = made.term_of(bench, "delay", "channel:a1", [share * one.parameters[0].value])
    fit = outcome.base
    moved = bench.residual(fit.base, (term,), FULL)
    q = np.linalg.qr(np.concatenate([fit.jacobian, np.diag(np.sqrt(fit.prior))]))[0]
    change = moved - fit.residual
    left = change - q[: change.size] @ (q[: change.size].T @ change)
    rise = 2 * left @ fit.residual + left @ left
    assert (rise < 3.84) == (share < 1.0)


def test_the_winner_is_predicted_by_the_second_method() -> None:
    """Both methods agree to a small part of the noise, with and without a law."""
    check = nothing().second_method
    assert check is not None
    assert check.effects == ("none",)
    assert check.over_noise is not None
    assert check.over_noise < 1e-3
    assert "a second time integration" in second_method_words(nothing())
    cubic = ("cubic_stiffness", "link:joint", [1.5e16])
    outcome, bench = outcomes.outcome_of([cubic], cubic[:2], at_truth=True)
    law = check_winner(bench, outcome.best)
    assert law.effects == ("cubic_stiffness@link:joint",)
    assert law.over_noise is not None
    assert law.over_noise < 1e-2


def test_the_tests_of_the_base_state_amplitude_and_sd() -> None:
    """Drop of chi2 = (amplitude / sd)^2 where no bound or phase changes it."""
    outcome, bench = outcomes.outcome_of([])
    tested = screen(bench, outcome.base, bench.candidates).directions
    plain = [d for d in tested if not d.one_sided and not bench.phases(d.candidate)]
    for d in plain:
        assert d.drop == pytest.approx((d.amplitude / d.amplitude_sd) ** 2, rel=1e-6)
