# SPDX-License-Identifier: MIT
"""Settings of the catalogue: shapes of its laws that are not fitted."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class CatalogueSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    segalman_sliders: tuple[int, float] = numerical(
        (32, 0.003),
        "sliders, of phimax",
        "sliders of the four-parameter Iwan element, spaced by a constant ratio down "
        "to this slip displacement",
        "closed forms of force and dissipation: within 0.05 % and 0.4 % from 0.03 to "
        "1.5 of phimax",
    )
    segalman_sharpness: float = numerical(
        30.0,
        "-",
        "sharpness of its sliders, which are ideal in the paper",
        "the same",
    )
    damping_reference_speed: float = numerical(
        0.01,
        "m/s",
        "speed at which the amplitude of a power law of damping is its force",
        "middle of the speeds at joints under hammer hits; it only decorrelates "
        "force and power",
    )
    iwan_sliders: int = numerical(
        14,
        "sliders",
        "sliders of the Iwan element of the catalogue",
        "development cases 26 and 50: 4e-5 of the excess of an element with more "
        "sliders remains",
    )
    slider_sharpness: tuple[float, float] = numerical(
        (14.0, 0.6),
        "-",
        "median and log-sd of the prior of the sharpness of a slider",
    )
    relaxation_times: tuple[float, float, float] = numerical(
        (0.03, 0.16, 0.8),
        "periods",
        "relaxation times of the probes, in periods of the mode of the joint",
        "one per factor of five over the range of a record",
    )


CATALOGUE_SETTINGS = CatalogueSettings()
