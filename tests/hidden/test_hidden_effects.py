# SPDX-License-Identifier: MIT
"""Effects hidden by the simulators are found by the engine: fixed seeds.

The statistics over many campaigns: benchmarks/gap and docs/gap-confusion.md.
"""

from dataclasses import replace
from pathlib import Path

import pytest
from gap_contradictions import contradictions
from short_campaigns import SHORT, write_short

from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.diagnosis import base_fit
from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, Finding
from jointbench.analysis.gap.search.selection_round import Progress
from jointbench.simulators.campaigns.campaign_records import (
    SimulatedCampaign,
    campaign_noise_free,
    quick_campaign,
)
from jointbench.simulators.hidden.campaign_response import simulate_records
from jointbench.simulators.hidden.campaign_sampling import SAMPLES
from jointbench.simulators.hidden.hidden_effects import HiddenEffect


def diagnosed(
    campaign: SimulatedCampaign,
    folder: Path,
    *without: str,
    progress: Progress | None = None,
    samples: int = SHORT,
) -> Diagnosis:
    """Write a campaign to a file, and return its diagnosis.

    Its sentences must not contradict each other or the hidden effects.
    """
    path = folder / "campaign.h5"
    write_short(campaign, path, samples)
    found = diagnose(read_campaign(path), without=frozenset(without), progress=progress)
    assert contradictions(found, frozenset(e.name for e in campaign.effects)) == []
    return found


@pytest.mark.parametrize(("seed", "scatter"), [(901, 0.0), (902, 0.0015), (903, 0.002)])
def test_nothing_hidden_is_nothing_found(
    seed: int, scatter: float, tmp_path: Path
) -> None:
    """Verdict none, with and without scatter from hit to hit."""
    found = diagnosed(quick_campaign(seed, hit_scatter=scatter), tmp_path)
    assert found.verdict is Finding.NONE


@pytest.mark.parametrize("second_start", [True, False])
def test_a_base_in_a_wrong_minimum_is_found_again(
    second_start: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It starts again with the settling of each hit, before any effect is fitted.

    Without it, a fit of loosening moves the base to where it explains the records;
    a few candidates are enough for that.
    """
    left_out: set[str] = set()
    if not second_start:
        monkeypatch.setattr(
            base_fit, "DIAGNOSIS", replace(DIAGNOSIS, settled_share=0.0)
        )
        few = {"loosening", "preload_stiffness", "cubic_stiffness", "maxwell", "delay"}
        left_out = {entry.effect.name for entry in CATALOGUE} - few
    tried: list[str] = []
    campaign = quick_campaign(80290, hit_scatter=0.0019730039844606992)
    found = diagnosed(
        campaign, tmp_path, *left_out, progress=tried.append, samples=SAMPLES
    )
    assert found.verdict is Finding.NONE
    assert ("base again" in tried) != second_start
    assert (tried == ["base"]) == second_start
    assert found.null_statistic[0] < 1.3 * found.null_statistic[1]


@pytest.mark.parametrize(
    ("name", "size", "scatter"),
    [
        ("cubic_stiffness", 0.02, 0.0),
        ("gap", 0.02, 0.0),
        ("maxwell", 0.02, 0.001),
        ("hidden_mode", 0.2, 0.0),
        ("delay", 0.02, 0.0),
        ("preload_stiffness", 0.2, 0.0015),
        ("hum", 0.5, 0.0),
        ("saturation", 1.0, 0.002),
    ],
)
def test_one_hidden_effect_is_named_at_its_site(
    name: str, size: float, scatter: float, tmp_path: Path
) -> None:
    """Name and site are right, and the gap on held-out records closes."""
    campaign = quick_campaign(
        911, effects=(name,), size=size, grid="small", noise=0.05, hit_scatter=scatter
    )
    found = diagnosed(campaign, tmp_path)
    assert [(e.name, e.site) for e in found.effects] == [
        (e.name, e.site) for e in campaign.effects
    ]
    assert found.verdict is Finding.NAMED
    assert found.gap_after.value < 0.1 * found.gap_before.value + 0.2


def test_two_hidden_effects_are_both_named(tmp_path: Path) -> None:
    """A preload law of the joint and a mode of a body, one after the other."""
    names = ("preload_stiffness", "hidden_mode")
    campaign = quick_campaign(921, effects=names, size=0.2, grid="small", noise=0.05)
    found = diagnosed(campaign, tmp_path)
    assert {e.name for e in found.effects} == set(names)
    assert found.verdict is Finding.NAMED


def test_two_large_effects_are_both_named(tmp_path: Path) -> None:
    """A cubic spring and a delay of hundreds of times the noise each."""
    names = ("cubic_stiffness", "delay")
    campaign = quick_campaign(923, effects=names, size=1.0, grid="small", noise=0.05)
    found = diagnosed(campaign, tmp_path)
    assert {e.name for e in found.effects} == set(names)
    assert found.verdict is Finding.NAMED
    assert found.gap_before.chi2_per_dof > 30.0


def test_an_added_mass_and_a_relaxation_are_both_named(tmp_path: Path) -> None:
    """The records show the relaxation, but almost only the priors show the mass."""
    mass = HiddenEffect("added_mass", {"m": 0.4, "dof": 0.0})
    relaxation = HiddenEffect("maxwell", {"k": 1.809e6, "tau": 1.327e-4})
    plain = quick_campaign(93061)
    noise = plain.acceleration - campaign_noise_free(plain)[1]
    hidden = (mass, relaxation)
    clean = simulate_records(plain.design, hidden)[1]
    campaign = replace(plain, effects=hidden, acceleration=clean + noise)
    found = diagnosed(campaign, tmp_path)
    assert {e.name for e in found.effects} == {"added_mass", "maxwell"}
    assert found.verdict is Finding.NAMED


@pytest.mark.heavy(reason="a search that finds nothing tries every pair")
@pytest.mark.parametrize(
    ("name", "others"),
    [
        ("extra_damping", ()),
        ("hidden_mode", ()),
        # Friction takes most of the time, and is a rival in the other two cases.
        ("saturation", ("jenkins", "iwan", "bouc_wen", "coulomb")),
    ],
)
def test_an_effect_outside_the_catalogue_gets_no_other_name(
    name: str, others: tuple[str, ...], tmp_path: Path
) -> None:
    """An effect is missing, and the verdict is that it is unknown."""
    campaign = quick_campaign(931, effects=(name,), size=0.3, grid="small", noise=0.05)
    assert diagnosed(campaign, tmp_path, name, *others).verdict is Finding.UNKNOWN
