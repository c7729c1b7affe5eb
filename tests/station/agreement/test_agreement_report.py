"""The comparison of a measured structure with its model, as a user reads it."""

import json
from pathlib import Path

import numpy as np
import pytest

from jointbench.analysis.structures.agreement.compare_structure import Agreement
from jointbench.analysis.structures.agreement.paired_modes import (
    ModeSet,
    pair_mode_sets,
)
from jointbench.analysis.structures.agreement.suspect_coordinates import Suspect
from jointbench.signal.frf.frf import FrfKind
from jointbench.station.agreement.agreement_json import agreement_json
from jointbench.station.agreement.agreement_report import write_agreement_report
from jointbench.station.agreement.agreement_text import pair_rows, sentences
from jointbench.station.main import app
from jointbench.station.screen.exit_codes import EXIT_USAGE, exit_code


def agreement() -> Agreement:
    """Two of three measured modes have a partner; one sign is suspected."""
    value, shapes = np.array([100.0, 200.0, 300.0]), np.eye(3)
    none = np.zeros((3, 3, 1))
    sd = 1e-3 * value
    damping, damping_sd = np.full(3, 0.01), np.full(3, 1e-4)
    measured = ModeSet(value, sd, damping, damping_sd, shapes + 0j, none, none)
    computed = ModeSet(
        np.array([101.0, 199.0]),
        np.zeros(2),
        damping[:2],
        damping_sd[:2],
        shapes[:2] + 0j,
        none[:2],
        none[:2],
    )
    pairs, likeness = pair_mode_sets(measured, computed)
    response = np.ones((3, 1, 5), complex)
    suspect = Suspect(
        "output a2 has the wrong sign", "sign", ("a2",), 0.9, 0.1, ("hit 1 ...",)
    )
    return Agreement(
        measured,
        computed,
        pairs,
        likeness,
        np.ones(3),
        np.zeros(3),
        np.linspace(50.0, 350.0, 5),
        response,
        response,
        np.ones((3, 1)),
        (suspect,),
        ("a1", "a2", "a3"),
        ("1",),
        FrfKind.MOBILITY,
    )


def test_differences_have_intervals_and_what_is_missing_is_said() -> None:
    """1 % with 0.2 %; the third mode; the suspect with its equals."""
    found = agreement()
    assert pair_rows(found)[0][2] == "+1.000 ± 0.2"
    lines = sentences(found)
    assert lines[0] == "Measured modes without a computed partner: 300 Hz."
    assert "falls from 90 to 10 % of their size. As good: hit 1 ..." in lines[1]


def test_report_and_json_hold_the_same(tmp_path: Path) -> None:
    """MAC with values, the suspect as a notice; JSON without NaN."""
    page = tmp_path / "agreement.html"
    write_agreement_report(page, "plates.toml", {"day": agreement()})
    text = page.read_text(encoding="utf-8")
    assert "output a2 has the wrong sign" in text
    assert "MAC of measured and computed modes" in text
    assert "mobility [m/(N s)]" in text
    content = json.loads(json.dumps(agreement_json(agreement()), allow_nan=False))
    assert content["measured_without_partner_hz"] == [300.0]
    assert content["suspects"][0]["names"] == ["a2"]


def test_a_comparison_without_a_session_is_a_usage_error(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line names what to add."""
    monkeypatch.setattr("sys.argv", ["jointbench", "agreement", "m.toml", "j.json"])
    assert exit_code(app, debug=False) == EXIT_USAGE
    assert "no session to compare with" in capsys.readouterr().err
