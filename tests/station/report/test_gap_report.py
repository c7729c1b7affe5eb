"""The page and the words of a gap, for each verdict."""

import re
from dataclasses import replace
from functools import cache

import gap_outcomes as outcomes
import pytest
from gap_contradictions import contradictions
from rich.console import Console

from jointbench.analysis.gap.diagnosis.diagnose import conclude
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Finding,
    diagnosis_json,
)
from jointbench.analysis.gap.model.policy import STANDARD, policy_digest
from jointbench.analysis.gap.model.setting import settings_of
from jointbench.station.gap import gap_output
from jointbench.station.gap.gap_output import show_diagnosis
from jointbench.station.report.gap_report import gap_report
from jointbench.station.report.gap_sentences import (
    effect_words,
    headline,
    next_step,
    why_lost,
)
from jointbench.station.screen.page import render
from jointbench.station.screen.page_parts import DataTable, ItemGroup, Plot

VERDICTS = ("none", "named", "ambiguous", "mostly", "unknown")
LATE = ("delay", "channel:a1", [4e-5])
CUBIC = ("cubic_stiffness", "link:joint", [1.5e16])
MODE = ("hidden_mode", "body:m2", [0.02, 700.0, 0.01])
LOWPASS, DELAY = ("sensor_lowpass", "channel:a1"), ("delay", "channel:a1")


@cache
def found(verdict: str) -> Diagnosis:
    """Return a diagnosis of that verdict."""
    hidden, tried, rivals = {
        "none": ([], (), 1),
        "named": ([LATE], (DELAY, LOWPASS), 1),
        "ambiguous": ([LATE], (DELAY, LOWPASS), 2),
        "mostly": ([CUBIC, MODE], (("extra_damping", "body:m2"),), 1),
        "unknown": ([LATE], (("extra_damping", "body:m2"),), 1),
    }[verdict]
    outcome, bench = outcomes.outcome_of(hidden, *tried, rivals=rivals)
    diagnosis = conclude(outcome, bench)
    assert diagnosis.verdict.value == verdict
    return diagnosis


@pytest.mark.parametrize("verdict", VERDICTS)
def test_a_page_has_the_picture_first_and_loads_nothing(verdict: str) -> None:
    """The summary figure comes first; no address is requested."""
    report = gap_report(found(verdict), title="made")
    plots = [i for s in report.sections for i in s.items if isinstance(i, Plot)]
    assert plots[0].identifier == "hero"
    assert len({plot.identifier for plot in plots}) == len(plots)
    page = render(report)
    assert "default-src 'none'" in page
    assert not re.search(r"<(script|link|img)[^>]+(src|href)=", page)


def test_the_title_states_the_finding_and_its_share_of_the_gap() -> None:
    """Effect, place and share of the gap."""
    title = gap_report(found("named"), title="made").title
    assert title.startswith("Delay on channel a1 explains ")
    assert "of the gap" in title or "the whole gap" in title


def test_rivals_that_are_not_distinguished_are_both_in_the_title() -> None:
    """An ambiguous verdict names both."""
    title = headline(found("ambiguous"))
    assert "Delay on channel a1 or sensor lowpass on channel a1" in title
    assert "cannot distinguish them" in title


def test_an_unknown_for_the_limits_of_the_campaign_names_no_effect() -> None:
    """One level only: the delay fits, so the headline must not deny a fit."""
    outcome, bench = outcomes.outcome_of([LATE], DELAY, LOWPASS)
    diagnosis = conclude(outcome, bench, limits="all hits have one level")
    assert diagnosis.verdict is Finding.UNKNOWN
    assert headline(diagnosis).startswith("These records cannot show whether")
    assert why_lost(diagnosis.candidates[0], diagnosis).startswith("fits, but")


def test_an_unknown_among_many_rivals_states_that_they_fit_equally_well() -> None:
    """Four or more explanations are no answer, and none of them was rejected."""
    labels = tuple((f"{name}@channel:a1",) for name in ("a", "b", "c", "d"))
    diagnosis = replace(found("unknown"), explanations=labels)
    assert headline(diagnosis).startswith("Several explanations fit equally well")


def test_rival_pairs_are_joined_by_or_and_their_effects_by_and() -> None:
    """What both hold is in both, and nothing is an alternative to itself."""
    pairs = (
        ("delay@channel:a1", "iwan@link:joint"),
        ("delay@channel:a1", "jenkins@link:joint"),
    )
    title = headline(replace(found("ambiguous"), explanations=pairs))
    assert title.startswith(
        "Delay on channel a1 and iwan in the joint, or delay on channel a1 and "
        "jenkins in the joint explains"
    )


def test_an_effect_that_only_one_condition_shows_has_no_reduction_in_its_title() -> (
    None
):
    """A gap that stays when held out is no share of a gap explained."""
    named = found("named")
    diagnosis = replace(named, gap_before=named.gap_before, gap_after=named.gap_before)
    assert "only one condition shows it" in headline(diagnosis)
    assert "%" not in headline(diagnosis)


def test_an_unknown_describes_its_signature_and_the_next_step() -> None:
    """Level, channel and time; the best fit is called rejected."""
    report = gap_report(found("unknown"), title="made")
    page = render(report)
    assert "best fit: " in page and "(rejected)" in page
    assert "recurs in softer hits by 10" in page
    assert next_step(found("unknown")) == found("unknown").evidence.advice  # type: ignore[union-attr]


def test_a_rival_with_a_large_delta_score_needs_no_experiment() -> None:
    """Only rivals that are not distinguished need one; a name gives the delta score."""
    far = next_step(found("named"))
    assert re.fullmatch(
        r"use it; no further experiment required: the nearest rival has a delta score "
        r"of \d+ \(limit 15\)",
        far,
    )
    assert next_step(found("ambiguous")).startswith(("delay@", "sensor_lowpass@"))


def test_every_explanation_that_was_tried_has_its_reason() -> None:
    """Every row of the ranking has a reason."""
    diagnosis = found("named")
    reasons = [why_lost(one, diagnosis) for one in diagnosis.candidates]
    assert all(reasons)
    assert reasons[0] == "the best"
    assert reasons[-1].startswith("chi2/dof above")


def test_before_and_after_stand_in_the_table_of_where() -> None:
    """Five columns where something was named, four where nothing was."""
    tables = {
        verdict: next(
            item
            for section in gap_report(found(verdict), title="made").sections
            if section.anchor == "where"
            for item in section.items
            if isinstance(item, DataTable)
        )
        for verdict in ("named", "unknown")
    }
    assert tables["named"].columns[-2:] == ("chi2/dof before", "chi2/dof after")
    assert tables["unknown"].columns[-1] == "chi2/dof before"
    assert all(len(row) == 5 for row in tables["named"].rows)


@pytest.mark.parametrize("verdict", VERDICTS)
@pytest.mark.parametrize("width", [80, 120])
def test_the_terminal_never_runs_over_its_width(
    verdict: str, width: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every line fits, and the verdict is the first of them."""
    screen = Console(width=width, record=True, highlight=False, markup=False)
    monkeypatch.setattr(gap_output, "console", lambda target: screen)
    show_diagnosis(found(verdict), None)
    lines = screen.export_text().splitlines()
    assert lines[0] == f"verdict: {verdict}"
    assert max(len(line.rstrip()) for line in lines) <= width
    assert any(line.startswith("next:") for line in lines)


def test_an_effect_that_only_the_priors_show_is_titled_by_prior_deviation() -> None:
    """An added mass leaves no gap: the title gives the prior deviation instead."""
    hidden = [("added_mass", "body:m2", [0.3])]
    outcome, bench = outcomes.outcome_of(hidden, ("added_mass", "body:m2"))
    diagnosis = conclude(outcome, bench)
    assert diagnosis.verdict is Finding.NAMED
    assert "parameters back to their nominal values" in headline(diagnosis)
    labels = [tile.label for tile in gap_report(diagnosis, title="made").tiles]
    assert "reduced by" not in labels


def test_a_weak_effect_is_titled_by_its_directed_test() -> None:
    """A delay of 0.2 us leaves hardly a gap and no prior deviation."""
    outcome, bench = outcomes.outcome_of(
        [("delay", "channel:a0", [2e-7])], ("delay", "channel:a0"), samples=1024
    )
    diagnosis = conclude(outcome, bench)
    assert diagnosis.gap_before.value < 0.3
    largest, limit = diagnosis.null_statistic
    assert largest > limit
    assert f"lowers chi2 by {largest:.0f}" in headline(diagnosis)
    where = diagnosis.evidence.where if diagnosis.evidence else ""
    assert "from its nominal value" not in where


def test_names_out_of_a_file_cannot_break_out_of_the_page() -> None:
    """A channel called like a script stays text."""
    diagnosis = replace(found("named"), reason="<script>alert(1)</script>")
    assert "<script>alert(1)" not in render(gap_report(diagnosis, title="<b>x</b>"))


def test_a_diagnosis_without_evidence_still_makes_a_report() -> None:
    """The picture is left out, the rest stays."""
    report = gap_report(replace(found("named"), evidence=None), title="made")
    assert report.sections[0].anchor == "effects"
    assert diagnosis_json(replace(found("named"), evidence=None))["exhibit"] is None


def test_pairs_are_put_into_words() -> None:
    """Names lose their underscores, sites become places."""
    words = effect_words("preload_stiffness@link:joint + hidden_mode@body:m2")
    assert words == "preload stiffness in the joint and hidden mode on body m2"


def test_the_provenance_holds_the_policy_of_the_verdict() -> None:
    """Every decision setting is listed, and a varied policy is marked as such."""
    diagnosis = found("named")
    section = gap_report(diagnosis, title="made").sections[-1]
    assert section.anchor == "provenance"
    fold = next(item for item in section.items if isinstance(item, ItemGroup))
    table = next(item for item in fold.items if isinstance(item, DataTable))
    names = [row[0] for row in table.rows]
    assert names == [setting.name for setting in settings_of(STANDARD)]
    page = render(gap_report(diagnosis, title="made"))
    assert f"digest {policy_digest(STANDARD)[:16]}" in page
    varied = replace(diagnosis, policy=replace(STANDARD, rival_score=20.0))
    page = render(gap_report(varied, title="made"))
    assert "a varied policy" in page
    assert "a delta score of 20 (" in page


def test_a_mostly_verdict_has_its_law_rivals_and_linear_error_everywhere() -> None:
    """JSON, terminal and page state family, what is left and the linear error."""
    diagnosis = found("mostly")
    stated = diagnosis_json(diagnosis)
    assert stated["verdict"] == "mostly"
    assert stated["effects"] == []
    mostly = stated["mostly"]
    assert (mostly["family"], mostly["site"]) == ("stiffness", "link:joint")
    assert mostly["share_explained"] > 0.5
    assert {row["channel"] for row in mostly["linear_discrepancy"]} == {"a0", "a1"}
    screen = Console(width=200, record=True)
    gap_output.show_on(screen, diagnosis)
    terminal = screen.export_text()
    for label in ("verdict: mostly", "law:", "rivals:", "left:", "linear:", "checked:"):
        assert label in terminal
    report = gap_report(diagnosis, title="made")
    section = next(s for s in report.sections if s.anchor == "model-error")
    assert [i.identifier for i in section.items if isinstance(i, Plot)] == [
        "left",
        "discrepancy",
    ]
    assert contradictions(diagnosis, frozenset({"cubic_stiffness"})) == []
