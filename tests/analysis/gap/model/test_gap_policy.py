"""Settings of the gap engine: documented, in force, shown, and open to variation."""

import ast
import importlib.util
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path
from types import ModuleType

import pytest

from jointbench.analysis.gap.catalogue.linear_effects import LINEAR
from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Finding,
    diagnosis_json,
)
from jointbench.analysis.gap.model.policy import (
    STANDARD,
    Policy,
    policy_digest,
    policy_json,
)
from jointbench.analysis.gap.model.setting import SettingKind, settings_of

ROOT = Path(__file__).parents[4]
BENCHMARKS = ROOT / "benchmarks" / "gap"
NO_SETTINGS = {
    "POLYNOMIAL": "kind of a law in the compiled loop",
    "ONE_SIDED": "the same",
    "SLIDERS": "the same",
    "COULOMB": "the same",
    "QUADRATIC_DAMPING": "the same",
    "CURVES": "the same",
    "TWO_SIDED": "the same",
    "FIFTH_POWER": "the same",
    "POWER_DAMPING": "the same",
    "VERSIONS": "versions of the compiled loop",
    "PARAMETERS": "layout of packed laws",
    "SLIDER_ROWS": "the same",
    "CURVE_ROWS": "the same",
    "FLOOR": "guard against a division by zero",
    "_LEAST": "guard against the logarithm of zero",
    "ENDLESS": "mark of a surface without roll-off",
    "_REAL": "guard against an imaginary part that is rounding",
    "_FOURTH": "cumulant of second differences, exact",
    "_THIRD": "the same",
    "_FORMS": "degrees of the polynomials of a form",
    "_LEGENDRE": "the same",
    "_STALE": "mark of a coordinate that is not known",
    "BODIES": "the schema of campaign files",
    "NORMAL": "index of the direction along a bolt",
    "COLUMNS": "layout of the force columns of a hit point",
    "DIRECTIONS_OF_A_HIT": "the same",
    "EXACT": "model error, beside the laws it belongs to",
    "_TRIED_PRELOADS": "trial input of the check of an installed effect",
    "_TRIED_PROGRESS": "the same",
    "_TRIED_SAMPLES": "the same",
    "_TRIED_RATE": "the same",
    "_TRIED_LINES": "the same",
    "_TRIED_DAMPING": "the same",
}
"""Numbers at the top of a module that are no settings, and what they are."""


def load_sweep() -> ModuleType:
    """Load the benchmark with the modules beside it."""
    with pytest.MonkeyPatch.context() as path:
        path.syspath_prepend(BENCHMARKS)
        spec = importlib.util.spec_from_file_location(
            "policy_sweep", BENCHMARKS / "policy_sweep.py"
        )
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    return module


sweep = load_sweep()


@pytest.mark.parametrize("record", [STANDARD, *sweep.PARTS.values()], ids=repr)
def test_every_setting_has_unit_purpose_and_basis(record: object) -> None:
    """Every number is documented, and of the kind of its record."""
    settings = settings_of(record)
    assert len(settings) == len(fields(record))  # type: ignore[arg-type]
    for one in settings:
        assert one.unit
        assert len(one.purpose) > 20, one.name
        assert len(one.basis) > 5, one.name
        decides = one.kind is SettingKind.DECISION
        assert decides == isinstance(record, Policy), one.name


def bare_numbers() -> Iterator[str]:
    """Return the names of numbers that stand at the top of a module of the engine."""
    for path in sorted((ROOT / "analysis" / "gap").rglob("*.py")):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if not isinstance(node, ast.Assign):
                continue
            try:
                value = ast.literal_eval(node.value)
            except ValueError:
                continue
            if any(isinstance(x, int | float) for x in _flat(value)):
                yield from (t.id for t in node.targets if isinstance(t, ast.Name))


def _flat(value: object) -> Iterator[object]:
    if isinstance(value, tuple):
        for one in value:
            yield from _flat(one)
    else:
        yield value


def test_no_number_stands_in_a_module_but_as_a_setting() -> None:
    """A new constant of the engine is a field with its four facts."""
    assert not set(bare_numbers()) - NO_SETTINGS.keys()


def test_the_digest_of_a_policy_changes_with_every_setting() -> None:
    """Two policies with one digest are the same policy."""
    digests = {policy_digest(STANDARD), policy_digest(Policy())}
    assert len(digests) == 1
    for one in settings_of(STANDARD):
        digests.add(policy_digest(sweep.varied(one.name, 1.3)))
        digests.add(policy_digest(sweep.varied(one.name, 0.7)))
    assert len(digests) == 1 + 2 * len(fields(STANDARD))


def test_a_varied_policy_decides_the_verdict_and_is_reported_with_it(
    late_campaign: Campaign, late: Diagnosis
) -> None:
    """A delay is named; where no base parameter may move by 0.01 sd, nothing is."""
    assert late.verdict is Finding.NAMED
    assert diagnosis_json(late)["policy"] == policy_json(STANDARD)
    strict = replace(STANDARD, prior_limit=0.01)
    refused = diagnose(late_campaign, entries=LINEAR, policy=strict)
    assert refused.verdict is Finding.UNKNOWN
    assert "from its nominal value" in refused.reason
    stated = diagnosis_json(refused)["policy"]
    assert stated["settings"]["prior_limit"] == {"value": 0.01, "unit": "sd"}
    assert stated["digest"] != policy_digest(STANDARD)


def test_the_page_holds_every_setting_as_it_is_in_force() -> None:
    """Value, unit, purpose, basis and effect on the page are those of the code."""
    page = (ROOT / "docs" / "gap-policy.md").read_text(encoding="utf-8")
    assert policy_digest(STANDARD)[:16] in page
    for record in (STANDARD, *sweep.PARTS.values()):
        for one in settings_of(record):
            cells = [one.name, f"{one.value}", one.unit, one.purpose, one.basis]
            if one.kind is SettingKind.DECISION:
                cells.append(one.effect)
                assert one.effect
            assert f"| {' | '.join(cells)} |" in page, one.name


@pytest.mark.heavy(reason="four diagnoses, three of them under other policies")
def test_a_small_sweep_finds_the_verdict_that_a_rival_decides(tmp_path: Path) -> None:
    """Of two explanations 10.5 to 15 apart, one remains with less.

    What is in the file is not run again. A null under each setting: docs/gap-policy.md.
    """
    campaigns, runs = [("null", 121000), ("single", 121105)], tmp_path / "runs.jsonl"
    sweep.run_sweep(tmp_path, runs, [], campaigns)
    first = sweep.read_runs(runs)
    assert [one["word"] for one in first] == ["right", "ambiguous, truth in it"]
    sweep.run_sweep(tmp_path, runs, ["rival_score"], campaigns[1:])
    found = sweep.read_runs(runs)
    assert found[:2] == first and len(found) == 4
    assert sweep.effect_of("rival_score", found) == (
        "-30 %: 1 of 1 (1 x ambiguous, truth in it to right); +30 %: 0 of 1"
    )
    assert sweep.effect_of("least_gain", found) == "-30 %: not run; +30 %: not run"
