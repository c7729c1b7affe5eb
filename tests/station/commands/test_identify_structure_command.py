"""``jointbench identify`` of meshed bodies, from the command line."""

import json
from pathlib import Path

import pytest
from marble_block import PRINTED, marble_block

from jointbench.station.main import app
from jointbench.station.screen.exit_codes import EXIT_BAD_DATA, EXIT_USAGE, exit_code
from jointbench.station.screen.joint_text import interval_text

BLOCKS = marble_block(PRINTED)


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """Run the command line and return its exit code."""
    monkeypatch.setattr("sys.argv", ["jointbench", *words])
    return exit_code(app, debug=False)


def test_printed_frequencies_give_joints_a_page_and_the_contracts_keys(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Parameters, solutions, full_check; shapes to turn in an offline page."""
    model = tmp_path / "block.toml"
    model.write_text(BLOCKS, encoding="utf-8")
    page, target = tmp_path / "joints.html", tmp_path / "joints.json"
    code = run(
        monkeypatch,
        "identify",
        str(model),
        "--report",
        str(page),
        "--json",
        str(target),
        "--cache",
        str(tmp_path / "cache"),
    )
    content = json.loads(target.read_text(encoding="utf-8"))
    assert code == 0
    assert content["full_check"][0]["agrees"]
    assert content["solutions"][0]["chi2"] < 1.0
    assert set(content["parameters"]["bed.normal_stiffness"]) >= {
        "value",
        "sd",
        "unit",
        "identifiable",
    }
    assert 'class="scene"' in page.read_text(encoding="utf-8")


def test_what_is_open_is_shown_as_the_range_of_all_admissible(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """One frequency for three directions: no sd on the screen, the page, in JSON."""
    model = tmp_path / "block.toml"
    text = BLOCKS.replace('["195 Hz", "480 Hz", "520 Hz"]', '["195 Hz"]')
    model.write_text(text, encoding="utf-8")
    page, target = tmp_path / "joints.html", tmp_path / "joints.json"
    run(
        monkeypatch,
        "identify",
        str(model),
        "--report",
        str(page),
        "--json",
        str(target),
    )
    screen, html = capsys.readouterr().out, page.read_text(encoding="utf-8")
    reported = json.loads(target.read_text(encoding="utf-8"))["parameters"]
    open_ones = {name: one for name, one in reported.items() if not one["identifiable"]}
    assert open_ones
    for name, one in open_ones.items():
        assert one["sd"] is None
        line = next(row for row in screen.splitlines() if row.startswith(f"{name} "))
        assert "±" not in line
        shown = interval_text((one["interval_95"][0], one["interval_95"][1]))
        assert shown in line
        assert shown in html


def test_a_joint_in_the_air_ends_with_bad_data(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Exit code 3 and one line that names the joint."""
    model = tmp_path / "block.toml"
    text = (
        BLOCKS + '\n[[joints.bed.patches]]\ncentre = ["9 m", "9 m"]\nradius = "1 mm"\n'
    )
    model.write_text(text, encoding="utf-8")
    assert run(monkeypatch, "identify", str(model)) == EXIT_BAD_DATA
    assert "'bed' touches nothing" in capsys.readouterr().err


def test_a_lumped_bench_without_a_session_is_a_usage_error(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Only structures may bring their frequencies in the model file."""
    model = tmp_path / "bench.toml"
    model.write_text("[bodies.m1]\nmass = '1 kg'\n", encoding="utf-8")
    assert run(monkeypatch, "identify", str(model)) == EXIT_USAGE


def test_directions_that_are_not_sought_need_a_known_stiffness(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """One line without it; with it, the one that is sought is found alone."""
    model, target = tmp_path / "block.toml", tmp_path / "joints.json"
    alone = BLOCKS + 'sought = ["bed.normal"]\n'
    model.write_text(alone, encoding="utf-8")
    assert run(monkeypatch, "identify", str(model)) == EXIT_BAD_DATA
    assert "'bed.tangential_2'] are neither sought nor known" in capsys.readouterr().err
    tangents = '"bed.tangential_1" = "102 MN/m", "bed.tangential_2" = "4.3 MN/m"'
    model.write_text(f"{alone}known = {{ {tangents} }}\n", encoding="utf-8")
    run(monkeypatch, "identify", str(model), "--json", str(target))
    reported = json.loads(target.read_text(encoding="utf-8"))["parameters"]
    assert set(reported) == {"bed.normal_stiffness"}
    model.write_text(f"{BLOCKS}known = {{ {tangents} }}\n", encoding="utf-8")
    assert run(monkeypatch, "identify", str(model)) == EXIT_BAD_DATA
    assert "left out of identify.sought" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('sought = ["bed.axial"]', "identify.sought: there is no 'bed.axial'"),
        ('shared = ["bad.normal"]', "identify.shared: there is no 'bad.normal'"),
        ('priors = { "bed.n" = ["1 GN/m", "20 %"] }', "identify.priors: there is no"),
        ('modulus_sd = { bed = "3 %" }', "write one of ['block']"),
        ('mass_sd = { a1 = "20 %" }', "identify.mass_sd: there is no 'a1'"),
        ("modes = 2", "3 modes of 'measured' were measured; leave identify.modes out"),
    ],
)
def test_a_wrong_request_is_said_before_the_reduction(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    line: str,
    said: str,
) -> None:
    """The message names the key and what may be written; nothing was reduced."""

    def reduced(*_: object, **__: object) -> None:
        raise AssertionError("the structure was reduced")

    where = "jointbench.station.joints.identify_run.reduce_structure"
    monkeypatch.setattr(where, reduced)
    model = tmp_path / "block.toml"
    text = BLOCKS.replace("modes = 6\n", "") + line + "\n"
    model.write_text(text, encoding="utf-8")
    assert run(monkeypatch, "identify", str(model)) == EXIT_BAD_DATA
    assert said in " ".join(capsys.readouterr().err.split())
