"""The comparison from files: the command, the library, the report."""

import json
from pathlib import Path

import pytest
from marble_block import block_frequencies, block_recording, marble_block

import jointbench as jb
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import write_session
from jointbench.station.main import app
from jointbench.station.screen.exit_codes import exit_code

STIFFNESS = 3.2e6
TABLES = """
[sensors.a1]
body = "block"
position = ["200 mm", "100 mm", "50 mm"]
direction = [0, 0, 1]

[hits.1]
body = "block"
position = ["200 mm", "100 mm", "50 mm"]
direction = [0, 0, 1]

[identify]
data = "frequencies"
modes = 6
band = ["60 Hz", "500 Hz"]
frequency_sd = "0.5 %"
sought = ["bed.normal"]
known = { "bed.tangential_1" = "1 GN/m", "bed.tangential_2" = "1 GN/m" }
stiffness_box = ["1 MN/m", "1 GN/m"]
"""


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path, Path]:
    """A model, its joint as identified 2 % too stiff, and a simulated session."""
    model, values = tmp_path / "block.toml", tmp_path / "joint.json"
    session = tmp_path / "block.h5"
    model.write_text(marble_block(TABLES), encoding="utf-8")
    row = block_recording(0, STIFFNESS, 2e3)
    write_session(
        Session("1", "2026-01-01T00:00:00Z", "test", True, recordings=(row,)), session
    )
    one = {"value": 1.02 * STIFFNESS, "sd": 1e4, "unit": "N/m", "identifiable": True}
    one["interval_95"] = [0.99 * STIFFNESS, 1.05 * STIFFNESS]
    content = {"parameters": {"bed.normal_stiffness": one}}
    values.write_text(json.dumps(content), encoding="utf-8")
    return model, values, session


def test_command_and_library_compare_the_same_and_say_what_was_simulated(
    files: tuple[Path, Path, Path], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Three pairs, 1 % too high each, in JSON, report and script alike."""
    page, target = tmp_path / "agreement.html", tmp_path / "agreement.json"
    words = [*map(str, files), "--report", str(page), "--json", str(target)]
    monkeypatch.setattr("sys.argv", ["jointbench", "agreement", *words])
    assert exit_code(app, debug=False) == 0
    assert "Simulated instruments" in page.read_text(encoding="utf-8")
    model, values, session = files
    found = jb.agreement(model, values, session)
    assert found.to_dict() == json.loads(target.read_text(encoding="utf-8"))
    assert found.suspects == ()
    (one,) = found.states.values()
    assert one.measured.frequency == pytest.approx(
        block_frequencies(STIFFNESS), rel=0.002
    )
    assert [pair.frequency for pair in one.pairs] == pytest.approx([0.01] * 3, abs=4e-3)
    assert "block" in str(found)
    report = found.write_report(tmp_path / "again.html").read_text(encoding="utf-8")
    assert "Simulated instruments" in report


def test_joints_that_were_just_identified_are_compared_without_a_file(
    files: tuple[Path, Path, Path],
) -> None:
    """What `identify` returns goes in; its plain data are those of its JSON."""
    model, _, session = files
    joints = jb.identify(model, session)
    assert "bed.normal_stiffness" in joints.to_dict()["parameters"]
    (one,) = jb.agreement(model, joints, session).states.values()
    assert [pair.frequency for pair in one.pairs] == pytest.approx([0.0] * 3, abs=4e-3)
    with pytest.raises(UsageError, match="no file is given"):
        jb.agreement(model, joints, [])
