# SPDX-License-Identifier: MIT
"""The engine on a bench without dynamics: it must be independent of the physics."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
import scipy.optimize

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome, investigate, judged
from jointbench.analysis.gap.judgement import winner_judging as judging
from jointbench.analysis.gap.judgement.held_out import hold_out
from jointbench.analysis.gap.model.confidence import Evidence, confidence_of
from jointbench.analysis.gap.model.effect import (
    PROBE_FAMILY,
    Candidate,
    Effect,
    Site,
    Term,
    labels_of,
)
from jointbench.analysis.gap.model.effect_parameter import Parameter, Transform
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Blocks, Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.exchange import exchanged
from jointbench.analysis.gap.search.restarts import caught_up, crossed
from jointbench.analysis.gap.search.screening import null_threshold, screen
from jointbench.analysis.gap.search.selection_round import run_selection

ROWS, GROUPS = 4000, 8
POWERS = {"square": 2, "cube": 3, "fifth": 5}


def effect(name: str) -> Candidate:
    """Return a toy effect: a power of the load."""
    amplitude = Parameter("a", "-", "one", -50.0, 50.0, off=0.0)
    return Candidate(Effect(name, "toy", (amplitude,), "made up"), Site("curve", "y"))


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """A straight line through the origin, measured with unit noise of 0.01."""

    measured: FloatArray
    candidates: tuple[Candidate, ...]
    base_names: tuple[str, ...] = ("slope",)
    probes: tuple[Candidate, ...] = ()
    policy: Policy = STANDARD

    @property
    def base_sd(self) -> FloatArray:
        """10 % of the slope."""
        return np.array([0.1])

    @property
    def blocks(self) -> Blocks:
        """Eight groups of rows."""
        group = np.repeat(np.arange(GROUPS), ROWS // GROUPS)
        labels = tuple({"group": str(i)} for i in range(GROUPS))
        return Blocks(group, labels, ROWS, (GROUPS, 1, ROWS // GROUPS))

    def scale(self, word: str) -> float:
        """Return 1: all sizes are of order one."""
        return 1.0

    @property
    def expanded(self) -> bool:
        """The curve is exact everywhere."""
        return False

    def phases(self, candidate: Candidate) -> int:
        """No effect has a phase."""
        return 0

    def hints(self, fit: Fit, candidate: Candidate) -> list[FloatArray]:
        """A curve gives no hints."""
        return []

    @property
    def stiffness_sd(self) -> FloatArray:
        """A curve has no joint."""
        return np.zeros(0)

    def at_stiffness(self, settling: FloatArray) -> "Curve":
        """Return the bench unchanged."""
        return self

    def refine(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        *,
        without: Sequence[int] = (),
    ) -> "Curve":
        """The noise is known."""
        return self

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return (model - measurement) / 0.01."""
        y = LOAD * np.exp(base[0])
        for term in terms:
            y = y + term.coordinates[0] * LOAD ** POWERS[term.candidate.effect.name]
        return np.asarray((y - self.measured) / 0.01)


LOAD = np.tile(np.linspace(-1, 1, ROWS // GROUPS), GROUPS)


def curve(square: float = 0.0, cube: float = 0.0, seed: int = 3) -> Curve:
    """Return a measured curve with hidden powers."""
    noise = 0.01 * np.random.default_rng(seed).standard_normal(ROWS)
    measured = 1.05 * LOAD + square * LOAD**2 + cube * LOAD**3 + noise
    return Curve(measured, (effect("square"), effect("cube")))


def run(bench: Curve) -> SearchOutcome:
    """Run the search without progress lines."""
    return investigate(bench, lambda line: None)


def names(outcome: SearchOutcome) -> list[str]:
    """Return the effects of the best fit."""
    return sorted(c.effect.name for c in outcome.best.candidates)


@pytest.mark.parametrize("seed", range(5))
def test_a_curve_with_nothing_missing_has_no_effect(seed: int) -> None:
    """Noise alone passes the null test."""
    outcome = run(curve(seed=seed))
    assert outcome.acceptance.passed
    assert names(outcome) == []


def test_a_single_effect_is_found_with_its_size() -> None:
    """A square of 0.02 is found within 4 sd."""
    outcome = run(curve(square=0.02))
    assert outcome.acceptance.passed
    assert names(outcome) == ["square"]
    assert outcome.best.x[-1] == pytest.approx(0.02, abs=0.0015)


def test_two_effects_are_found_one_after_the_other() -> None:
    """A square and a cube are both named, in whichever order."""
    outcome = run(curve(square=0.05, cube=0.1))
    assert outcome.acceptance.passed
    assert names(outcome) == ["cube", "square"]


def test_an_effect_outside_the_catalogue_is_left_unexplained() -> None:
    """A hidden square is not accepted if the catalogue has only a cube."""
    bench = replace(curve(square=0.05), candidates=(effect("cube"),))
    assert not run(bench).acceptance.passed


def test_the_residual_of_a_wrong_effect_is_recognised_by_its_shape() -> None:
    """A cube in addition to a square is detected by a probe, and never named."""
    bench = replace(curve(square=0.05, cube=0.006), candidates=(effect("square"),))
    cube = effect("cube")
    probe = replace(cube, effect=replace(cube.effect, family=PROBE_FAMILY))
    outcome = run(replace(bench, probes=(probe,)))
    assert "resembles a cube at curve:y" in outcome.acceptance.reason
    assert names(outcome) == ["square"]


def test_half_a_pair_is_exchanged() -> None:
    """A cube that imitates a fifth power is replaced once the square is included."""
    noise = 0.01 * np.random.default_rng(8).standard_normal(ROWS)
    measured = 1.05 * LOAD + 0.2 * LOAD**2 + 0.3 * LOAD**5 + noise
    bench = Curve(measured, tuple(effect(name) for name in POWERS))
    wrong = (effect("square"), effect("cube"))
    fit = minimise(make_problem(bench, wrong), np.array([0.0, 0.1, 0.1]))
    best = min(exchanged(bench, fit, (), lambda line: None), key=lambda f: f.cost)
    assert {c.effect.name for c in best.candidates} == {"square", "fifth"}
    assert best.cost < 0.9 * fit.cost
    known = {labels_of(best.candidates)}
    rest = exchanged(bench, fit, known, lambda line: None)
    assert rest
    assert all(labels_of(f.candidates) not in known for f in rest)


def test_a_diverged_fit_catches_up_from_the_base_of_the_best() -> None:
    """From a slope of e^3 the descent is long; from the best base it is short."""
    bench = curve(cube=0.2)
    best = minimise(make_problem(bench, (effect("cube"),)), np.zeros(2))
    diverged = replace(best, x=np.array([3.0, -15.0]), cost=1e9)
    again = crossed(bench, [best, diverged], lambda line: None)[1]
    assert again.cost == pytest.approx(best.cost, rel=1e-6)
    assert caught_up(bench, diverged, best, lambda line: None).cost == pytest.approx(
        best.cost, rel=1e-6
    )


def test_the_null_threshold_of_one_direction_is_the_quantile_of_chi_square() -> None:
    """One two-sided direction: 99.5 % of chi2 with one degree of freedom is 7.88."""
    one = np.ones((1, 1))
    limit = null_threshold(one, np.array([False]), np.ones(1), seed=1)
    assert limit == pytest.approx(7.88, abs=1.2)


def test_holding_out_agrees_with_a_refit_without_the_group() -> None:
    """The Newton step equals an explicit refit for a model linear in its parameter."""
    bench = curve()
    fit = minimise(make_problem(bench, (effect("square"),)), np.array([0.0, 0.1]))
    held = hold_out(fit, bench)
    out = bench.blocks.group == 2
    keep = np.stack([LOAD * np.exp(fit.x[0]), LOAD**2], axis=1)[~out] / 0.01
    normal = keep.T @ keep + np.diag(fit.prior)
    start = bench.residual(fit.base, fit.terms, Resolution())
    step = -np.linalg.solve(normal, keep.T @ start[~out] + fit.prior * fit.x)
    moved = start + fit.jacobian @ step
    assert held.chi2[2] == pytest.approx(float(moved[out] @ moved[out]), rel=1e-4)


@dataclass(frozen=True, slots=True, eq=False)
class Kinked(Curve):
    """A curve with a kink at a load that only the last group exceeds by much."""

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return (model - measurement) / 0.01."""
        y = FAR_LOAD * np.exp(base[0])
        for term in terms:
            edge = np.exp(term.coordinates[1:]).sum()  # 0 without a threshold
            y = y + term.coordinates[0] * np.maximum(FAR_LOAD - edge, 0.0)
        return np.asarray((y - self.measured) / 0.01)


FAR_LOAD = np.concatenate([LOAD[: -ROWS // GROUPS], 2.0 * LOAD[: ROWS // GROUPS]])
KINK = Candidate(
    Effect(
        "kink",
        "toy",
        (
            Parameter("a", "-", "one", -50.0, 50.0, off=0.0),
            Parameter("s", "-", "one", 0.1, 5.0, (1.0,), Transform.LOG),
        ),
        "made up",
    ),
    Site("curve", "y"),
)


def test_a_group_that_alone_holds_an_effect_is_held_out_by_a_refit() -> None:
    """As scipy's fit to the others; the linear step errs by a factor of 2."""
    noise = 0.01 * np.random.default_rng(2).standard_normal(ROWS)
    bend = 0.5 * np.maximum(FAR_LOAD - 0.97, 0.0)
    bench = Kinked(1.05 * FAR_LOAD + bend + noise, (KINK,))
    fit = minimise(make_problem(bench, (KINK,)), np.array([0.0, 0.4, 0.0]))
    assert fit.chi2 == pytest.approx(ROWS, rel=0.1)
    rows = bench.blocks.group == GROUPS - 1

    def seen(x: FloatArray) -> FloatArray:
        r = bench.residual(x[:1], (Term(KINK, x[1:]),), Resolution())
        return np.append(r[~rows], x[0] / 0.1)

    other = scipy.optimize.least_squares(seen, fit.x).x
    left = bench.residual(other[:1], (Term(KINK, other[1:]),), Resolution())[rows]
    held = hold_out(fit, bench).chi2[-1]
    j, r = fit.jacobian[rows], fit.residual[rows]
    hessian = fit.jacobian.T @ fit.jacobian + np.diag(fit.prior)
    first = r + j @ np.linalg.solve(hessian - j.T @ j, j.T @ r)
    assert held == pytest.approx(float(left @ left), rel=0.05)
    assert not 0.5 < float(first @ first) / held < 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Overestimated(Curve):
    """A curve whose noise is assumed a tenth of its size until it is estimated."""

    refined: bool = False

    def refine(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        *,
        without: Sequence[int] = (),
    ) -> "Overestimated":
        """Set the noise to its true size."""
        return replace(self, refined=True)

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return (model - measurement) / 0.01, or / 0.001."""
        return Curve.residual(self, base, terms, resolution) * (
            1.0 if self.refined else 10.0
        )


def test_an_effect_that_is_unnecessary_with_the_true_noise_is_removed() -> None:
    """A square of zero amplitude was added because of noise alone."""
    plain = curve(cube=0.2)
    bench = Overestimated(plain.measured, plain.candidates)
    base = minimise(make_problem(bench, ()), np.zeros(1))
    both = minimise(make_problem(bench, plain.candidates), np.zeros(3))
    found = judged(bench, [both], base, lambda line: None)
    assert [c.effect.name for c in found.fits[0].candidates] == ["cube"]
    assert found.acceptance.passed


@dataclass(frozen=True, slots=True, eq=False)
class Alternating(Curve):
    """A curve whose noise estimate alternates between two sizes."""

    quiet: bool = False
    rounds: list[bool] = field(default_factory=list)

    def refine(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        *,
        without: Sequence[int] = (),
    ) -> "Alternating":
        """Change the noise once more."""
        self.rounds.append(not self.quiet)
        return replace(self, quiet=not self.quiet)

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return (model - measurement) / 0.01, or / 0.005."""
        return Curve.residual(self, base, terms, resolution) * (
            2.0 if self.quiet else 1.0
        )


def test_an_alternating_noise_estimate_ends_at_the_smaller_one() -> None:
    """The iteration stops after a few rounds, since it will not converge."""
    plain = curve(cube=0.2)
    bench = Alternating(plain.measured, plain.candidates)
    base = minimise(make_problem(bench, ()), np.zeros(1))
    fit = minimise(make_problem(bench, (effect("cube"),)), np.zeros(2))
    last, _, _ = judging.judge(bench, [fit], base, lambda line: None)
    assert isinstance(last, Alternating)
    assert last.quiet
    assert len(bench.rounds) <= 4


def test_confidence_never_falls_with_more_evidence() -> None:
    """A wider margin, more slack or one effect instead of two never lowers it."""
    poor = Evidence(15.0, 0.1, 5.0, 2)
    better = (
        replace(poor, margin=1e4),
        replace(poor, slack=1.0),
        replace(poor, amplitude=100.0),
        replace(poor, effects=1),
    )
    confidences = [confidence_of(evidence) for evidence in better]
    assert all(0.5 < confidence_of(poor) <= c < 1.0 for c in confidences)
    assert max(confidences) > confidence_of(poor) + 0.02


def test_the_directed_tests_belong_to_the_best_fit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A pair that overtakes in the last round is judged by its own directed tests."""
    monkeypatch.setattr(judging, "OVERTAKEN", 1)
    bench = curve(square=0.05, cube=0.1)
    cube, square = effect("cube"), effect("square")
    base = minimise(make_problem(bench, ()), np.zeros(1))
    alone = minimise(make_problem(bench, (cube,)), np.zeros(2))
    both = minimise(make_problem(bench, (cube, square)), np.zeros(3))
    _, ranked, acceptance = judging.judge(bench, [alone, both], base, lambda line: None)
    assert names_of(ranked[0]) == ["cube", "square"]
    assert acceptance.left is not None
    assert all(d.shift.shape == ranked[0].x.shape for d in acceptance.left.directions)
    assert acceptance.passed


def test_an_effect_beyond_its_threshold_leaves_the_next_effect_its_start() -> None:
    """A kink above every load changes no value; a stiffness is added beside it."""
    noise = 0.01 * np.random.default_rng(4).standard_normal(ROWS)
    bench = Kinked(1.05 * FAR_LOAD + noise, (KINK,))
    above = np.array([0.0, 0.5, np.log(3.0)])
    fit = minimise(make_problem(bench, (KINK,)), above, iterations=1)
    assert not fit.jacobian[:, 1:].any()
    other = effect("other")
    other = replace(other, effect=replace(other.effect, by_prior=True))
    found = run_selection(
        bench, fit, screen(bench, fit, [other]), [other], lambda line: None
    )
    assert names_of(found[0]) == ["kink", "other"]


def names_of(fit: Fit) -> list[str]:
    """Return the names of a fit's effects."""
    return sorted(c.effect.name for c in fit.candidates)
