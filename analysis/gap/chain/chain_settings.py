# SPDX-License-Identifier: MIT
"""Settings of the chain: discrepancies, starts and limits."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import decision, numerical

_SWEPT = "not measured"


@dataclass(frozen=True, slots=True)
class ChainBenchSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    mode_discrepancy: float = decision(
        0.05,
        "-",
        "sd of ln of a natural frequency that is free at the interface between joint "
        "and structure, alike at all preloads",
        "a structure model that is off by more fails against its own hits",
        _SWEPT,
    )
    most_causes: int = decision(
        3,
        "effects",
        "effects of the contact that are named together",
        "as in the engine for hits",
        _SWEPT,
    )
    further_gain: float = decision(
        30.0,
        "score",
        "gain of a further cause below which a set is not named",
        "twice the least difference of rivals: chains 8217 and 8225 of "
        "benchmarks/gap/chain_score.py, where a formula that is not quite the physics "
        "called for a second cause",
        _SWEPT,
    )
    reading_sd: float = numerical(
        0.003,
        "-",
        "least sd of ln k of a state",
        "hits of one condition differ by 0.1 to 0.3 % in the joint's stiffness",
    )
    free_stiffness_sd: float = numerical(
        2.5,
        "-",
        "prior sd of ln of the joint's stiffness and damping in each state",
        "wide: three decades either way are within 3 sd",
    )
    surface_charge: float = numerical(
        12.0,
        "-",
        "charge of a parameter of a surface in the score of a place",
        "as in the engine",
    )
    spike_window: int = numerical(
        5, "points", "width of the median that replaces spikes of the heights"
    )
    spike_limit: float = numerical(
        6.0,
        "sd",
        "deviation from that median above which a height is a spike",
        "normal heights: one in 5e8",
    )
    free_factor_sd: float = numerical(
        10.0,
        "-",
        "sd of ln of the factor of a law that is free",
        "wide: laws are off by up to five decades",
    )
    free_power_sd: float = numerical(
        2.0, "-", "sd of the exponent of the preload that is free", "wide"
    )
    scan_reach: float = numerical(
        4.0, "-", "ln of the factor up to which a first stiffness is sought"
    )
    scan_points: int = numerical(
        41, "points", "stiffnesses at which the hits are predicted first"
    )
    scan_windows: tuple[float, ...] = numerical(
        (0.01, 0.003),
        "s",
        "windows of these predictions, that of the first start before the others",
        "chains 8209 and 8269 of benchmarks/gap/chain_score.py: in 10 ms a joint that "
        "is far too stiff fits as well as the right one",
    )
    scan_starts: int = numerical(
        4, "starts", "minima along the stiffness from which a state is fitted at most"
    )
    least_explained: float = numerical(
        1.5,
        "-",
        "chi2 over dof of a fit of a state after which no other start is tried",
    )
    least_hits: int = numerical(
        2, "hits", "of one preload, below which it gives no stiffness"
    )
    pair_starts: int = numerical(
        4, "starts", "starts of the shape of an effect that is added to others"
    )
    pair_fits: int = numerical(
        5, "fits", "best fits to which a further effect is added"
    )
    least_force: float = numerical(
        0.05, "-", "force of a line over the largest below which an FRF is not shown"
    )
    draws: int = numerical(400, "draws", "of the inputs, for the interval of a cause")
    seed: int = numerical(298, "-", "of these draws, so that a run can be repeated")


CHAIN = ChainBenchSettings()
