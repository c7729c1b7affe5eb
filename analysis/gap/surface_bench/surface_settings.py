# SPDX-License-Identifier: MIT
"""Settings of the surface bench: rows, priors, starts and limits of its verdicts."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import decision, numerical

_SWEPT = "not measured"


@dataclass(frozen=True, slots=True)
class SurfaceBenchSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    null_chance: float = decision(
        3e-4,
        "-",
        "chance of the cost of the base below which something is missing",
        "the rows are deviances and standardised numbers, so that the cost is nearly "
        "chi2 with as many degrees of freedom as there are rows",
        _SWEPT,
    )
    fit_chance: float = decision(
        3e-4,
        "-",
        "chance of the cost of a fit with effects below which it does not explain the "
        "surface",
        "as the null test",
        _SWEPT,
    )
    null_factor: float = decision(
        1.3,
        "-",
        "factor on the limit of the directed tests, above which something is missing",
        "as for lumped campaigns: shapes between the grid points",
        _SWEPT,
    )
    prior_limit: float = decision(
        4.5,
        "sd",
        "deviation of a base parameter above which a fit is rejected",
        "as for bolted joints",
        _SWEPT,
    )
    amplitude_limit: float = decision(
        5.0,
        "sd",
        "root of the drop of the cost by an effect below which it is not named",
        "as for bolted joints",
        _SWEPT,
    )
    model_error: float = decision(
        0.005,
        "of the excess",
        "share of the excess cost of the base that a correct effect may leave",
        "simulated surfaces, seeds below 100: the formula of an effect is not the "
        "physics of the surface",
        _SWEPT,
    )
    tip_error: float = decision(
        0.03,
        "of the excess",
        "the same of a tip",
        "paths of balls on simulated surfaces, seeds below 100: the spectrum of a path "
        "is known to 10 %",
        _SWEPT,
    )
    marks_error: float = decision(
        1e-4,
        "of the excess",
        "the same of tool marks",
        "simulated surfaces, seeds below 100: arcs at a constant feed are harmonics "
        "of one wave",
        _SWEPT,
    )
    most_error: float = decision(
        0.5,
        "of the rows",
        "largest excess cost per row that any effect may leave",
        "measured surfaces of shared data: shares of a large excess let every shape "
        "pass",
        _SWEPT,
    )
    tolerances: tuple[float, ...] = decision(
        (0.1, 0.3),
        "-",
        "sd of ln density within which names explain a surface mostly",
        "the widest is that of the band-limited fit: within 30 % of a power law at "
        "every wavelength (signal/band_limited/fit_limits.py)",
        _SWEPT,
    )
    shape_tolerance: float = decision(
        1.5,
        "-",
        "tolerance of skewness and kurtosis over that of ln density",
        "spikes have a kurtosis of ln 4 to ln 90 and must not pass as noise",
        _SWEPT,
    )
    relevant_grid: float = decision(
        0.2,
        "-",
        "least density of the rounding noise of a step over the least density of the "
        "surface at which the step is a row of the data",
        "a finer step changes no lag by more than a tenth",
        _SWEPT,
    )
    most_effects: int = decision(
        3,
        "effects",
        "effects that are combined in one explanation",
        "measured surfaces have a roll-off, a short cut and noise together",
        _SWEPT,
    )
    leaked_share: float = numerical(
        0.02,
        "-",
        "share of a bin's power that may have leaked from the longest waves",
    )
    hurst: float = numerical(0.6, "-", "H at the centre of its prior")
    hurst_sd: float = numerical(
        0.4, "-", "prior sd of H: wide, all values from 0 to 1 are within 1.5 sd"
    )
    level_sd: float = numerical(
        10.0, "-", "prior sd of ln of the level of the spectrum: wide"
    )
    first_modes: int = numerical(
        6, "modes", "longest waves that are rows of their own, beyond them bins"
    )
    mode_ratio: float = numerical(
        1.15, "-", "ratio of the edges of the bins of further long waves"
    )
    surrogates: int = numerical(
        48,
        "lines",
        "Gaussian lines of the measured spectrum that give the scatter of skewness and "
        "kurtosis; their sd is known within 10 %",
    )
    least_shape_sd: float = numerical(
        0.03, "-", "least sd of a row of skewness or kurtosis"
    )
    longest_rounded: int = numerical(
        40, "samples", "lags over which the rounding errors of a step are correlated"
    )
    straight_run: int = numerical(
        5,
        "points",
        "neighbouring points on a straight line, to rounding, that no rough surface "
        "has",
    )
    descent_steps: int = numerical(25, "steps", "most steps of a fit")
    first_steps: int = numerical(8, "steps", "most steps of a start")
    kept_starts: int = numerical(
        2, "starts", "best starts of a candidate that are followed to the end"
    )
    crossover_sharpness: float = numerical(
        1.3,
        "-",
        "sharpness of the change from one power law to another: 2 for a roll-off",
        "sums of two self-affine lines whose H differ by 0.65 have 1.3",
    )
    smooth_start: float = numerical(
        0.95, "-", "H from which fits of a plateau start as well"
    )
    first_effects: int = numerical(
        3, "fits", "best fits that a further effect is added to"
    )
    close_fits: int = numerical(
        4, "fits", "best fits whose residual is tested by all further effects"
    )
    folds: int = numerical(4, "-", "parts of the waves that are held out in turn")
    slope_step: float = numerical(1e-5, "-", "step of a difference by the base")
    interval_z: float = numerical(1.96, "sd", "half width of an interval of 95 %")
    most_teeth: int = numerical(
        5, "teeth", "teeth of a cutter in a revolution that are tried"
    )
    fewest_waves: float = numerical(
        5.0, "waves", "waves on a line below which marks are not said to repeat"
    )
    mark_trials: int = numerical(
        9, "trials", "wavelengths tried in each step of the search for marks"
    )
    teeth_gain: float = numerical(
        0.01, "-", "least share of the power by which more teeth must explain more"
    )
    least_gaps: int = numerical(
        20, "gaps", "differences of heights below which no step of rounding is sought"
    )
    off_step: float = numerical(
        0.02,
        "steps",
        "distance of a difference of heights from a whole number of rounding steps",
    )
    same_height: float = numerical(
        1e-9,
        "-",
        "difference of two heights over their range below which they are the same",
    )
    sure_sd: float = numerical(
        0.05, "-", "sd of a row that is known to be true or false"
    )
    count_sd: float = numerical(0.3, "-", "sd of the row of straight runs")
    repeated_heights: int = numerical(
        4, "points", "neighbouring points of one height that no rough surface has"
    )
    fine_lines: int = numerical(
        4,
        "-",
        "zero padding of the transform in which waves are sought, over the length",
    )
    least_bins: int = numerical(
        20, "lines", "lines of a band below which it is not searched for waves"
    )
    structure_cells: int = numerical(
        600,
        "cells",
        "cells over the wavenumber of the integral for a structure function",
    )
    structure_lowest: float = numerical(
        0.05,
        "-",
        "lowest wavenumber of that integral over that of the length of a line",
    )
    folded_images: int = numerical(
        3, "-", "images of the spectrum on each side that sampling folds in"
    )
    largest_depth: float = numerical(
        60.0,
        "-",
        "exponent of an attenuation above which it is complete, against underflow",
    )
    tip_lag: float = numerical(
        3.0,
        "samples",
        "lag whose structure function gives a scale for the radius of a tip",
    )
    finish_hurst: float = numerical(
        0.5, "-", "H of the finer process where the lines do not determine it"
    )
    rounding_points: int = numerical(
        14, "-", "power of two of the points of a moment of rounded differences"
    )
    rounding_reach: float = numerical(
        0.3, "-", "first step of a search for the differences ahead of a converter"
    )
    decade_parts: int = numerical(
        2, "-", "parts of a decade of wavelength that are shown as one row"
    )
    mark_stages: tuple[tuple[float, int], ...] = numerical(
        ((0.3, 6), (0.05, 12), (0.008, 30), (0.001, 80), (0.0002, 80)),
        "waves, -",
        "half width of a search over waves per line, and harmonics in it: many fix the "
        "wavelength precisely, few find it",
    )


SURFACE = SurfaceBenchSettings()
