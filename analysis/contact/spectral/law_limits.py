# SPDX-License-Identifier: MIT
"""Ranges and accuracy of the laws of measured surfaces, set by boundary elements.

The numbers are from 11 surfaces of 256 x 256 points at loads of 1e-4 to 0.6 E* times
rms gradient (seeds 100 to 110 of tamaas's generator); docs/contact-measured-surfaces.md
has the count on other ones.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LawLimits:
    """Numbers of the ranges and intervals of the laws.

    Attributes:
        persson_sd: standard deviation of ln k of Persson's law within its range [-]:
            0.05 scatter and 0.04 offset at 19 states.
        summit_sd: the same of laws of summits [-]: 0.08 scatter, 0.08 offset.
        fewest_contacts: summits in contact from which a law of many applies [-]: at 40
            to 70 the boundary elements are up to 1.3 times stiffer than Persson's law,
            1.1 times on average (18 states of 30 further surfaces).
        finite_size_contacts: summits in contact below which stiffness follows the power
            law of one hill [-]: 10 to 27 by surface, bands of 2 to 32.
        contact_scatter: variance of ln k by which few contacts scatter, times their
            number [-].
        finest_of_hill: mean wavelength over the shortest wave whose summits are counted
            [-]: the widest band that the boundary elements had. Summits of finer waves
            share their hills.
        fewest_hills: apparent area over the square of the mean wavelength from which a
            surface is a sample of its spectrum [-]: with 2 and 7 single states are off
            by up to 40 %.
        hill_scatter: variance of ln k by which few hills scatter, times their number
            [-].
        highest_load: highest p / (E* h') of Persson's law [-]: beyond, grids do not
            resolve what is left of the gap.
        highest_summit_load: highest p / (E* h') of summits that do not interact [-]: at
            0.01 the boundary elements are up to 1.3 times stiffer.
        lowest_separation: least separation of the mean planes over the rms height for
            summits [-]: below, neighbours merge.
        plastic: plasticity index above which summits yield [-]: Greenwood and
            Williamson 1966.
        full_yield: highest p / H at which the flattening of yielded waves is meant [-].
        most_stiffening: highest stiffness over that without yielding to which yielded
            waves may be flattened [-]: beyond, the longest waves yield, and Persson's
            law has no form for it.
        plastic_slope: E* times mean absolute slope over hardness from which contacts
            are plastic [-]: Mikic, Int. J. Heat Mass Transf. 17 (1974) 205.
        plastic_sd: standard deviation of ln k of plastic contact [-]: measured thermal
            conductances scatter by it about the same law; no boundary elements have
            judged it.
        skewed: skewness of the heights beyond which they are not normal [-]: a surface
            whose hills were cut off at one standard deviation has -0.7.
        peaked: the same of the excess kurtosis [-].
    """

    persson_sd: float = 0.07
    summit_sd: float = 0.12
    fewest_contacts: float = 70.0
    finite_size_contacts: float = 18.0
    contact_scatter: float = 1.2
    finest_of_hill: float = 32.0
    fewest_hills: float = 10.0
    hill_scatter: float = 0.12
    highest_load: float = 0.5
    highest_summit_load: float = 0.005
    lowest_separation: float = 1.5
    plastic: float = 1.0
    full_yield: float = 0.2
    most_stiffening: float = 1.5
    plastic_slope: float = 3.0
    plastic_sd: float = 0.25
    skewed: float = 0.5
    peaked: float = 1.0


LIMITS = LawLimits()
