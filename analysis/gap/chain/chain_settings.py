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
    scan_window: float = numerical(
        0.01, "s", "window of these predictions", "as the second of a base fit"
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


CHAIN = ChainBenchSettings()
