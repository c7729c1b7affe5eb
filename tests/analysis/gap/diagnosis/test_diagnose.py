# SPDX-License-Identifier: MIT
"""From a campaign to a verdict: names, refusals, limits and the JSON contract."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import gap_bench as made
import gap_outcomes as outcomes
import h5py
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.analysis.gap.catalogue.linear_effects import LINEAR
from jointbench.analysis.gap.diagnosis.diagnose import conclude, diagnose
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.analysis.gap.judgement.campaign_limits import campaign_limits, flat_tops
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Finding,
    diagnosis_json,
)
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.search.descent import minimise

LATE = ("delay", "channel:a1", [4e-5])


@pytest.fixture(scope="module")
def complete() -> Diagnosis:
    """Return the diagnosis of a campaign with a complete model."""
    return diagnose(made.made_campaign([]))


def test_a_complete_model_gives_the_verdict_none(complete: Diagnosis) -> None:
    """Verdict none, no effect, no gap beyond noise."""
    assert complete.verdict is Finding.NONE
    assert complete.effects == ()
    assert complete.gap_before.chi2_per_dof == pytest.approx(1.0, abs=0.06)


def test_a_hidden_delay_is_named_with_site_size_and_a_smaller_gap(
    late: Diagnosis,
) -> None:
    """A delay of 40 microseconds is found within 4 sd; the gap closes."""
    assert late.verdict is Finding.NAMED
    (effect,) = late.effects
    assert (effect.name, effect.site) == ("delay", "channel:a1")
    (tau,) = effect.parameters
    assert abs(tau.value - 4e-5) < 4 * tau.sd
    assert late.shrink > 0.9


def test_an_effect_that_one_condition_shows_is_named_but_not_predicted() -> None:
    """Hits at 4 kN do not predict the one at 8 kN: held out, its gap remains."""
    found = diagnose(
        made.made_campaign([("preload_stiffness", "link:joint", [0.3])]),
        entries=LINEAR,
    )
    assert [e.name for e in found.effects] == ["preload_stiffness"]
    assert found.gap_before.value > 100.0
    assert 0.5 < found.gap_after.value / found.gap_before.value <= 1.0
    assert "not predicted by the others" in found.reason


def test_an_effect_that_all_conditions_show_is_predicted(late: Diagnosis) -> None:
    """The reason has no sentence on a single condition."""
    assert late.gap_after.value < 0.1 * late.gap_before.value
    assert "not predicted" not in late.reason


def test_a_delay_outside_the_catalogue_is_not_called_by_another_name(
    late_campaign: Campaign,
) -> None:
    """Without delay in the catalogue, no other effect explains it."""
    found = diagnose(late_campaign, without=frozenset({"delay"}), entries=LINEAR)
    assert found.verdict is Finding.UNKNOWN
    assert found.reason


def test_the_json_holds_the_keys_of_the_contract(complete: Diagnosis) -> None:
    """Plain JSON, with the keys that scripts rely on."""
    text = json.dumps(diagnosis_json(complete))
    keys = set(json.loads(text))
    assert keys >= {
        "verdict",
        "effects",
        "candidates",
        "where",
        "gap_before",
        "gap_after",
        "shrink",
        "experiment",
    }


def test_an_effect_of_all_rivals_has_their_summed_confidence() -> None:
    """Two pairs share a delay: its confidence is the sum of that of the others."""
    outcome, bench = outcomes.outcome_of([LATE], ("delay", "channel:a1"))
    delay = outcome.best
    pairs = [pair_with(bench, delay, name) for name in ("extra_damping", "maxwell")]
    both = replace(outcome, ranked=tuple(pairs), best=pairs[0], level=tuple(pairs))
    found = conclude(both, bench)
    assert found.verdict is Finding.AMBIGUOUS
    found_by = {e.name: e.confidence for e in found.effects}
    both_others = found_by["extra_damping"] + found_by["maxwell"]
    assert found_by["delay"] == pytest.approx(both_others)
    assert len(found.explanations) == 2
    assert found.experiment.startswith(("extra_damping", "maxwell"))
    assert "delay" not in found.experiment
    named = replace(both, ranked=(pairs[0], delay, pairs[1]), level=(pairs[0],))
    alone = conclude(named, bench).experiment
    assert alone.startswith("no further experiment required: the nearest rival")


def pair_with(bench: LumpedBench, first: Fit, name: str) -> Fit:
    """Return a fit with one more effect at its smallest start."""
    more = next(c for c in bench.candidates if c.effect.name == name)
    start = [p.encode(p.starts[0]) if p.starts else 0.0 for p in more.effect.parameters]
    problem = make_problem(bench, (*first.candidates, more))
    return minimise(problem, np.concatenate([first.x, start]))


@pytest.mark.parametrize("clipped", [False, True])
def test_flat_tops_are_those_of_a_clipped_channel_only(clipped: bool) -> None:
    """The crest of a slow oscillation has as many samples at its top, but is round."""
    time = np.arange(2048) / 16384.0
    ring = np.sin(2 * np.pi * 50.0 * time) * np.exp(-20.0 * time)
    noise = 0.002 * np.random.default_rng(4).standard_normal(time.size)
    record = np.clip(ring, -0.6, 0.6) if clipped else ring
    found = flat_tops((record + noise)[None, None], np.array([[0.002]]))
    assert found == ([0] if clipped else [])


def test_one_level_only_is_a_reason_not_to_name() -> None:
    """The reason states what to do."""
    campaign = made.quiet_campaign()
    level = np.abs(campaign.force).max(axis=1)
    flat = replace(campaign, force=campaign.force * (300.0 / level)[:, None])
    assert "one level" in campaign_limits(flat)


def test_no_repeats_are_a_reason_not_to_name() -> None:
    """Without a repeat there is no repeatability."""
    campaign = made.quiet_campaign()
    alone = replace(campaign, level=campaign.level + np.arange(8.0))
    assert "twice" in campaign_limits(alone)
    assert campaign_limits(campaign) == ""


def write(path: Path, campaign: Campaign, change: Callable[[h5py.File], None]) -> None:
    """Write a campaign file and change it."""
    with h5py.File(path, "w") as file:
        file.attrs["schema"] = "two-body-campaign/1"
        file.attrs["fs_hz"] = campaign.sample_rate
        file.attrs["nominal"] = json.dumps(made.NOMINAL)
        file.attrs["nominal_rel_sigma"] = json.dumps(made.SPREAD)
        for i in range(campaign.force.shape[0]):
            record = file.create_group(f"records/r{i:02d}")
            record["force"] = campaign.force[i].astype(np.float32)
            record["accel"] = campaign.response[i].astype(np.float32)
            record.attrs["level_N"] = campaign.level[i]
            record.attrs["hit_dof"] = int(campaign.hit[i])
            record.attrs["preload_N"] = campaign.preload[i]
            record.attrs["order"] = i
        change(file)


def nothing(file: h5py.File) -> None:
    """Leave the file unchanged."""


def put_nan(file: h5py.File) -> None:
    """Make one sample NaN."""
    file["records/r03/accel"][1, 40] = np.nan


def wrong_schema(file: h5py.File) -> None:
    """State another schema."""
    file.attrs["schema"] = "something/2"


def no_nominal(file: h5py.File) -> None:
    """Remove the nominal parameters."""
    del file.attrs["nominal"]


def bad_nominal(file: h5py.File) -> None:
    """Give a mass of zero."""
    file.attrs["nominal"] = json.dumps({**made.NOMINAL, "m2": 0.0})


def test_a_campaign_file_is_read_as_it_was_written(tmp_path: Path) -> None:
    """Forces, hits and preloads survive the file."""
    path = tmp_path / "c.h5"
    campaign = made.made_campaign([])
    write(path, campaign, nothing)
    read = read_campaign(path)
    assert np.allclose(read.force, campaign.force, rtol=1e-6, atol=1e-6)
    assert read.hit.tolist() == campaign.hit.tolist()
    assert read.model.nominal.tolist() == campaign.model.nominal.tolist()


@pytest.mark.parametrize(
    ("change", "error", "word"),
    [
        (put_nan, BadData, "r03"),
        (wrong_schema, FormatError, "something/2"),
        (no_nominal, FormatError, "nominal"),
        (bad_nominal, BadData, "m2"),
    ],
)
def test_a_spoilt_campaign_file_is_refused_by_name(
    tmp_path: Path,
    change: Callable[[h5py.File], None],
    error: type[Exception],
    word: str,
) -> None:
    """The message names what is wrong."""
    path = tmp_path / "c.h5"
    write(path, made.quiet_campaign(), change)
    with pytest.raises(error, match=word):
        read_campaign(path)


def test_records_that_are_too_short_are_refused(tmp_path: Path) -> None:
    """The message states the required number of samples."""
    path = tmp_path / "c.h5"
    write(path, made.quiet_campaign(samples=256), nothing)
    with pytest.raises(BadData, match="512"):
        read_campaign(path)
