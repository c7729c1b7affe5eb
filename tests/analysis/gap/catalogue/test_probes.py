# SPDX-License-Identifier: MIT
"""The residual of a wrong law is detected although the right law is not listed."""

import gap_bench as made
import numpy as np
import pytest

from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.catalogue.probes import PROBES
from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.model.effect import PROBE_FAMILY, Term
from jointbench.analysis.gap.residuals.make_bench import make_bench

BENCH = make_bench(made.made_campaign([]))
BASE = np.zeros(len(BENCH.base_names))


def response_with(name: str, size: float) -> np.ndarray:
    """Return the response with one probe of a size, at its first site."""
    probe = next(c for c in BENCH.probes if c.effect.name == name)
    rest = [p.encode(p.starts[0]) for p in probe.effect.parameters[1:]]
    return BENCH.response(BASE, [Term(probe, np.array([size, *rest]))], 2)


@pytest.mark.parametrize("name", [p.effect.name for p in PROBES])
def test_a_probe_of_no_size_changes_nothing(name: str) -> None:
    """At size 0 the response of the base is unchanged to the last bit."""
    np.testing.assert_array_equal(response_with(name, 0.0), BENCH.response(BASE, [], 2))


@pytest.mark.parametrize("name", [p.effect.name for p in PROBES])
def test_a_probe_is_a_first_term(name: str) -> None:
    """Twice the size is twice the change, so one evaluation gives its direction."""
    base = BENCH.response(BASE, [], 2)
    once, twice = (response_with(name, a) - base for a in (1e-5, 2e-5))
    assert np.abs(once).max() > 1e-12 * np.abs(base).max()
    assert np.abs(twice - 2 * once).max() < 1e-2 * np.abs(twice).max()


@pytest.mark.parametrize("names", [{"delay"}, {"polarity"}, set()])
def test_a_large_residual_without_a_catalogue_is_unknown(
    names: set[str],
) -> None:
    """The search ends without an error if no pair is possible."""
    campaign = made.made_campaign([("cubic_stiffness", "link:joint", [2e17])])
    entries = tuple(e for e in CATALOGUE if e.effect.name in names)
    found = diagnose(campaign, entries=entries)
    assert found.verdict is Finding.UNKNOWN
    assert found.gap_before.chi2_per_dof > 30.0


def test_no_probe_can_be_named() -> None:
    """They are not in the catalogue, and have a separate family."""
    assert all(p.effect.family == PROBE_FAMILY for p in PROBES)
    assert not any(c.effect.family == PROBE_FAMILY for c in BENCH.candidates)
    names = [p.effect.name for p in PROBES] + [e.effect.name for e in CATALOGUE]
    assert len(set(names)) == len(names)


def test_a_stop_is_no_name_for_a_spring_with_an_even_term() -> None:
    """The stop explains most of it; the rest resembles the square of the motion."""
    campaign = made.made_campaign([("quadratic_stiffness", "link:joint", [1e9])])
    entries = tuple(e for e in CATALOGUE if e.effect.name in {"gap", "coulomb"})
    found = diagnose(campaign, entries=entries)
    assert found.verdict is Finding.UNKNOWN
    assert "resembles a square of the motion at link:joint" in found.reason
