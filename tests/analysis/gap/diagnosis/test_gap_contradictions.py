"""No two sentences of a gap report contradict each other, for any effect."""

from dataclasses import replace

import gap_outcomes as outcomes
import pytest
from gap_contradictions import contradictions

from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.diagnosis.diagnose import conclude
from jointbench.analysis.gap.model.diagnosis_record import Finding

JOINT = "link:joint"
HIDDEN = {
    "cubic_stiffness": (JOINT, [3e15]),
    "quadratic_stiffness": (JOINT, [2e11]),
    "gap": (JOINT, [2e7, 4e-6]),
    "jenkins": (JOINT, [5e6, 2e-6, 14.0]),
    "iwan": (JOINT, [5e6, 1e-5, 1.6, 14.0]),
    "bouc_wen": (JOINT, [5e6, 4e-6, 1.4, 1.0]),
    "coulomb": (JOINT, [5.0, 2e-4]),
    "quadratic_damping": (JOINT, [3e4]),
    "saturation": ("channel:a1", [6e-3]),
    "hum": ("channel:a1", [0.5, 100.0]),
    "maxwell": (JOINT, [5e6, 5e-4]),
    "extra_damping": ("body:m2", [100.0]),
    "added_mass": ("body:m2", [0.3]),
    "hidden_mode": ("body:m2", [0.2, 400.0, 0.02]),
    "preload_stiffness": (JOINT, [0.1]),
    "preload_damping": (JOINT, [0.5]),
    "loosening": (JOINT, [0.05]),
    "delay": ("channel:a1", [4e-5]),
    "gain_error": ("channel:a1", [0.05]),
    "sensor_lowpass": ("channel:a1", [4e-5]),
    "polarity": ("channel:a1", [1.0]),
    "cross_talk": ("channel:a1", [0.05]),
}


def test_every_effect_of_the_catalogue_is_hidden_once() -> None:
    """A new entry needs a case here."""
    assert set(HIDDEN) == {e.effect.name for e in CATALOGUE}


@pytest.mark.parametrize("name", HIDDEN)
def test_the_sentences_about_an_effect_do_not_contradict_each_other(name: str) -> None:
    """Terminal, report and JSON; once with the effect fitted, once without."""
    site, values = HIDDEN[name]
    outcome, bench = outcomes.outcome_of(
        [(name, site, values)], (name, site), at_truth=True
    )
    named = conclude(outcome, bench)
    assert contradictions(named, frozenset({name})) == []
    nothing = {"best": outcome.base, "ranked": (), "level": (outcome.base,)}
    lost = replace(outcome, acceptance=outcome.base_acceptance, **nothing)
    unknown = conclude(lost, bench)
    assert unknown.verdict in (Finding.UNKNOWN, Finding.MOSTLY, Finding.NONE)
    assert contradictions(unknown, frozenset({name})) == []
