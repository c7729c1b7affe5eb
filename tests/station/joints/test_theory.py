# SPDX-License-Identifier: MIT
"""Identified joints beside the contact law: rows, command line, page, refusals."""

import json
import math
from pathlib import Path

import pytest
from contact_cases import joint_case
from marble_block import PRINTED, marble_block
from numpy.testing import assert_allclose

from jointbench.analysis.contact.predict import predict_contact
from jointbench.analysis.contact.surface import ContactSurface
from jointbench.station.joints.contact_comparison import (
    against_theory,
    known_preloads,
    theory_json,
)
from jointbench.station.joints.structure_contact import TheoryTable
from jointbench.station.joints.theory_records import (
    IdentifiedState,
    JointQuantity,
    StateEstimate,
)
from jointbench.station.main import app
from jointbench.station.report.theory_section import theory_section
from jointbench.station.screen.exit_codes import EXIT_BAD_DATA, EXIT_USAGE, exit_code

MODEL = marble_block(PRINTED)
CONTACT = """
[contact]
modulus = "29.3 GPa"
hardness = "1.5 GPa"
hardness_sd = "10 %"
dimension = 1.54
roughness = "1 nm"
bolts = 4
diameter = "16 mm"
nut_factor_sd = 0.03
"""
PRELOADS = 'preloads = { measured = "25 kN" }\n'
TABLE = TheoryTable.model_validate(
    {
        "modulus": "29.3 GPa",
        "hardness": "1.5 GPa",
        "hardness_sd": "10 %",
        "bolts": 4,
        "diameter": "16 mm",
        "nut_factor_sd": 0.03,
    }
)
SURFACE = ContactSurface(1.54, 1e-9)


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """Run the command line and return its exit code."""
    monkeypatch.setattr("sys.argv", ["jointbench", "identify", *words])
    return exit_code(app, debug=False)


def state(
    preload: float, frequency: float | None = 200.0, measured_sd: float | None = None
) -> IdentifiedState:
    """Return a state with one stiffness and one damping."""
    values = {
        JointQuantity.NORMAL_STIFFNESS: StateEstimate(5e11, 4e11, 6e11),
        JointQuantity.NORMAL_DAMPING: StateEstimate(240.0, 220.0, 260.0),
    }
    clamped = TABLE.spread_preload(preload, measured_sd)
    return IdentifiedState("hits", clamped, frequency, values)


def test_the_command_lays_printed_frequencies_beside_three_models(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Three directions by three models, torque from the preload, plots in the page."""
    model, target = tmp_path / "model.toml", tmp_path / "joint.json"
    page = tmp_path / "joint.html"
    model.write_text(MODEL + CONTACT + PRELOADS, encoding="utf-8")
    words = ("--json", str(target), "--report", str(page))
    assert run(monkeypatch, str(model), *words) == 0
    rows = json.loads(target.read_text(encoding="utf-8"))["theory"]
    assert [row["quantity"] for row in rows] == list(JointQuantity)[:3]
    assert math.isclose(rows[0]["torque_n_m"], 20.0)
    assert list(rows[0]["predicted"]) == ["ke_2d", "ke_3d", "ke_3d_modified"]
    assert '"theory-normal_stiffness"' in page.read_text(encoding="utf-8")


def test_a_state_without_a_preload_is_asked_for_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The message names the state, and what to type where."""
    model = tmp_path / "model.toml"
    model.write_text(MODEL + CONTACT, encoding="utf-8")
    assert run(monkeypatch, str(model)) == EXIT_BAD_DATA
    assert 'preloads = { "measured" = "25 kN" }' in capsys.readouterr().err


def test_a_face_without_a_contact_table_is_a_usage_error(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Modulus and hardness cannot be guessed."""
    model = tmp_path / "model.toml"
    model.write_text(MODEL, encoding="utf-8")
    face = tmp_path / "a.csv"
    face.write_text("0,0\n", encoding="utf-8")
    assert run(monkeypatch, str(model), "--surface", str(face)) == EXIT_USAGE
    assert "[contact]" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ('joint = "nowhere"', "'nowhere'"),
        ('models = ["ke_4d"]', "ke_4d"),
        ("bolts = 0", "contact.bolts"),
    ],
)
def test_a_contact_table_that_makes_no_sense_is_refused_in_one_line(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    line: str,
    word: str,
) -> None:
    """Before anything is measured or meshed."""
    model = tmp_path / "model.toml"
    text = MODEL + CONTACT.replace("bolts = 4\n", "") + line
    model.write_text(text, encoding="utf-8")
    assert run(monkeypatch, str(model)) == EXIT_BAD_DATA
    error = capsys.readouterr().err
    assert word in error
    assert error.count("\n") == 1


def test_the_prediction_is_that_of_the_contact_law() -> None:
    """Value by value, and with an interval that holds it."""
    row = against_theory([state(25e3)], SURFACE, TABLE)[0]
    for name, found in row.predicted.items():
        dimension = 1.54 if name == "ke_2d" else 2.54
        wanted = predict_contact(
            joint_case(
                name,
                dimension=dimension,
                roughness=1e-9,
                material=TABLE.material,
                preload=25e3,
            )
        ).normal_stiffness
        assert found is not None
        assert found.low is not None
        assert found.high is not None
        assert_allclose(found.value, wanted, rtol=1e-12)
        assert found.low < found.value < found.high


def test_the_uncertainty_of_a_measured_preload_is_in_the_interval() -> None:
    """It takes the place of what the nut factor leaves open, here 15 %."""
    exact, washers, torque = (
        against_theory([state(25e3, None, sd)], SURFACE, TABLE)[0]
        for sd in (0.0, 500.0, None)
    )
    assert (washers.preload_sd, torque.preload_sd) == (500.0, 25e3 * 0.15)
    widths = []
    for row in (exact, washers, torque):
        found = row.predicted["ke_3d"]
        assert found is not None
        assert found.low is not None
        assert found.high is not None
        widths.append(found.high - found.low)
    assert widths[0] < widths[1] < widths[2]


def test_a_measured_preload_of_a_session_reaches_the_comparison() -> None:
    """With its uncertainty; one that the model states is by torque again."""
    stated = TABLE.model_copy(update={"preloads": {"b": 2e4}})
    found = known_preloads(stated, {"a": (1e4, 200.0), "b": (1e4, 200.0)})
    assert (found["a"].value, found["a"].sd) == (1e4, 200.0)
    assert (found["b"].value, found["b"].sd) == (2e4, 2e4 * 0.15)


def test_damping_is_the_loss_at_the_states_own_frequency() -> None:
    """C = eta K/omega: half the frequency, twice the damping; none without one."""
    once, half, never = (
        against_theory([state(25e3, frequency)], SURFACE, TABLE)[1].predicted["ke_3d"]
        for frequency in (200.0, 100.0, None)
    )
    assert once is not None
    assert half is not None
    assert_allclose(half.value, 2 * once.value, rtol=1e-12)
    assert never is None


def test_every_torque_has_its_own_prediction_and_ratio() -> None:
    """More torque, more stiffness; the ratio is predicted over identified."""
    states = [state(one) for one in (25e3, 62.5e3, 100e3)]
    rows = theory_json(against_theory(states, SURFACE, TABLE))[::2]
    assert_allclose([row["torque_n_m"] for row in rows], [20.0, 50.0, 80.0])
    values = [row["predicted"]["ke_2d"]["value"] for row in rows]  # type: ignore[index]
    assert values == sorted(values)
    first = rows[0]["predicted"]["ke_2d"]  # type: ignore[index]
    assert_allclose(first["ratio"], first["value"] / 5e11, rtol=1e-12)


@pytest.mark.parametrize(
    ("other", "wanted"),
    [
        (StateEstimate(3.0, 2.0, 4.0), True),
        (StateEstimate(6.0, 5.0, 7.0), False),
        (StateEstimate(3.0, None, 4.0), None),
    ],
)
def test_intervals_overlap_or_not_or_unknown(
    other: StateEstimate, wanted: bool | None
) -> None:
    """An open end decides nothing."""
    assert StateEstimate(2.5, 1.0, 3.0).overlaps(other) is wanted


def test_without_rows_there_is_no_section() -> None:
    """A structure without a contact law has no such section."""
    assert theory_section(()) is None
