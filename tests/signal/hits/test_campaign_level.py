# SPDX-License-Identifier: MIT
"""Glancing hits in files of one hit each, detected by the level of campaign or plan."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.recordings import (
    Channel,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.signal.hits.campaign_level import compare_levels, softest_level
from jointbench.signal.hits.find_hits import find_hits
from jointbench.signal.hits.hit_verdicts import HitLimits

PLATES = Path(__file__).parents[4] / "shared/data/plates-campaigns"
RATE = 10_000.0
CHANNELS = (Channel("force", Quantity.FORCE), Channel("a1", Quantity.ACCELERATION))


def struck(*peaks: float, name: str = "r") -> Recording:
    """Return a recording of half sines of 1 ms, one a second, hits judged."""
    force = np.zeros(round(RATE) * len(peaks))
    pulse = np.sin(np.pi * np.arange(11) / 10)
    for number, peak in enumerate(peaks):
        at = round(RATE) * number + 500
        force[at : at + 11] = peak * pulse
    return find_hits(Recording(name, np.array([force, 0 * force]), RATE, CHANNELS))


def singles(*peaks: float) -> list[Recording]:
    """Return one recording for each hit."""
    return [struck(peak, name=f"r{i}") for i, peak in enumerate(peaks)]


def refused(recordings: list[Recording], limits: HitLimits | None = None) -> set[float]:
    """Return the peaks that are called weak [N], rounded."""
    compared = compare_levels(recordings, limits or HitLimits())
    hits = [hit for recording in compared for hit in recording.hits]
    return {round(h.peak_force) for h in hits if h.verdict is Verdict.WEAK}


def test_a_glancing_hit_in_a_file_of_its_own_is_weak() -> None:
    """4 N among files of one hit of about 80 N: 5 % of the campaign's level."""
    peaks = singles(80.0, 76.0, 4.0, 88.0, 71.0)
    assert refused(peaks) == {4.0}
    hit = compare_levels(peaks, HitLimits())[2].hits[0]
    assert hit.measure == pytest.approx(4.0 / 78.0)
    assert "the campaign's level, 78 N (limit 33 %)" in hit.reason


def test_levels_meant_to_differ_are_kept() -> None:
    """80, 300 and 1200 N on purpose; two glancing hits of one peak make no level."""
    hits = [80, 75, 300, 310, 1200, 1150, 82, 290, 1250, 79, 4, 7]
    assert refused(singles(*map(float, hits))) == {4.0, 7.0}


@pytest.mark.parametrize(
    "peaks",
    [
        (30.0, 100.0, 300.0, 1000.0),
        (30.0, 33.0, 100.0, 95.0, 300.0, 290.0, 1000.0),
        (27.3, 183.6, 965.1, 194.2, 206.6, 917.5, 192.7, 212.2),
        (30.0, 100.0, 95.0, 300.0),
        (100.0,),
        (100.0, 40.0),
    ],
)
def test_steps_of_a_ladder_are_no_glancing_hits(peaks: tuple[float, ...]) -> None:
    """Once or twice each, the softest once, up to seven times below the next."""
    assert refused(singles(*peaks)) == set()


def test_two_hits_far_apart_need_no_third() -> None:
    """5 N beside 100 N."""
    assert refused(singles(100.0, 5.0)) == {5.0}


def test_a_soft_recording_with_a_level_of_its_own_is_kept() -> None:
    """Three hits of 10 N in one file, forty of 100 N in others."""
    soft = struck(10.0, 11.0, 9.5, name="soft")
    assert refused([soft, *singles(*[100.0] * 40)]) == set()


def test_the_level_of_the_plan_counts_before_any_other() -> None:
    """150 N where 1200 N were asked for, in a campaign that has 80 N as well."""
    levels = singles(80.0, 82.0, 1200.0, 1190.0)
    asked = replace(
        struck(150.0, name="asked"), provenance=(step("record", level=1200.0),)
    )
    assert refused([*levels, asked]) == {150.0}
    assert refused([*levels, struck(150.0)]) == set()


def test_verdicts_that_are_kept_stay_as_they_are_and_count_as_company() -> None:
    """Only the last recording is new."""
    found = compare_levels(
        singles(80.0, 4.0, 82.0, 1.5), HitLimits(), [False, False, False, True]
    )
    verdicts = [recording.hits[0].verdict for recording in found]
    assert verdicts == [Verdict.OK, Verdict.OK, Verdict.OK, Verdict.WEAK]


def test_overloads_make_no_level() -> None:
    """Were 4000 N a level, 25 N below 100 N could be a step of a ladder."""
    hit = struck(4000.0).hits[0]
    clipped = replace(struck(4000.0), hits=(replace(hit, verdict=Verdict.OVERLOAD),))
    assert refused([*singles(100.0, 96.0, 105.0, 25.0), clipped, clipped]) == {25.0}


def test_the_softest_level_is_the_median_of_its_hits() -> None:
    """Two levels; one hit below them makes none."""
    found = softest_level(np.array([9.0, 100.0, 96.0, 104.0, 900.0, 950.0]), 0.1)
    assert found is not None
    assert (found.level, found.several) == (100.0, True)
    assert softest_level(np.array([10.0, 30.0, 100.0]), 0.1) is None


def campaign(folder: Path) -> Iterator[Recording]:
    """Yield the records of a campaign, one hit each."""
    with h5py.File(folder / "hits.h5") as file:
        facts = json.loads(file.attrs["channels"])
        volts = float(np.atleast_1d(file.attrs["full_scale_V"])[0])
        scale = np.array([c["sensitivity_V_per_unit"] for c in facts])
        counts = np.array([c["counts_to_V"] for c in facts])
        channels = tuple(
            Channel(c["name"], Quantity(c["quantity"]), range=volts / own)
            for c, own in zip(facts, scale, strict=True)
        )
        for name, record in file["records"].items():
            samples = record["data"][()] * (counts / scale)[:, None]
            yield Recording(name, samples, float(file.attrs["fs_hz"]), channels)


@pytest.mark.skipif(not PLATES.exists(), reason="no shared data")
def test_every_bad_hit_of_nine_campaigns_is_refused_and_no_good_one() -> None:
    """35 bad hits of 413, four of them glancing, in files of one hit each."""
    truth = json.loads((PLATES / "truth.json").read_text())
    passed, lost, alone = set(), set(), set()
    for name, answers in truth.items():
        bad = set(answers["bad_hits"])
        by_itself = [find_hits(recording) for recording in campaign(PLATES / name)]
        compared = compare_levels(by_itself, HitLimits())
        good = {r.name for r in compared if r.hits[0].verdict is Verdict.OK}
        alone |= {name + r.name for r in by_itself if r.hits[0].verdict is Verdict.OK}
        passed |= {name + n for n in good & bad}
        lost |= {name + r.name for r in compared if r.name not in good | bad}
    assert (passed, lost) == (set(), set())
    # What each hit shows by itself lets the four pass.
    assert len(alone) == 413 - 35 + 4
