"""Joints over their preload from TOML, tables and identifications; the command."""

import json
import runpy
import shutil
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.station.examples.example_sets import write_example
from jointbench.station.gap.gap_inputs import examine
from jointbench.station.gap.gap_request import GapRequest
from jointbench.station.joint_states.joint_state_files import (
    names_states,
    read_joint,
)
from jointbench.station.joint_states.loop_files import read_loop

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
    joint = read_joint(path)
    data, law = joint.data, joint.law
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
    data = read_joint(_written(tmp_path, top + HEAD)).data
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


@pytest.fixture(scope="module")
def loops(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write the example of loops, and make its files."""
    folder = write_example("loops", tmp_path_factory.mktemp("example") / "loops")
    runpy.run_path(str(folder / "rough_loops.py"))["write_loops"](folder)
    return folder


def _with_loop(folder: Path, loops: Path, state: str) -> Path:
    """Return a joint file with one state beside those of `STATES`, and its loop."""
    shutil.copy(loops / "loop-02.csv", folder / "loop.csv")
    plain = STATES.replace(
        'cn = "400 N s/m"\n', 'cn = "400 N s/m"\nfrequency = "9 Hz"\n'
    )
    plain = plain.replace(', ct = "side.damping"', "")
    return _written(folder, f"{HEAD}{plain}\n[[states]]\n{state}\n")


def test_a_loop_is_stiffness_and_damping_of_one_setting(
    tmp_path: Path, loops: Path
) -> None:
    """kt, then ct by amplitude; their calibration is common to them."""
    state = 'torque = "9 N m"\nkn = "2e9 N/m"\nloop = "loop.csv"\nloop_sd = "2 %"\n'
    path = _with_loop(tmp_path, loops, state + 'frequency = "0.1 Hz"')
    joint = read_joint(path)
    data = joint.data
    rows, states = data.rows, data.states
    (loop,) = joint.loops
    own = rows.state >= 3
    assert rows.quantity[own].tolist() == [0, 1, 5, 5, 5]
    assert states.settings[rows.state[own]].tolist() == [3, 3, 3, 3, 3]
    found = loop.found
    assert np.exp(rows.value[own][1]) == pytest.approx(found.stiffness)
    level = found.levels[-1]
    assert np.exp(rows.value[own][-1]) == pytest.approx(level.damping(0.1))
    assert states.shear[-1] == pytest.approx(level.force)
    assert states.shear[rows.state[own][1]] < 1e-2 * level.force
    part = rows.covariance[np.ix_(own, own)]
    assert part[1, 0] == 0.0
    np.testing.assert_allclose(part[2:, 1], 0.02**2)
    expected = level.energy_sd**2 + 0.05**2 + 0.02**2
    assert part[-1, -1] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("state", "words"),
    [
        ('loop = "loop.csv"', "a loop needs the frequency of its cycles"),
        (
            'loop = "loop.csv"\nfrequency = "1 Hz"\nkt = "1e9 N/m"',
            "kt and ct of this state are those of its loop",
        ),
        ('loop = "lost.csv"\nfrequency = "1 Hz"', "lost.csv"),
    ],
)
def test_states_with_a_loop_that_cannot_be_used_are_one_line(
    tmp_path: Path, loops: Path, state: str, words: str
) -> None:
    """What is wrong, and what to write."""
    path = _with_loop(tmp_path, loops, f'torque = "9 N m"\n{state}')
    with pytest.raises(BadData, match=words) as caught:
        read_joint(path)
    assert "\n" not in str(caught.value)


def test_damping_beside_a_loop_needs_its_frequency(tmp_path: Path, loops: Path) -> None:
    """Slow cycles and vibrations damp by different coefficients."""
    state = 'torque = "9 N m"\nloop = "loop.csv"\nfrequency = "0.1 Hz"'
    path = _with_loop(tmp_path, loops, state)
    text = path.read_text(encoding="utf-8").replace('frequency = "9 Hz"', "")
    path.write_text(text, encoding="utf-8")
    with pytest.raises(BadData, match="state 1 has damping without its frequency"):
        read_joint(path)


@pytest.mark.parametrize(
    ("csv", "words"),
    [
        ("displacement,force:N\n1,2\n", "has no unit; write it as a displacement"),
        ("displacement:um,force:um\n1,2\n", "not of force"),
        ("place:um,force:N\n1,2\n", "0 columns 'displacement'"),
        ("displacement:um,force:N\n1;2\n", "1 cells below 2 columns"),
        ("displacement:um,force:N\n1,none\n", "'none' is no number"),
        ("displacement:um,force:N\n1,nan\n", "'nan' is no number"),
        ("displacement:um,force:N\n1,2\n", "the loop has 1 samples"),
        ("", "is empty"),
    ],
)
def test_faults_of_a_file_of_a_loop_are_one_line(
    tmp_path: Path, csv: str, words: str
) -> None:
    """File, row, value and the way out."""
    path = tmp_path / "loop.csv"
    path.write_text(csv, encoding="utf-8")
    with pytest.raises(BadData, match=words) as caught:
        read_loop(path)
    assert "\n" not in str(caught.value)
    assert "loop.csv" in str(caught.value)


def test_values_of_one_identification_have_its_correlation(tmp_path: Path) -> None:
    """Its covariance of the logarithms, scaled to the sd by the intervals."""
    path = _written(tmp_path, HEAD + STATES)
    result = json.loads((tmp_path / "joint.json").read_text(encoding="utf-8"))
    side = {"value": 9e9, "sd": 9e8, "interval_95": [7.4e9, 10.9e9]}
    result["parameters"]["side.stiffness"] = {**side, "identifiable": True}
    covariance = [[0.0025, -0.004, 0.0], [-0.004, 0.01, 0.0], [0.0, 0.0, 1.0]]
    result["log_covariance"] = covariance
    (tmp_path / "joint.json").write_text(json.dumps(result), encoding="utf-8")
    rows = read_joint(path).data.rows
    assert rows.quantity[-2:].tolist() == [0, 1]
    sd = np.sqrt(np.diag(rows.covariance))
    factor = rows.covariance[-2, -1] / (sd[-2] * sd[-1])
    assert factor == pytest.approx(-0.8)
    assert sd[-1] == pytest.approx(np.log(10.9 / 7.4) / (2 * 1.959964))
    result["log_covariance"] = covariance[:2]
    (tmp_path / "joint.json").write_text(json.dumps(result), encoding="utf-8")
    with pytest.raises(BadData, match="must have 3 rows and columns"):
        read_joint(path)


def test_the_example_of_loops_names_micro_slip_and_draws_its_loops(
    loops: Path,
) -> None:
    """Losses that grow with the force are those of friction."""
    path = str(loops / "joint-loops.toml")
    done = examine([path], GapRequest(), progress=lambda line: None)
    assert [e.name for e in done.found.effects] == ["microslip_damping"]
    assert [s.anchor for s in done.sections] == ["joint", "held-out", "loops"]
    assert len(done.remarks) == 4
    assert "tangential stiffness" in done.remarks[0]
