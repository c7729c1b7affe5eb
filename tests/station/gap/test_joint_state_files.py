"""Joints over their preload from TOML, tables and identifications; the command."""

import json
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.station.gap.gap_inputs import GapRequest, examine
from jointbench.station.joint_states.joint_state_files import names_states, read_joint

HEAD = """
[joint]
bolts = 4
diameter = "16 mm"
area = "200 cm^2"

[bodies]
modulus = "55 GPa"
poisson = 0.25

[law]
family = "linear"
rms_height = "1 um"
"""
STATES = """
[[states]]
torque = "20 N m"
kn = "1.0e9 N/m"
cn = "400 N s/m"
correlation = { kn_cn = 0.4 }
[[states]]
torque = "40 N m"
branch = "falling"
assembly = 3
kn = "> 5e9 N/m"
[[states]]
preload = "25 kN"
identified = "joint.json"
parameters = { kn = "mount.stiffness", kt = "side.stiffness", ct = "side.damping" }
"""
EXAMPLE = Path(__file__).parents[3] / "examples" / "joint-stiffness.toml"


def _written(folder: Path, text: str) -> Path:
    path = folder / "joint.toml"
    path.write_text(text, encoding="utf-8")
    result = {
        "parameters": {
            "mount.stiffness": {
                "value": 2e9,
                "sd": 1e8,
                "interval_95": [1.8e9, 2.2e9],
                "identifiable": True,
            },
            "side.stiffness": {
                "value": 9e9,
                "sd": None,
                "interval_95": [4e9, None],
                "identifiable": False,
            },
            "side.damping": {"value": 1.0, "sd": None, "identifiable": False},
        }
    }
    (folder / "joint.json").write_text(json.dumps(result), encoding="utf-8")
    return path


def test_states_bounds_correlations_and_identifications_are_read(
    tmp_path: Path,
) -> None:
    """Values in SI, bounds as bounds, what is not known at all left out."""
    path = _written(tmp_path, HEAD + STATES)
    assert names_states(path)
    data, law = read_joint(path)
    rows = data.rows
    np.testing.assert_allclose(np.exp(rows.value), [1e9, 400.0, 5e9, 2e9, 4e9])
    assert rows.bound.tolist() == [False, False, True, False, True]
    assert rows.quantity.tolist() == [0, 4, 0, 0, 1]
    assert rows.covariance[0, 1] == pytest.approx(0.4 * 0.05 * 0.2)
    assert np.sqrt(rows.covariance[3, 3]) == pytest.approx(0.0512, abs=1e-3)
    assert data.states.assembly.tolist() == [0, 1, 0]
    assert data.states.by_torque.tolist() == [True, True, False]
    assert law.name == "linear"
    assert data.facts.area == pytest.approx(0.02)


def test_a_table_and_a_covariance_are_read(tmp_path: Path) -> None:
    """Columns are keys with units; an empty cell is not measured."""
    (tmp_path / "states.csv").write_text(
        "torque:N m,branch,assembly,kn:kN/mm,kn_sd:%\n"
        "20,rising,1,1000,3\n40,falling,2,,\n"
        "80,rising,2,> 3000,\n"
    )
    (tmp_path / "covariance.csv").write_text("0.01,0.002\n0.002,0.02\n")
    top = 'table = "states.csv"\ncovariance = "covariance.csv"\n'
    data, _ = read_joint(_written(tmp_path, top + HEAD))
    np.testing.assert_allclose(np.exp(data.rows.value), [1e9, 3e9])
    np.testing.assert_allclose(data.rows.covariance, [[0.01, 0.002], [0.002, 0.02]])
    assert data.rows.state.tolist() == [0, 2]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('kn = "1.0e9 N/m"', "kn = 1e9", "write the number with its unit"),
        ('"1.0e9 N/m"', '"1.0e9 N"', "not of stiffness"),
        ("kn_cn", "kn_kt", "correlation 'kn_kt' names values"),
        ('torque = "40 N m"', "", "needs its torque or its preload"),
        ("mount.stiffness", "mount.stifness", "it has mount.stiffness"),
        ('rms_height = "1 um"', "", "needs rms_height"),
        ('area = "200 cm^2"', 'area = "200 cm"', "no unit of area"),
    ],
)
def test_faults_of_a_file_are_one_line(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    """Key, value, rule and the way out."""
    path = _written(tmp_path, (HEAD + STATES).replace(old, new))
    with pytest.raises(BadData, match=words) as caught:
        read_joint(path)
    assert "\n" not in str(caught.value)


def test_the_example_is_named_through_the_command_s_reader() -> None:
    """A compliance in series, with pictures of every measured quantity."""
    done = examine([str(EXAMPLE)], GapRequest(), progress=lambda line: None)
    assert done.found.effects[0].name == "series_compliance"
    assert [s.anchor for s in done.sections] == ["joint", "held-out"]
    assert len(done.sections[0].items) == 4


def test_options_of_hits_do_not_apply_to_a_joint_file(tmp_path: Path) -> None:
    """It states its preloads itself; the message names what to leave out."""
    path = _written(tmp_path, HEAD + STATES)
    with pytest.raises(UsageError, match="leave --model and --preload out"):
        examine([str(path)], GapRequest(preload=1.0), progress=lambda line: None)
