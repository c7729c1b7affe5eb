# SPDX-License-Identifier: MIT
"""Every effect of the catalogue: off is off, and it grows from there in a line."""

import gap_bench as made
import numpy as np
import pytest

from jointbench.acquisition.errors import UsageError
from jointbench.analysis.gap.bench import FULL
from jointbench.analysis.gap.catalogue import CATALOGUE, check_names
from jointbench.analysis.gap.effects import Candidate, Term
from jointbench.analysis.gap.lumped_make import make_bench
from jointbench.analysis.gap.screening import start_grid

BENCH = make_bench(made.made_campaign([]))
BASE = made.BASE
FIXED = {"polarity", "saturation"}


@pytest.mark.parametrize("candidate", BENCH.candidates, ids=lambda c: c.label)
def test_an_effect_that_is_off_reproduces_the_base_to_the_last_bit(
    candidate: Candidate,
) -> None:
    """Amplitude 0 leaves the residual bit for bit."""
    u = start_grid(candidate)[0]
    u[0] = 0.0
    off = BENCH.residual(BASE, (Term(candidate, u),), FULL)
    assert np.array_equal(off, BENCH.residual(BASE, (), FULL))


@pytest.mark.parametrize(
    "candidate",
    [c for c in BENCH.candidates if c.effect.name not in FIXED],
    ids=lambda c: c.label,
)
def test_the_change_an_effect_makes_is_proportional_to_a_small_amplitude(
    candidate: Candidate,
) -> None:
    """Doubling a small amplitude doubles the change to within 2 %."""
    u = start_grid(candidate)[len(start_grid(candidate)) // 2]
    base = BENCH.residual(BASE, (), FULL)
    changes = []
    for amplitude in (1e-5, 2e-5):
        u[0] = amplitude
        changes.append(BENCH.residual(BASE, (Term(candidate, u),), FULL) - base)
    size = float(np.linalg.norm(changes[0]))
    assert size > 0
    # Hum chooses its phase by the residual, which its amplitude does not alter.
    assert float(np.linalg.norm(changes[1] - 2 * changes[0])) < 0.02 * size


def test_the_catalogue_holds_the_twenty_two_effects_of_version_one() -> None:
    """Names are fixed: files and reports rest on them."""
    names = {entry.effect.name for entry in CATALOGUE}
    assert len(names) == len(CATALOGUE) == 22
    assert {"cubic_stiffness", "jenkins", "hidden_mode", "polarity", "hum"} <= names


def test_every_effect_names_its_source_and_a_rival_with_an_experiment() -> None:
    """Nobody has to take the catalogue's word."""
    for entry in CATALOGUE:
        assert entry.effect.source
        assert entry.effect.separates


def test_a_name_outside_the_catalogue_is_refused_with_near_matches() -> None:
    """A misspelt --without must not pass in silence."""
    with pytest.raises(UsageError, match="jenkins"):
        check_names(["jenkin"], CATALOGUE)


def test_without_takes_an_effect_out_at_every_site() -> None:
    """`--without delay` leaves no delay candidate."""
    bench = make_bench(BENCH.campaign, without=frozenset({"delay"}))
    assert all(c.effect.name != "delay" for c in bench.candidates)
    assert len(bench.candidates) == len(BENCH.candidates) - 3
