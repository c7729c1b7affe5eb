# SPDX-License-Identifier: MIT
"""Every effect of the catalogue: none at amplitude 0, and linear near it."""

import ast
from dataclasses import replace
from pathlib import Path

import gap_bench as made
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.catalogue import catalogue
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE, check_names
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.screening import start_grid

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
    # Hum fits its phase to the residual, which its amplitude does not change.
    assert float(np.linalg.norm(changes[1] - 2 * changes[0])) < 0.02 * size


def test_the_catalogue_holds_the_twenty_two_effects_of_version_one() -> None:
    """Names are fixed: files and reports refer to them."""
    names = {entry.effect.name for entry in CATALOGUE}
    assert len(names) == len(CATALOGUE) == 22
    assert {"cubic_stiffness", "jenkins", "hidden_mode", "polarity", "hum"} <= names


def test_every_effect_names_its_source_and_a_rival_with_an_experiment() -> None:
    """The statements of the catalogue can be checked."""
    for entry in CATALOGUE:
        assert entry.effect.source
        assert entry.effect.separates


def test_a_name_outside_the_catalogue_is_refused_with_near_matches() -> None:
    """A misspelt --without must not be ignored."""
    with pytest.raises(UsageError, match="jenkins"):
        check_names(["jenkin"], CATALOGUE)


def test_without_takes_an_effect_out_at_every_site() -> None:
    """`--without delay` leaves no delay candidate."""
    bench = make_bench(BENCH.campaign, without=frozenset({"delay"}))
    assert all(c.effect.name != "delay" for c in bench.candidates)
    assert len(bench.candidates) == len(BENCH.candidates) - 3


def test_the_catalogue_says_which_effects_start_at_peaks_and_find_phases() -> None:
    """A hum is one line of the residual, a hidden mode one resonance."""
    effects = [entry.effect for entry in CATALOGUE]
    assert {e.name for e in effects if e.starts_at_peaks} == {"hum", "hidden_mode"}
    assert {e.name for e in effects if e.own_phases} == {"hum"}


def test_what_an_effect_declares_holds_whatever_it_is_called() -> None:
    """Starts at peaks and free phases depend on the declaration, not on the name."""
    entry = next(e for e in CATALOGUE if e.effect.name == "hum")
    own = replace(entry, effect=replace(entry.effect, name="pick_up"))
    silent = replace(
        entry,
        effect=replace(entry.effect, starts_at_peaks=False, own_phases=False),
    )
    campaign = made.made_campaign([("hum", "channel:all", [1.0, 50.0])])
    bench = make_bench(campaign, entries=(own, silent))
    fit = minimise(make_problem(bench, ()), np.zeros(6))
    records, channels, _ = bench.campaign.response.shape
    free = {str(c.site): records for c in bench.candidates}
    free["channel:all"] = records * channels
    for candidate in bench.candidates:
        declared = candidate.effect.name == "pick_up"
        assert bool(bench.hints(fit, candidate)) is declared
        assert bench.phases(candidate) == (free[str(candidate.site)] if declared else 0)


def test_an_effect_without_a_frequency_cannot_start_at_peaks() -> None:
    """The message names the effect and the way out."""
    delay = next(e.effect for e in CATALOGUE if e.effect.name == "delay")
    with pytest.raises(UsageError, match=r"'delay' starts at peaks but has 1 param"):
        replace(delay, starts_at_peaks=True)


def test_no_module_of_the_engine_but_the_catalogue_knows_an_effect_by_its_name() -> (
    None
):
    """An effect declares its influence on search and wording in its record."""
    root = Path(catalogue.__file__).parents[1]
    names = {entry.effect.name for entry in CATALOGUE}
    found = [
        f"{path.relative_to(root)}:{node.lineno} {node.value!r}"
        for path in sorted(root.rglob("*.py"))
        # The second method formulates every effect once more, from its name.
        if path.parent.name not in ("catalogue", "second_method")
        # The catalogue of bolted bodies.
        and not path.match("structure_bench/*_effects.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Constant) and node.value in names
    ]
    assert not found


def test_model_errors_and_order_are_those_that_the_effects_declare() -> None:
    """Two laws allow for more model error than their family; one follows the order."""
    effects = [entry.effect for entry in CATALOGUE]
    errors = {e.name: e.model_error for e in effects if e.model_error is not None}
    assert errors == {"iwan": 5e-5, "coulomb": 1e-5}
    assert {e.name for e in effects if e.follows_order} == {"loosening"}


@pytest.mark.parametrize("share", [-1e-6, 1.0, float("nan")])
def test_a_model_error_that_is_no_share_is_refused(share: float) -> None:
    """The message names the effect, the value and the rule."""
    delay = next(e.effect for e in CATALOGUE if e.effect.name == "delay")
    with pytest.raises(UsageError, match=r"'delay' has a model_error of .* a share"):
        replace(delay, model_error=share)
