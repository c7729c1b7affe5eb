"""Every source of ``jointbench gap``: sessions, records, model files, URLs."""

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.records.recordings import Verdict
from jointbench.acquisition.records.session import JointSetup
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.station.commands.record_command import run_record
from jointbench.station.files.toml_file import read_toml
from jointbench.station.gap.run_gap import run_gap
from jointbench.station.main import app, exit_code
from jointbench.station.pipeline.process_session import curves_at, process_session
from jointbench.station.pipeline.stage_store import NoStore
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.gap_model import nominal_parameters
from jointbench.station.schemas.recipe import read_recipe
from jointbench.station.sources.open_source import open_runs
from jointbench.station.sources.recorded_session import record_session_file

URL = "sim:two-body-campaign?seed=5&grid=small"
SILVERBOX = Path(__file__).parents[4] / "shared/data/silverbox/SNLS80mV.mat"
EXAMPLE = Path(__file__).parents[3] / "examples" / "silverbox.toml"


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Record a bench with nothing hidden, once."""
    path = tmp_path_factory.mktemp("recorded") / "session.h5"
    run_record(URL, path, overwrite=False, json_target=None)
    return path


def gap(source: Path | str, target: Path, **options: Any) -> dict[str, Any]:
    """Run the command and return its JSON."""
    options = {"without": None, "report": None} | options
    run_gap(source, json_target=str(target), **options)
    content: dict[str, Any] = json.loads(target.read_text())
    return content


def all_but(*names: str) -> str:
    """Return the other names of the catalogue, as an option takes them."""
    return ",".join(sorted({e.effect.name for e in CATALOGUE} - set(names)))


def typed(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """Return the exit code of what a user types."""
    monkeypatch.setattr(sys, "argv", ["jointbench", *words])
    return exit_code(app, debug=False)


def test_a_recorded_campaign_is_a_session_with_preloads_and_its_model(
    recorded: Path,
) -> None:
    """Points, levels over 30x, preloads; the truth stays in a file of its own."""
    session = read_session(recorded)
    hits = [hit for recording in session.recordings for hit in recording.hits]
    assert {hit.point for hit in hits} == {"1", "2"}
    peaks = [hit.peak_force for hit in hits]
    assert max(peaks) / min(peaks) > 25
    assert len({recording.preload for recording in session.recordings}) == 2
    times = [recording.start_time for recording in session.recordings]
    assert times == sorted(times)
    assert session.simulated
    assert recorded.with_suffix(".truth.json").exists()
    model = nominal_parameters(
        read_toml(recorded.with_suffix(".toml"), BenchModel)
    ).model
    assert model.base_names == (
        "m1",
        "m2",
        "k_ground",
        "k_joint",
        "c_ground",
        "c_joint",
    )
    assert model.spread[:2] == pytest.approx(0.003, rel=1e-2)


def test_the_crossed_grid_has_every_condition_twice() -> None:
    """Two points, four levels over 30x, three preloads, two repeats."""
    runs = open_runs("sim:two-body-campaign?seed=2").runs
    assert len(runs) == 2 * 4 * 3 * 2
    assert len({(run.preload, run.channels[0].point) for run in runs}) == 6


def test_a_session_with_nothing_hidden_misses_nothing(
    recorded: Path, tmp_path: Path
) -> None:
    """The same path a bench session takes, with the model as --model.

    No mode depends on amplitude: the curves that are asked for state that.
    """
    found = gap(
        recorded,
        tmp_path / "g.json",
        model=recorded.with_suffix(".toml"),
        curves=True,
        report=tmp_path / "g.html",
    )
    assert found["verdict"] == "none"
    assert found["scored"] == []
    assert found["curves"]["hits"] >= 4
    assert all("mode" in words for words in found["curves"]["words"])
    assert not any(mode["predicted"] for mode in found["curves"]["modes"])
    assert "Modes over amplitude" in (tmp_path / "g.html").read_text()


def test_process_compares_its_curves_with_the_explanations(
    recorded: Path, tmp_path: Path
) -> None:
    """`process` gives the gap the modes over amplitude that it has found."""
    (tmp_path / "bench.toml").write_bytes(recorded.with_suffix(".toml").read_bytes())
    recipe = tmp_path / "amplitude.toml"
    few = all_but("cubic_stiffness").replace(",", '", "')
    recipe.write_text(
        '[hits]\npeak_fraction = "1 %"\nweak_ratio = "0 %"\n'
        "[kalman]\nuse = false\n"
        f'[gap]\nmodel = "bench.toml"\nwithout = ["{few}"]\n'
    )
    stages = NoStore()
    done = process_session(read_session(recorded), "", read_recipe(recipe), stages)
    assert done.gap is not None, done.remarks
    assert done.gap["verdict"] == "none" and "gap" in stages.computed
    assert done.gap["curves"]["hits"] >= 4
    assert all("mode" in words for words in done.gap["curves"]["words"])
    nowhere = curves_at(done.modal, 1.0)
    assert not nowhere.modes and "no modes at 1 N" in nowhere.reason


def test_a_glancing_hit_among_levels_is_left_out_and_reported(
    recorded: Path, tmp_path: Path
) -> None:
    """Unjudged recordings, one of them a fiftieth of the softest level's force.

    The softest level, struck once, a seventh of the next, is meant and stays.
    """
    session = read_session(recorded)
    bare = [replace(recording, hits=()) for recording in session.recordings]
    softest = min(bare, key=lambda recording: recording.samples[0].max())
    glancing = replace(softest, name="glancing", samples=softest.samples / 50.0)
    unjudged = replace(session, recordings=(*bare, glancing))
    write_session(unjudged, tmp_path / "bare.h5")
    found = gap(
        tmp_path / "bare.h5",
        tmp_path / "g.json",
        model=recorded.with_suffix(".toml"),
        without=all_but("delay"),  # the hits are judged before any effect
    )
    reported = [words for words in found["remarks"] if "a glancing hit" in words]
    assert len(reported) == 1
    assert "recording 'glancing'" in reported[0]
    hits = [hit for recording in session.recordings for hit in recording.hits]
    assert all(hit.verdict is Verdict.OK for hit in hits)


def test_a_url_is_recorded_and_what_it_hides_is_named(tmp_path: Path) -> None:
    """A delay of the top's channel, from URL to name, among what resembles it."""
    url = f"{URL}&hide=delay&size=0.2"
    others = all_but("delay", "sensor_lowpass", "added_mass", "maxwell", "gain_error")
    page = tmp_path / "g.html"
    found = gap(url, tmp_path / "g.json", report=page, without=others)
    assert [effect["name"] for effect in found["effects"]] == ["delay"]
    truth = open_runs(url).truth
    assert truth is not None
    effects: Any = truth["effects"]
    tau = found["effects"][0]["parameters"]["tau"]["value"]
    assert tau == pytest.approx(effects["delay"]["tau"], rel=0.02)


def test_a_model_file_that_names_its_sessions_is_a_source(
    recorded: Path, tmp_path: Path
) -> None:
    """Paths are read from where the model lies; two sessions are one campaign."""
    session = read_session(recorded)
    for name, part in (("a", slice(None, 4)), ("b", slice(4, None))):
        half = replace(session, recordings=session.recordings[part])
        write_session(half, tmp_path / f"{name}.h5")
    text = recorded.with_suffix(".toml").read_text() + 'sessions = ["a.h5", "b.h5"]\n'
    (tmp_path / "bench.toml").write_text(text)
    few = all_but("cubic_stiffness", "delay", "loosening")
    found = gap(tmp_path / "bench.toml", tmp_path / "g.json", without=few)
    assert found["verdict"] == "none"


def test_a_preload_can_be_given_where_the_session_has_none(
    recorded: Path, tmp_path: Path
) -> None:
    """Without it The line names what to type; it never overrules the session."""
    session = read_session(recorded)
    bare = tuple(replace(r, preload=None) for r in session.recordings)
    path = tmp_path / "bare.h5"
    write_session(replace(session, recordings=bare), path)
    model = recorded.with_suffix(".toml")
    with pytest.raises(BadData, match="--preload"):
        gap(path, tmp_path / "g.json", model=model)
    with pytest.raises(UsageError, match="leave --preload out"):
        gap(recorded, tmp_path / "g.json", model=model, preload="1 kN")
    setup = JointSetup(preload=-1.0)
    write_session(replace(session, recordings=bare, joint=setup), path, overwrite=True)
    with pytest.raises(BadData, match="above zero"):
        gap(path, tmp_path / "g.json", model=model)


@pytest.mark.parametrize(
    ("wrong", "right", "words"),
    [
        ('channel = "a0"', 'channel = "a9"', "no channel 'a9'"),
        ('between = ["m1", "m2"]', 'between = ["m1", "lid"]', "lid"),
        ("joint = true", "joint = false", "joint = true"),
        ('points = ["2"]', 'points = ["1"]', "two bodies"),
        ('output = "acceleration"', 'output = "velocity"', "velocity"),
        ('output = "acceleration"', 'output = "jerk"', "jerk"),
        ("preload_reference", "preload_referenze", "preload_referenze"),
    ],
)
def test_a_mistake_in_the_model_is_one_line(
    recorded: Path, tmp_path: Path, wrong: str, right: str, words: str
) -> None:
    """What, value, rule, way out."""
    text = recorded.with_suffix(".toml").read_text()
    assert wrong in text
    model = tmp_path / "bench.toml"
    model.write_text(text.replace(wrong, right))
    with pytest.raises(BadData, match=words) as caught:
        gap(recorded, tmp_path / "g.json", model=model)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("key", ["mass_sd", "damping_sd", "stiffness"])
def test_a_value_without_its_spread_is_named(
    recorded: Path, tmp_path: Path, key: str
) -> None:
    """Identify does without; gap does not."""
    lines = recorded.with_suffix(".toml").read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith(f"{key} ="))
    model = tmp_path / "bench.toml"
    model.write_text("\n".join(lines[:first] + lines[first + 1 :]))
    with pytest.raises(BadData, match=f"{key} is missing"):
        nominal_parameters(read_toml(model, BenchModel))


def test_wrong_requests_are_usage_errors(
    recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Code 2: no model, a URL among files, a model for a campaign, no such specimen."""
    assert typed(monkeypatch, "gap", str(recorded)) == 2
    assert typed(monkeypatch, "gap", URL, str(recorded)) == 2
    assert typed(monkeypatch, "gap", "sim:three-body") == 2
    assert typed(monkeypatch, "gap", f"{URL}&hide=gremlin") == 2
    assert typed(monkeypatch, "gap", str(recorded.with_suffix(".toml"))) == 2
    assert typed(monkeypatch, "record", URL, "--out", str(recorded)) == 2
    text = tmp_path / "hits.csv"
    text.write_text("1,2\n")
    assert typed(monkeypatch, "gap", str(text)) == 2
    assert typed(monkeypatch, "gap", str(tmp_path / "gone.h5")) == 3


def test_hits_of_one_level_are_not_judged(tmp_path: Path) -> None:
    """A plain stream is a single run; the verdict states what it lacks."""
    path = tmp_path / "s.h5"
    record_session_file(
        "sim:two-body?seed=4&hits=4&level_scatter=0.02&double_rate=0&overload_rate=0",
        path,
    )
    session = read_session(path)
    assert session.joint is not None
    assert session.recordings[0].preload == session.joint.preload == 25e3
    model = tmp_path / "bench.toml"
    model.write_text(open_runs(URL).model or "")
    others = all_but("delay")  # are not asked for
    found = gap(path, tmp_path / "g.json", model=model, without=others)
    assert found["verdict"] == "unknown"
    assert "one level" in found["reason"]


def record_model(**changes: str) -> str:
    """Return a short model of a record of the Silverbox kind."""
    text = EXAMPLE.read_text(encoding="utf-8")
    for wrong, right in changes.items():
        assert wrong in text
        text = text.replace(wrong, right)
    return text


@pytest.mark.skipif(not SILVERBOX.exists(), reason="no Silverbox data beside this")
def test_the_cubic_spring_of_the_silverbox_is_found_on_unseen_samples(
    tmp_path: Path,
) -> None:
    """Two short realisations train; the rest of one is predicted ten times better."""
    text = EXAMPLE.read_text(encoding="utf-8")
    head, _, tail = text.partition("[record.training]")
    model = tmp_path / "short.toml"
    model.write_text(
        f"{head}[record.training]\nstarts = [40578, 75350]\nlength = 1600\n"
        '[[record.scored]]\nname = "later"\nstarts = [110122]\nlength = 4000\n'
    )
    assert "arrow" in tail
    kept = "iwan,bouc_wen,jenkins,coulomb,hum,maxwell,hidden_mode,saturation"
    found = gap(SILVERBOX, tmp_path / "g.json", model=model, without=kept)
    (score,) = found["scored"]
    assert score["unit"] == "V"
    assert 5e-3 < score["rms_before"] < 9e-3
    assert score["shrink"] > 0.9
    assert found["candidates"][0]["effects"][0] == "cubic_stiffness@link:joint"
    if found["effects"]:
        assert found["effects"][0]["parameters"]["k3"]["unit"] == "V/V^3"


@pytest.mark.parametrize(
    ("wrong", "right", "words"),
    [
        ('"5.5e-6 V s^2/V"', '"5.5e-6 kg"', "V s\\^2/V"),
        ('"610.35 Hz"', "610.35", "unit"),
        ('"610.35 Hz"', '"610.35 s"', "frequency"),
        ("starts = [100]", "starts = [41000]", "shares samples"),
        ('input = "V1"', 'input = "V2"', "both"),
        ("length = 8560\n\n[[", "length = 10\n\n[[", "512"),
    ],
)
def test_a_mistake_in_the_record_table_is_one_line(
    tmp_path: Path, wrong: str, right: str, words: str
) -> None:
    """Units, lengths, and samples that are both trained on and scored."""
    model = tmp_path / "record.toml"
    model.write_text(record_model(**{wrong: right}))
    with pytest.raises(BadData, match=words):
        read_toml(model, BenchModel)


def test_bad_records_leave_with_code_three(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """NaN, objects, unequal lengths, a record too short, no [record] table."""
    row = np.random.default_rng(1).standard_normal(3000)
    hole = np.where(np.arange(3000) == 5, np.nan, row)
    path = tmp_path / "r.mat"
    for v1, v2 in (
        (hole, row),
        (np.array([{"a": 1}], dtype=object), row),
        (row[1:], row),
        (row, row),
    ):
        scipy.io.savemat(path, {"V1": v1, "V2": v2})
        assert typed(monkeypatch, "gap", str(path), "--model", str(EXAMPLE)) == 3
    model = tmp_path / "bench.toml"
    model.write_text(open_runs(URL).model or "")
    assert typed(monkeypatch, "gap", str(path), "--model", str(model)) == 3
    assert typed(monkeypatch, "gap", str(path)) == 2
