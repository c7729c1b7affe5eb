"""Whole campaigns: the files of a recorded bench, its truth, and margins."""

import json
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.flexible.draw_flexible_bench import draw_bench
from jointbench.simulators.flexible.flexible_effects import (
    FLEXIBLE_EFFECTS,
    FLEXIBLE_OUTSIDE,
    FlexibleEffect,
    rocking_arms,
)
from jointbench.simulators.flexible.flexible_margin import flexible_margin
from jointbench.simulators.flexible.flexible_url import bench_of_flexible_url
from jointbench.simulators.flexible.hit_records import PRETRIGGER, SAMPLES, BadHit
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.structure_model import StructureModel
from jointbench.station.sources.record_flexible import run_record_flexible

URL = "sim:lap-beam?seed=25&hide=loose_bolt,joint_compliance_normal"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a recorded campaign."""
    place = tmp_path_factory.mktemp("flexible")
    run_record_flexible(URL, place / "hits.h5", overwrite=False, json_target=None)
    return place


def test_a_recorded_bench_has_raw_hits_and_modal_tables(folder: Path) -> None:
    """Schema, shapes, and the rows that a model needs."""
    bench = bench_of_flexible_url(URL)
    with h5py.File(folder / "hits.h5") as file:
        assert file.attrs["schema"] == "campaign/1"
        channels = json.loads(str(file.attrs["channels"]))
        assert len(file["records"]) == len(bench.hits)
        data = np.asarray(file["records/r000/data"])
        assert data.shape == (len(channels), SAMPLES)
        modes = np.asarray(file["model/top/freq_hz"]).size
        bolts = len(bench.specimen.bolts)
        assert file["model/top/phi_bolts"].shape == (bolts, 3, modes)
        point = next(p.name for p in bench.specimen.points if p.body == 1)
        assert file[f"model/top/phi_hit_gradient/{point}"].shape == (3, 3, modes)


def test_bad_hits_are_what_the_truth_says(folder: Path) -> None:
    """An overload reaches the range; nothing else does."""
    truth = json.loads((folder / "hits.truth.json").read_text(encoding="utf-8"))
    with h5py.File(folder / "hits.h5") as file:
        clipped = {
            name
            for name, record in file["records"].items()
            if np.abs(np.asarray(record["data"], dtype=float)).max() >= 2**23 - 1
        }
    bad = truth["bad_hits"]
    assert clipped == {name for name, kind in bad.items() if kind == "overload"}
    assert set(bad.values()) <= {str(kind) for kind in BadHit}


def test_a_hidden_compliance_counts_as_rigid_before(folder: Path) -> None:
    """The nominal values say rigid; the truth has a stiffness and the loose bolt."""
    nominal = json.loads((folder / "hits.sheet.json").read_text(encoding="utf-8"))
    truth = json.loads((folder / "hits.truth.json").read_text(encoding="utf-8"))
    assert nominal["joint_per_bolt"]["kn_N_per_m"] == "rigid"
    assert truth["effects"]["joint_compliance_normal"]["kn"] > 1e6
    assert truth["truth"] == ["loose_bolt", "joint_compliance_normal"]
    assert 0 <= truth["where"]["loose_bolt"]["bolt"] < len(nominal["bolts_mm"])


def test_a_recorded_bench_is_a_model_of_meshed_bodies_too(folder: Path) -> None:
    """Both bodies, an area for each bolt, every sensor and hammer point."""
    bench = bench_of_flexible_url(URL)
    model = read_toml(folder / "hits.model.toml", StructureModel)
    assert set(model.bodies) == {"bottom", "top"}
    assert len(model.joints["bolts"].patches) == len(bench.specimen.bolts)
    assert list(model.sensors) == [one.name for one in bench.specimen.sensors]
    assert list(model.hits) == [one.name for one in bench.specimen.points]
    assert model.gap is not None and model.gap.bolt.normal == "rigid"


def test_earlier_files_are_not_replaced_without_force(folder: Path) -> None:
    """The message names the option."""
    with pytest.raises(UsageError, match="--force"):
        run_record_flexible(URL, folder / "hits.h5", overwrite=False, json_target=None)


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("sim:lap-beam?seed=x", "whole number"),
        ("sim:lap-beam?sed=1", "did you mean 'seed'"),
        ("sim:lap-beam?hide=loose", "effect 'loose' is unknown"),
        ("sim:lap-beam?world=real", "world is 'real'"),
        ("sim:two-body", "no flexible bench"),
    ],
)
def test_a_wrong_url_is_refused(url: str, words: str) -> None:
    """One line with the value and a remedy."""
    with pytest.raises(UsageError, match=words):
        bench_of_flexible_url(url)


def test_a_table_of_real_life_is_off_by_its_errors() -> None:
    """0.2 to 1 % in frequency and 2 % in shape; the rigid modes are exact."""
    bench = draw_bench(5, kind="lap-beam", world="life", beyond=4)
    for body in bench.bodies:
        ratio = body.frequency[6 : body.listed] / body.table_frequency[6:]
        assert 1e-3 < float(np.std(ratio)) < 0.02
        change = body.mixing - np.eye(body.frequency.size)
        assert float(np.mean(np.linalg.norm(change[:, 6:], axis=0))) == pytest.approx(
            0.02, rel=0.05
        )
        assert_allclose(body.mixing.T @ body.mixing, np.eye(len(change)), atol=1e-12)
        assert body.frequency.size == body.listed + 4


def test_levels_span_a_factor_of_thirty_and_records_begin_quietly() -> None:
    """Of every hit, the first contact lies within a few samples of the trigger."""
    bench = draw_bench(5, kind="lap-beam")
    assert bench.levels[-1] / bench.levels[0] == pytest.approx(30, rel=0.06)
    starts = [hit.pulses[0].start * 25600 for hit in bench.hits]
    assert all(PRETRIGGER - 6 < start < PRETRIGGER for start in starts)


def test_every_effect_can_be_drawn() -> None:
    """Their parameters are finite, and each knows its place."""
    names = FLEXIBLE_EFFECTS + FLEXIBLE_OUTSIDE
    bench = draw_bench(12, kind="lap-beam", effects=names)
    assert tuple(effect.name for effect in bench.effects) == names
    for effect in bench.effects:
        assert effect.where
        assert all(np.isfinite(list(effect.parameters.values())))


def test_the_base_follows_part_of_a_loose_bolt() -> None:
    """A bolt 10 % softer, at 3 % from bolt to bolt, stands out but not as a whole."""
    bench = draw_bench(12, kind="lap-beam")
    effect = FlexibleEffect("loose_bolt", {"bolt": 1}, {"factor": 0.9})
    found = flexible_margin(replace(bench, effects=(effect,)), "loose_bolt")
    assert 10 < found.rho < 0.7 * found.alone
    assert found.margin == pytest.approx(found.rho**2)


@pytest.mark.parametrize("name", ["contact_patch", "joint_compliance_rocking"])
def test_a_joint_tilts_about_an_axis_that_its_bolts_do_not_lie_on(name: str) -> None:
    """The bolts of a lap joint are in one line, along which nothing would move."""
    for seed in range(12, 18):
        bench = draw_bench(seed, kind="lap-beam", effects=(name,))
        arms = rocking_arms(bench.specimen, str(bench.effects[0].where["axis"]))
        assert np.ptp(arms) > 0.01
