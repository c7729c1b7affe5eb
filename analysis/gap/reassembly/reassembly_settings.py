# SPDX-License-Identifier: MIT
"""Settings of the comparison of assemblies."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ReassemblySettings:
    """Numbers that the scatter between assemblies is estimated and judged with.

    Attributes:
        log_sd: sd of the logarithm of either scatter about its nominal value, as prior
            [-]: three assemblies hardly show a scatter, and published ones differ by
            such a factor.
        grid: number of values of either scatter.
        reach: range of the grid, in `log_sd` on either side [-].
        same_level: levels closer than this in their logarithm are one level [-].
        most_degree: highest degree of ln k over ln level.
        confidence: of intervals [-].
        significance: a joint has changed where its values are less probable [-].
        tests: tests that share the significance: of the offset and of the shape.
        power: probability with which a detectable change is seen [-].
        widest: where only a change beyond this factor is seen, nothing is decided [-].
        extrapolation: levels beyond those measured by more than this factor are
            refused [-].
        bracket: sd on either side in which quantiles are searched [-].
        damping_within: nominal sd of damping from tightening to tightening, more than
            the preload alone makes [-].
    """

    log_sd: float = 0.6
    grid: int = 25
    reach: float = 3.0
    same_level: float = 0.05
    most_degree: int = 2
    confidence: float = 0.95
    significance: float = 0.01
    tests: int = 2
    power: float = 0.8
    widest: float = 2.0
    extrapolation: float = 1.5
    bracket: float = 8.0
    damping_within: float = 0.2


REASSEMBLY = ReassemblySettings()
