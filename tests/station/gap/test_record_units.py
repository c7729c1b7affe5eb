"""Records whose units stand in for newton and metre: no word of either is left."""

import json
import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import gap_outcomes as outcomes
import numpy as np
import pytest
import scipy.io
import scipy.signal
from numpy.testing import assert_array_equal

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.diagnosis.diagnose import conclude
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, Estimate, Gap
from jointbench.analysis.gap.model.evidence_records import GapEvidence
from jointbench.station.files.toml_file import read_toml
from jointbench.station.gap.record_campaign import RecordToExamine, read_record
from jointbench.station.gap.run_gap import run_gap
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.record_units import StandIns

RATE = 1000.0
DELAY = ("delay", "channel:a1")
WRITTEN = {
    "displacement": ("V s^2/V", "V/V", "V s/V"),
    "velocity": ("V s/V", "V/(V s)", "V/V"),
    "acceleration": ("V/V", "V/(V s^2)", "V/(V s)"),
}
"""Mass, stiffness and damping of a record in volts, by what its output measures."""
ORDERS = tuple(WRITTEN)
SENSED = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s^2"}
NEWTON_OR_METRE = re.compile(r"\d N\b|\[N|\[m\b|m/N|\bkg\b")


def model_text(output: str | None, units: tuple[str, str, str]) -> str:
    """Return a model of an oscillator of 80 Hz whose input and output are voltages."""
    mass, stiffness, damping = units
    wanted = "" if output is None else f'output = "{output}"\n'
    return f"""
[bodies.body]
mass = "4e-6 {mass}"
mass_sd = "4e-7 {mass}"
channel = "y"
[links.joint]
between = ["ground", "body"]
stiffness = "1 {stiffness}"
stiffness_sd = "0.1 {stiffness}"
damping = "2e-4 {damping}"
damping_sd = "2e-5 {damping}"
joint = true
[gap]
{wanted}repeatability = "0.3 %"
[record]
input = "V1"
input_unit = "V"
output = "V2"
output_unit = "V"
sample_rate = "{RATE} Hz"
lead = 256
[record.training]
starts = [300, 1200]
length = 700
"""


def oscillator(path: Path) -> Path:
    """Write the acceleration of that oscillator under noise of two levels."""
    rng = np.random.default_rng(5)
    n, inside = 2000, 20
    coarse = rng.standard_normal(n) * np.where(np.arange(n) < 1000, 1.0, 3.0)
    force = scipy.signal.resample(coarse, inside * n)
    system = scipy.signal.lti([1, 0, 0], [4e-6, 2e-4, 1.0])
    time = np.arange(inside * n) / (inside * RATE)
    _, response, _ = scipy.signal.lsim(system, force, time)
    measured = response[::inside]
    measured += 1e-3 * measured.std() * rng.standard_normal(n)
    scipy.io.savemat(path, {"V1": force[::inside], "V2": measured})
    return path


def record_of(folder: Path, output: str | None) -> RecordToExamine:
    """Return the record as a model in that output's units describes it."""
    row = np.random.default_rng(1).standard_normal(2000)
    scipy.io.savemat(folder / "r.mat", {"V1": row, "V2": row})
    model = folder / "bench.toml"
    model.write_text(model_text(output, WRITTEN[output or "acceleration"]))
    return read_record(folder / "r.mat", read_toml(model, BenchModel))


@cache
def found() -> Diagnosis:
    """Return a diagnosis in newton and metre, with two levels and a delay."""
    hidden: outcomes.Hidden = (*DELAY, [4e-5])
    outcome, bench = outcomes.outcome_of([hidden], DELAY)
    return conclude(outcome, bench)


def evidence_of_diagnosis(diagnosis: Diagnosis) -> GapEvidence:
    """Return the evidence, which all of these have."""
    assert diagnosis.evidence is not None
    return diagnosis.evidence


def as_if(output: str) -> Diagnosis:
    """Return the diagnosis with the units the engine gives outputs of that kind."""
    evidence, unit = evidence_of_diagnosis(found()), SENSED[output]
    return replace(
        found(),
        evidence=replace(
            evidence,
            curves=replace(evidence.curves, unit=unit),
            spectra=replace(evidence.spectra, unit=f"{unit}/N"),
        ),
    )


@pytest.mark.parametrize("output", [*ORDERS, None])
def test_base_units_are_printed_as_the_user_wrote_them(
    tmp_path: Path, output: str | None
) -> None:
    """Mass, stiffness and damping; left out, the output is an acceleration."""
    record = record_of(tmp_path, output)
    printed = record.in_stand_ins(found())
    mass, stiffness, damping = WRITTEN[output or "acceleration"]
    units = {one.name: one.unit for one in printed.base}
    assert {units[name] for name in units if name.startswith("m")} == {mass}
    assert {units[name] for name in units if name.startswith("k")} == {stiffness}
    assert {units[name] for name in units if name.startswith("c")} == {damping}


@pytest.mark.parametrize("output", ORDERS)
@pytest.mark.parametrize("sink", ["V", "mm/s"])
def test_what_a_record_prints_its_model_accepts(
    tmp_path: Path, output: str, sink: str
) -> None:
    """Also where the output's unit is a quotient itself; another order is refused."""
    units = StandIns("V", sink, ORDERS.index(output))
    printed = units.unit("kg"), units.unit("N/m"), units.unit("N s/m")
    model = tmp_path / "bench.toml"
    text = model_text(output, printed)
    model.write_text(text.replace('output_unit = "V"', f'output_unit = "{sink}"'))
    assert read_toml(model, BenchModel).bodies["body"].mass == 4e-6
    other = ORDERS[ORDERS.index(output) - 1]
    model.write_text(model_text(other, printed))
    with pytest.raises(BadData, match="the record's units make it"):
        read_toml(model, BenchModel)


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("N", ("V", "V", "V")),
        ("m", ("V", "V s", "V s^2")),
        ("N/m^3", ("V/V^3", "V/(V^3 s^3)", "V/(V^3 s^6)")),
        ("N/m²", ("V/V^2", "V/(V^2 s^2)", "V/(V^2 s^4)")),
        ("N s^2/m^2", ("V s^2/V^2", "V/V^2", "V/(V^2 s^2)")),
        ("N/m^1.5", ("V/V^1.5", "V/(V^1.5 s^1.5)", "V/(V^1.5 s^3)")),
        ("N/(m/s)", ("V s/V", "V/V", "V/(V s)")),
        ("N/(m K)", ("V/(V K)", "V/(V K s)", "V/(V K s^2)")),
        ("1/N", ("1/V", "1/V", "1/V")),
        ("Hz", ("Hz", "Hz", "Hz")),
        ("-", ("-", "-", "-")),
        ("unit of the channel", ("unit of the channel",) * 3),
    ],
)
def test_a_metre_is_the_unit_of_the_output_times_s_to_its_order(
    unit: str, expected: tuple[str, str, str]
) -> None:
    """Units of the catalogue and of a user's effects, for each order."""
    assert tuple(StandIns("V", "V", order).unit(unit) for order in range(3)) == expected


def test_effects_are_in_the_stand_ins(tmp_path: Path) -> None:
    """A cubic spring on an accelerometer's voltage is per cube of V s^2."""
    (effect,) = found().effects
    cubic = replace(effect, parameters=(Estimate("k3", 4.0, 0.1, "N/m^3"),))
    record = record_of(tmp_path, "acceleration")
    (printed,) = record.in_stand_ins(replace(found(), effects=(cubic,))).effects
    assert printed.parameters == (Estimate("k3", 4.0, 0.1, "V/(V^3 s^6)"),)


@pytest.mark.parametrize("output", ORDERS)
def test_curves_and_spectra_are_in_the_stand_ins(tmp_path: Path, output: str) -> None:
    """Volts and volts over volts, whatever the output measures; values stay."""
    given = as_if(output)
    evidence = evidence_of_diagnosis(record_of(tmp_path, output).in_stand_ins(given))
    assert (evidence.curves.unit, evidence.spectra.unit) == ("V", "V/V")
    before = evidence_of_diagnosis(given)
    assert_array_equal(evidence.curves.measured, before.curves.measured)
    assert_array_equal(evidence.spectra.after, before.spectra.after)


def test_no_label_or_sentence_is_left_in_newtons(tmp_path: Path) -> None:
    """Conditions, slices of the views before and after, sentences, the reason."""

    def slices(gap: Gap) -> list[str]:
        return [label for view in gap.views for label in view.share]

    where = "the residual grows with level (59 % of it at 30 N)"
    evidence = replace(
        evidence_of_diagnosis(found()), where=where, look=("12 % at 3.5 N, more",)
    )
    given = replace(found(), evidence=evidence, reason="left by level 30 N")
    printed = record_of(tmp_path, "displacement").in_stand_ins(given)
    shown = evidence_of_diagnosis(printed)
    assert any(label.endswith(" N") for label in slices(given.gap_before))
    texts = [
        *slices(printed.gap_before),
        *slices(printed.gap_after),
        *(label for view in shown.relative.values() for label in view),
        shown.curves.condition,
        shown.spectra.condition,
    ]
    assert not [text for text in texts if NEWTON_OR_METRE.search(text)]
    assert shown.where == "the residual grows with level (59 % of it at 30 V)"
    assert shown.look == ("12 % at 3.5 V, more",)
    assert printed.reason == "left by level 30 V"
    loaded = [view for view in given.gap_before.views if view.name != "preload"]
    pairs = zip(loaded, printed.gap_before.views, strict=True)
    for before, after in pairs:
        assert list(after.share.values()) == list(before.share.values())
        assert list(after.chi2_per_dof) == list(after.share)


def test_a_record_in_newtons_is_left_alone(tmp_path: Path) -> None:
    """Where the input is a force nothing stands in."""
    record = record_of(tmp_path, "displacement")
    assert record.stand_ins == StandIns("V", "V", 0)
    assert replace(record, stand_ins=None).in_stand_ins(found()) is found()


def test_a_record_of_an_accelerometer_in_volts_goes_from_file_to_page(
    tmp_path: Path,
) -> None:
    """The base is found where it was hidden, in the units that the model wrote."""
    model = tmp_path / "bench.toml"
    model.write_text(model_text(None, WRITTEN["acceleration"]))
    kept = {"added_mass", "gain_error"}
    names = {entry.effect.name for entry in CATALOGUE}
    page, target = tmp_path / "g.html", tmp_path / "g.json"
    run_gap(
        oscillator(tmp_path / "r.mat"),
        model=model,
        without=",".join(names - kept),
        report=page,
        json_target=str(target),
    )
    content: dict[str, Any] = json.loads(target.read_text())
    base = content["base"]
    assert [base[name]["unit"] for name in base] == list(WRITTEN["acceleration"])
    values = [base[name]["value"] for name in base]
    assert values == pytest.approx([4e-6, 1.0, 2e-4], rel=0.02)
    assert not NEWTON_OR_METRE.search(target.read_text())
    titles = re.findall(r">([^<>]+)<", page.read_text())
    assert "y [V]" in titles
    assert "y over force [V/V]" in titles
