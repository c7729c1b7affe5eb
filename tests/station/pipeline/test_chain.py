# SPDX-License-Identifier: MIT
"""The chain from recordings to modes: estimator, manual choices, lost samples."""

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from frozen_numbers import frozen

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.recordings import (
    Channel,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.acquisition.session_file.store import read_session
from jointbench.signal.frf.estimators import Estimator
from jointbench.signal.frf.frf import estimate_frf
from jointbench.signal.hits.find_hits import HitCriteria
from jointbench.station.pipeline.chain import ModalChain, run_chain
from jointbench.station.pipeline.judge_again import StoredHits, judge_again
from jointbench.station.pipeline.modal_options import modal_settings
from jointbench.station.results.results_file import write_results

RATE = 4096.0
FREQUENCY, DAMPING = np.array([150.0, 420.0]), np.array([0.01, 0.012])


def two_hits(*, lost: slice | None = None) -> Recording:
    """Two hits on two modes, a little noise; samples that stand still where lost."""
    time = np.arange(int(2 * RATE)) / RATE
    rng = np.random.default_rng(4)
    force, rings = rng.normal(0.0, 1e-3, time.size), rng.normal(0.0, 1e-3, time.size)
    for begin in (0.1, 1.1):
        since = time - begin
        on = (since >= 0.0) & (since < 0.002)
        force[on] += 50.0 * np.sin(np.pi * since[on] / 0.002)
        omega, late = 2.0 * np.pi * FREQUENCY[:, None], np.maximum(since - 0.001, 0.0)
        decay = np.exp(-DAMPING[:, None] * omega * late) * (since > 0.001)
        rings += np.sum(decay * np.sin(omega * late), axis=0)
    if lost is not None:
        rings[lost] = 0.0
    channels = (
        Channel("force", Quantity.FORCE, point="1"),
        Channel("a1", Quantity.ACCELERATION, point="1"),
    )
    return Recording("two hits", np.array([force, rings]), RATE, channels)


def damping_error(chain: ModalChain) -> float:
    """Return the largest relative error of damping of the two modes."""
    model = chain.result.model
    near = [int(np.argmin(np.abs(model.natural_frequency - f))) for f in FREQUENCY]
    assert np.allclose(model.natural_frequency[near], FREQUENCY, rtol=2e-3)
    return float(np.max(np.abs(model.damping_ratio[near] / DAMPING - 1.0)))


def test_a_gap_in_the_response_is_filled_before_the_frf() -> None:
    """120 lost samples of a ring: damping within 0.5 % (11 % unrepaired)."""
    chain = run_chain([two_hits(lost=slice(700, 820))])
    steps = {s.name: dict(s.detail) for s in chain.provenance}
    assert steps["repair_dropouts"]["filled_a1"] == 120
    assert damping_error(chain) < 0.005


def test_whole_recordings_are_left_as_recorded() -> None:
    """No step that repairs where nothing is broken."""
    chain = run_chain([two_hits()])
    assert "repair_dropouts" not in {s.name for s in chain.provenance}
    assert damping_error(chain) < 0.02


def test_the_results_file_says_who_chose_each_mode(tmp_path: Path) -> None:
    """One mode kept by hand, one chosen by the program."""
    settings = modal_settings(None, None, "Hv", (150.0,), ())
    chain = run_chain([two_hits()], settings)
    target = tmp_path / "r.h5"
    write_results(target, chain, [])
    near = int(np.argmin(np.abs(chain.result.model.natural_frequency - 150.0)))
    with h5py.File(target) as file:
        chosen = file["modes/chosen_by"][:]
    assert chosen[near] == 1
    assert chosen.sum() == 1
    detail = next(dict(s.detail) for s in chain.provenance if s.name == "estimate_frf")
    assert detail["estimator"] == Estimator.HV.value


def test_a_mode_dropped_by_hand_is_gone() -> None:
    """420 Hz is left out, 150 Hz stays."""
    settings = modal_settings(None, None, "H1", (), (420.0,))
    found = run_chain([two_hits()], settings).result.model.natural_frequency
    assert np.min(np.abs(found - 420.0)) > 4.2
    assert np.min(np.abs(found - 150.0)) < 0.3


@pytest.mark.parametrize(
    ("estimator", "keep", "said"), [("H3", (), "H1, H2 or Hv"), ("H1", (-5.0,), "Hz")]
)
def test_options_that_mean_nothing_are_refused(
    estimator: str, keep: tuple[float, ...], said: str
) -> None:
    """The message names what to write."""
    with pytest.raises(UsageError, match=said):
        modal_settings(None, None, estimator, keep, ())


def one_hit(seed: int, peak: float) -> Recording:
    """One hit of `peak` newtons: the same samples scaled, level is all that differs."""
    both = two_hits()
    noise = np.random.default_rng(seed).normal(0.0, 1e-3, (2, 4096))
    samples = both.samples[:, :4096] * (peak / 50.0) + noise
    return Recording(f"hit {seed}", samples, RATE, both.channels)


def test_a_glancing_hit_in_a_file_of_its_own_enters_no_average() -> None:
    """2 N in one of five files, 50 N in the others: the average has four."""
    peaks = (50.0, 46.0, 2.0, 52.0, 55.0)
    chain = run_chain([one_hit(i, peak) for i, peak in enumerate(peaks)])
    verdicts = [recording.hits[0].verdict for recording in chain.recordings]
    assert verdicts == [Verdict.WEAK if p == 2.0 else Verdict.OK for p in peaks]
    assert chain.frf.averages == 4


def test_an_frf_of_unjudged_recordings_leaves_the_glancing_hit_out() -> None:
    """The same without the chain about it."""
    peaks = (50.0, 46.0, 2.0, 52.0)
    assert estimate_frf([one_hit(i, p) for i, p in enumerate(peaks)]).averages == 3


def test_hits_judged_again_are_compared_with_the_whole_session() -> None:
    """As `process` does; a stored level of the plan counts before the others'."""
    recordings = [one_hit(i, p) for i, p in enumerate((50.0, 46.0, 2.0, 20.0))]
    asked = (step("record", level=80.0),)
    recordings[3] = replace(recordings[3], provenance=asked)
    found = judge_again(recordings, HitCriteria(), StoredHits(again=True))
    hits = [own.hits for own in found]
    verdicts = [own[0].verdict for own in hits]
    assert verdicts == [Verdict.OK, Verdict.OK, Verdict.WEAK, Verdict.WEAK]
    assert "the planned level, 80 N" in hits[3][0].reason


def test_rounding_does_not_decide_the_interval_of_a_mode() -> None:
    """Records that end before their decays; samples differ by 4e-10 of themselves."""
    recordings = read_session(frozen("0.1.0") / "visit.h5").recordings
    rng = np.random.default_rng(4)
    moved = [
        replace(r, samples=r.samples * (1.0 + 4e-10 * rng.normal(size=r.samples.shape)))
        for r in recordings
    ]
    one, other = (
        [mode.soft.frequency_sd for mode in run_chain(records).amplitude]
        for records in (recordings, moved)
    )
    np.testing.assert_allclose(other, one, rtol=1e-3)
