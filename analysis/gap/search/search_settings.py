# SPDX-License-Identifier: MIT
"""Settings of the search: descent, directed tests, starts and selection rounds."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class SearchSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    excess_tolerance: float = numerical(
        1e-3,
        "of the excess",
        "drop of the cost, as a share of the excess of chi2, below which a "
        "descent ends",
        "a share of chi2 itself would hide an effect of 100 units among 60,000",
    )
    absolute_tolerance: float = numerical(
        0.03,
        "chi2",
        "drop of the cost added to that",
        "far below any threshold of a verdict",
    )
    promised_share: float = numerical(
        0.1,
        "of the last drop",
        "drop that a step must promise, relative to the drop at which a descent ends",
        "a descent ends there in any case; steps at a minimum took a fifth of its time",
    )
    base_step: float = numerical(
        1e-7,
        "-",
        "difference step of the logarithm of a base parameter",
        "at 1e-5 the slope is inaccurate at the end of a record of hundreds of "
        "radians; a maxwell of 0.4 % was missed",
    )
    effect_step: float = numerical(
        1e-6,
        "of the value",
        "difference step of a parameter of an effect",
        "as the base step",
    )
    patience: float = numerical(
        12.0,
        "steps",
        "steps of the last size within which a descent must be able to reach a rival",
        "development campaigns",
    )
    longest_step: float = numerical(
        1.5,
        "-",
        "longest step of a coordinate; most are logarithms",
        "development campaigns",
    )
    corrections: int = numerical(
        2,
        "steps",
        "steps back into the valley before a step is shortened",
        "development campaigns",
    )
    least_damping: float = numerical(
        1e-11,
        "-",
        "first damping of Levenberg and Marquardt",
        "if hits scatter, the common scale of masses and stiffnesses is so weakly "
        "determined that 1e-6 would prevent its change",
    )
    stiff_damping: float = numerical(
        1e-3,
        "-",
        "damping under which only well determined parameters move",
        "development campaigns",
    )
    shorter_step: float = numerical(
        0.7,
        "of the length",
        "length of a step, relative to one that failed, above which it is not tried in "
        "a sparing descent",
        "bases of bolted bodies met the same cost at five dampings in a row",
    )
    secant_steps: int = numerical(
        2,
        "steps",
        "steps in a row for which slopes are updated by the secant",
        "halves the time of a diagnosis",
    )
    trusted_share: float = numerical(
        0.6,
        "of the predicted drop",
        "drop below which slopes are differenced again",
        "development campaigns",
    )
    tests_together: int = numerical(
        16,
        "tests",
        "directed tests whose residuals are whitened together, where a bench can",
        "one by one, errors of bodies took half the time of the tests beside them",
    )
    probe_amplitude: float = numerical(
        1e-6,
        "-",
        "amplitude at which the direction of an effect is differenced",
        "as the step of a descent",
    )
    least_direction: float = numerical(
        1e-10,
        "of the squared length",
        "component of a direction outside the fit below which it is ignored",
        "rounding of single precision",
    )
    screening_steps: int = numerical(
        2,
        "steps/sample",
        "steps of the time integration in a directed test and under a window",
        "as in a search",
    )
    null_draws: int = numerical(
        4000,
        "draws",
        "draws of the largest drop under the null",
        "the chance of the 0.5 % quantile is known to 22 %",
    )
    middle_iterations: int = numerical(
        16,
        "steps",
        "most steps of a descent at the middle step",
        "development campaigns",
    )
    start_shares: tuple[float, float, float] = numerical(
        (1.0, 0.3, 0.1),
        "of the predicted step",
        "steps along a directed test that are tried as starts",
        "development campaigns",
    )
    short_window: float = numerical(
        0.005,
        "s",
        "decay of the first window, in which model and measurement stay in phase",
        "development campaigns",
    )
    longer_window: float = numerical(
        0.016,
        "s",
        "decay of the second window, of several periods of the first modes",
        "development campaigns",
    )
    coarse_survivors: tuple[int, int] = numerical(
        (14, 8),
        "starts",
        "starts kept after each window",
        "development campaigns",
    )
    final_fits: int = numerical(
        5,
        "fits",
        "fits kept for the final step",
        "development campaigns",
    )
    pruning_ratio: float = numerical(
        6.0,
        "of the best cost",
        "cost above which a fit is not carried to the end",
        "development campaigns",
    )
    explained_chi2: float = numerical(
        1.5,
        "of the degrees of freedom",
        "cost below which a start explains the records in a selection round",
        "what is left is scatter, which is estimated later",
    )
    round_pruning_ratio: float = numerical(
        30.0,
        "of the best cost",
        "cost above which a start of another family than one that explains the "
        "records ends after a selection round",
        "case 12: two Iwan elements at 50 times the cost took a tenth of the time; "
        "those that come near have 14 times at most",
    )
    rivals_kept: int = numerical(
        4,
        "starts",
        "starts that are kept in any case",
        "the ranking and the margin need rivals",
    )
    nominal_restart_chi2: float = numerical(
        100.0,
        "-",
        "chi2/dof of the base above which an effect that may change a sign also "
        "starts from the nominal values",
        "development campaigns",
    )
    selection_rounds: tuple[tuple[int, int, int], tuple[int, int, int]] = numerical(
        ((3, 12, 2), (5, 8, 1)),
        "steps, starts, starts of one set",
        "steps of every start in a selection round, starts kept, and starts kept "
        "of one set of effects",
        "computing time on the development campaigns: two starts of one set after "
        "three steps, one after eight",
    )
    least_drop_share: float = numerical(
        0.04,
        "of the largest drop",
        "directed drop below which an effect is not a candidate",
        "development campaigns",
    )
    shape_starts: int = numerical(
        3,
        "starts",
        "starts of a candidate with shape parameters",
        "docs/gap-ablations.md",
    )
    exchange_probe: float = numerical(
        1e-4,
        "-",
        "amplitude at which the exchange between an effect and the base is differenced",
    )
    integration_error: float = numerical(
        50.0,
        "chi2",
        "difference between two step sizes of the time integration above which the "
        "finer one is used",
        "a fourteenth of the noise of chi2 with 16 records",
    )
    exchange_candidates: int = numerical(
        4,
        "effects",
        "effects tried in each place of a pair, by their directed tests",
        "development campaigns",
    )
    pair_iterations: int = numerical(
        6,
        "steps",
        "steps of a descent in the search for pairs",
        "case 01: both effects named in 56 s",
    )
    pair_singles: int = numerical(
        8,
        "effects",
        "single effects that are fitted under the first window",
        "case 01",
    )
    pair_firsts: int = numerical(
        3,
        "effects",
        "single effects to which a second is added",
        "case 01",
    )
    pair_seconds: int = numerical(
        5,
        "effects",
        "second effects tried on each",
        "case 01",
    )
    pair_exchanges: int = numerical(
        3,
        "passes",
        "passes of exchanges in the best pair",
        "case 01",
    )
    pairs_kept: int = numerical(
        5,
        "pairs",
        "pairs kept after each pass",
        "case 01",
    )
    diverged_sd: float = numerical(
        4.0,
        "sd",
        "distance from its nominal values above which a base starts again from "
        "that of the best fit",
        "development campaigns",
    )
    slip_factors: tuple[float, float, float] = numerical(
        (0.6, 1.0, 1.6),
        "-",
        "factors between the slip displacements of two laws of friction",
        "hidden 96033: a Jenkins slider 11,600 units from a Bouc-Wen element",
    )
    slider_cost_above: float = numerical(
        1000.0,
        "chi2",
        "cost above that of a slider law up to which another one is fitted to the end",
        "hidden 96033",
    )
    restart_share: float = numerical(
        0.5,
        "of the cost",
        "cost below which another start is worth a descent",
        "development campaigns",
    )
    base_windows: tuple[float, float, float] = numerical(
        (0.002, 0.006, 0.02),
        "s",
        "decays of the windows under which a base is fitted, coarse to fine",
        "development campaigns",
    )
    window_iterations: int = numerical(
        6,
        "steps",
        "most steps of the fit of a base under a window",
        "development campaigns",
    )
    base_iterations: int = numerical(
        20,
        "steps",
        "most steps of the fit of a base to whole records",
        "development campaigns",
    )
    coarse_iterations: tuple[int, int] = numerical(
        (5, 6),
        "steps",
        "steps of every start under each of two windows",
        "development campaigns",
    )
    restart_cost_ratio: float = numerical(
        10.0,
        "-",
        "cost of a start, over that of the fits, above which it is not used",
    )


SEARCH = SearchSettings()
