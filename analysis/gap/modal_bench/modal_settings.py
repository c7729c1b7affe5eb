# SPDX-License-Identifier: MIT
"""Settings of the bench of modes and ports."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class ModalBenchSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    frf_segments: int = numerical(
        6,
        "segments",
        "segments that the records of the lowest level are cut into for the FRF",
        "start values only: the base is then fitted to the whole records",
    )
    frf_decay: float = numerical(
        5.0,
        "-",
        "decay of a record from rest over its length: what is cut off at its end is "
        "reduced by exp(-5)",
        "made records; more would widen the peaks",
    )
    least_segment: int = numerical(
        1024,
        "samples",
        "shortest segment of an FRF",
        "start values only",
    )
    least_lines: int = numerical(
        16,
        "lines",
        "lines of an FRF below which no modes are fitted",
        "three times the coefficients of one mode",
    )
    silent_share: float = numerical(
        1e-6,
        "of the largest line",
        "power of the force below which a line is left out",
        "60 dB: below the noise of a shaker",
    )
    least_frf_error: float = numerical(
        1e-4,
        "of the rms of the FRF",
        "smallest standard deviation of an FRF line that is assumed",
        "records without noise would otherwise weigh rounding errors",
    )
    start_sd: float = numerical(
        1.0,
        "-",
        "prior sd of the coordinates while the base is fitted to the lowest level",
        "uninformative: the records determine them far better",
    )
    base_iterations: int = numerical(
        30,
        "steps",
        "most steps of the fit of the base to the lowest level",
        "made records",
    )
    beyond_band: float = numerical(
        1.5,
        "of the highest frequency of the band",
        "start frequency of the mode that stands for those above the band",
        "made records",
    )
    beyond_gain: float = numerical(
        50.0,
        "chi2 per dof of the mode",
        "drop of chi2 for each coordinate above which a mode beyond the band is kept",
        "far above chance (1 for each coordinate)",
    )
    widening: float = numerical(
        3.0,
        "-",
        "factor on the sd of the fit to the lowest level, whose records the later fits "
        "use once more, and whose correlations the priors leave out",
        "made records",
    )
    frequency_floor: float = numerical(
        0.005,
        "-",
        "smallest prior sd of log frequency: a law may shift the lowest level too",
        "made records: Bouc-Wen at a fiftieth of its level shifts 0.1 %",
    )
    damping_floor: float = numerical(
        0.3,
        "-",
        "smallest prior sd of log damping: micro-slip adds damping at any level",
        "made records",
    )
    shape_floor: float = numerical(
        0.02,
        "of the largest component",
        "smallest prior sd of a shape component",
        "made records; 2 % is that of a good modal test",
    )
    least_periods: float = numerical(
        8.0,
        "periods of a record",
        "frequency below which a measured acceleration is not integrated",
        "noise of the displacement grows with the square of the period",
    )
    lead_periods: int = numerical(
        2,
        "periods",
        "periods of a multisine that are simulated before the one that is scored",
        "a transient from rest decays over them; made records",
    )
    least_repeats: int = numerical(
        3,
        "periods",
        "averaged periods from which their scatter gives the noise",
        "with two, leakage of a transient would count as noise",
    )
    search_effort: float = numerical(
        4.0,
        "of the limit of hits",
        "predicted samples after which no further effect is searched for",
        "the single laws of a wing with seven levels take all that hits are given; its "
        "pair of friction and clearance took half as much again",
    )
    kept_forces: int = numerical(
        8,
        "sets",
        "sets of port forces along the measured motion that are kept: they do not "
        "depend on the base, whose slopes then need no time integration",
        "memory; a descent needs one for each parameter of its laws and one more",
    )


MODAL = ModalBenchSettings()
