# SPDX-License-Identifier: MIT
"""``jointbench contact`` from the outside: options, JSON, page, refusals."""

import json
import math

import pytest

from jointbench.station.main import app, exit_code

JOINT = [
    "contact",
    "--dimension=1.54",
    "--roughness=1e-9 m",
    "--modulus=29.3 GPa",
    "--hardness=1.5 GPa",
]


def run(monkeypatch, *options):
    """Run the command line and return its exit code."""
    monkeypatch.setattr("sys.argv", ["jointbench", *JOINT, *options])
    return exit_code(app, debug=False)


def result(monkeypatch, tmp_path, *options):
    """Run the command line and return its JSON."""
    target = tmp_path / "contact.json"
    assert run(monkeypatch, *options, f"--json={target}") == 0
    return json.loads(target.read_text(encoding="utf-8"))


def test_the_contract_keys_are_there(monkeypatch, tmp_path):
    """Names that programs rely on."""
    found = result(monkeypatch, tmp_path, "--load=1 kN")["models"][0]
    wanted = {"name", "mode", "normal_stiffness", "tangential_stiffness", "damping"}
    assert wanted | {"largest_area", "real_area"} <= set(found)
    assert found["mode"] == "corrected"
    assert found["damping"] is None


def test_a_critical_area_beyond_every_double_is_null_and_named_by_its_power(
    monkeypatch, tmp_path
):
    """JSON has no infinity; the reason gives the order of magnitude."""
    found = result(monkeypatch, tmp_path, "--load=4 kN", "--dimension=1.002")
    for model in found["models"]:
        assert model["normal_stiffness"] == 0.0
        assert model["verdict"] == "fully plastic"
        assert model["usable"] is False
        assert model["critical_area"] is None
        assert any("critical area, 10^" in reason for reason in model["reasons"])


def test_as_printed_is_another_number_and_says_why(monkeypatch, tmp_path):
    """Each fault by name, with its size."""
    options = ("--load=1 kN", "--model=modified_2d")
    mended = result(monkeypatch, tmp_path, *options)["models"][0]
    printed = result(monkeypatch, tmp_path, *options, "--mode=as-printed")["models"][0]
    assert printed["mode"] == "as-printed"
    assert printed["normal_stiffness"] > 2 * mended["normal_stiffness"]
    assert any("eq. (33)" in reason for reason in printed["reasons"])


def test_torque_and_nut_factor_make_a_preload_that_is_not_sure(monkeypatch, tmp_path):
    """Four M16 bolts at 20 N m carry 25 kN; lbf ft are taken as well."""
    options = ("--bolt-diameter=16 mm", "--bolts=4", "--nut-factor-sd=0.03")
    metric = result(monkeypatch, tmp_path, "--torque=20 N m", *options)["models"][0]
    assert math.isclose(metric["preload"], 25e3)
    low, high = metric["normal_stiffness_interval"]
    assert low < metric["normal_stiffness"] < high
    assert metric["dominant_input"] == "preload"
    foreign = result(monkeypatch, tmp_path, "--torque=20 lbf ft", *options)
    assert math.isclose(foreign["models"][0]["preload"], 25e3 * 1.3558179483)


def test_mass_and_convention_give_a_damping(monkeypatch, tmp_path):
    """The two conventions of the loss factor are about 2 pi apart."""
    options = ("--load=1 kN", "--mass=19.5 kg")
    ratio = result(monkeypatch, tmp_path, *options)["models"][0]
    other = result(monkeypatch, tmp_path, *options, "--loss-convention=per-radian")
    stored = ratio["damping"] / other["models"][0]["damping"] / (2 * math.pi)
    assert math.isclose(stored, 1 + ratio["loss_factor"], rel_tol=1e-9)


def test_a_sweep_is_tabulated_and_drawn(monkeypatch, tmp_path):
    """Values that the model refuses keep their place."""
    page = tmp_path / "sweep.html"
    options = ("--load=1 kN", "--sweep=dimension:1.5:2:3", f"--plot={page}")
    rows = result(monkeypatch, tmp_path, *options)["sweep"]["rows"]
    assert [row["value"] for row in rows] == [1.5, 1.75, 2.0]
    assert rows[2]["refused"].startswith("fractal dimension")
    assert rows[1]["models"][0]["normal_stiffness"] > 0
    assert "stiffness-sweep" in page.read_text(encoding="utf-8")


def test_the_preload_for_a_stiffness_or_a_real_area_is_found(monkeypatch, tmp_path):
    """The way back, by each model."""
    there = result(monkeypatch, tmp_path, "--load=1 kN")["models"][0]
    for option in (
        f"--stiffness={there['normal_stiffness']!r} N/m",
        f"--real-area={there['real_area']!r}",
    ):
        back = result(monkeypatch, tmp_path, option)["models"][0]
        assert math.isclose(back["preload"], 1e3, rel_tol=1e-9)


def test_a_term_can_be_left_out(monkeypatch, tmp_path):
    """Interaction stiffens at equal load, so without it there is less."""
    options = ("--load=1 kN", "--model=ke_3d_modified")
    whole = result(monkeypatch, tmp_path, *options)["models"][0]
    less = result(monkeypatch, tmp_path, *options, "--without=interaction")["models"][0]
    assert less["normal_stiffness"] < whole["normal_stiffness"]


def test_brinell_numbers_need_their_name(monkeypatch, tmp_path, capsys):
    """231 HB is 2.265 GPa; 231 is nothing."""
    named = result(monkeypatch, tmp_path, "--load=1 kN", "--hardness=231 HB")
    plain = result(monkeypatch, tmp_path, "--load=1 kN", "--hardness=2265.33615 MPa")
    key = "normal_stiffness"
    assert math.isclose(named["models"][0][key], plain["models"][0][key])
    assert run(monkeypatch, "--load=1 kN", "--hardness=231") == 3
    assert "231 HB" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (["--load=1 kN", "--dimension=2"], 3, "dimension 2 is neither"),
        (["--load=1 kN", "--roughness=0 m"], 3, "roughness"),
        (["--load=1 kN", "--roughness=-1 nm"], 3, "roughness"),
        (["--load=0 N"], 3, "preload is 0"),
        (["--load=1"], 3, "no unit"),
        ([], 2, "--load and --torque"),
        (["--stiffness=1 N/m", "--real-area=1"], 2, "one of"),
        (["--stiffness=0 N/m"], 3, "stiffness"),
        (["--stiffness=1e9 N/m", "--dimension=2.5", "--roughness=2 m"], 3, "roughness"),
        (["--torque=20 N m"], 2, "--bolt-diameter"),
        (["--load=1 kN", "--mode=printed"], 2, "as-printed"),
        (["--load=1 kN", "--without=love"], 2, "interaction"),
        (["--load=1 kN", "--sweep=torque:1:2"], 2, "NAME:FROM:TO"),
        (["--load=1 kN", "--mass=19.5 kg", "--frequency=9 Hz"], 3, "one of them"),
        (["--load=1 kN", "--tangential-load=-1 N"], 3, "tangential"),
    ],
)
def test_bad_input_is_refused_in_one_line(monkeypatch, capsys, options, code, words):
    """What, value, rule, way out."""
    assert run(monkeypatch, *options) == code
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
