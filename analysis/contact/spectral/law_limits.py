# SPDX-License-Identifier: MIT
"""Ranges and accuracy of the laws of measured surfaces, set by boundary elements.

The numbers are from 11 surfaces of 256 x 256 points at loads of 1e-4 to 0.6 E* times
rms gradient (seeds 100 to 110 of tamaas's generator); docs/contact-measured-surfaces.md
has the count on other ones.
"""

PERSSON_SD = 0.07
"""Standard deviation of ln k of Persson's law within its range [-]: 0.05 scatter and
0.04 offset at 19 states."""
SUMMIT_SD = 0.12
"""The same of laws of summits [-]: 0.08 scatter, 0.08 offset."""
FEWEST_CONTACTS = 50.0
"""Summits in contact from which a law of many applies [-]: at 40 the boundary elements
are up to 1.35 times stiffer than Persson's law, at 90 up to 1.1 times."""
FINITE_SIZE_CONTACTS = 18.0
"""Summits in contact below which stiffness follows the power law of one hill [-]: 10 to
27 by surface, bands of 2 to 32."""
CONTACT_SCATTER = 1.2
"""Variance of ln k by which few contacts scatter, times their number [-]."""
FINEST_OF_HILL = 32.0
"""Mean wavelength over the shortest wave whose summits are counted [-]: the widest band
that the boundary elements had. Summits of finer waves share their hills."""
FEWEST_HILLS = 10.0
"""Apparent area over the square of the mean wavelength from which a surface is a sample
of its spectrum [-]: with 2 and 7 single states are off by up to 40 %."""
HILL_SCATTER = 0.12
"""Variance of ln k by which few hills scatter, times their number [-]."""
HIGHEST_LOAD = 0.5
"""Highest p / (E* h') of Persson's law [-]: beyond, grids do not resolve what is left
of the gap."""
HIGHEST_SUMMIT_LOAD = 0.005
"""Highest p / (E* h') of summits that do not interact [-]: at 0.01 the boundary
elements are up to 1.3 times stiffer."""
LOWEST_SEPARATION = 1.5
"""Least separation of the mean planes over the rms height for summits [-]: below,
neighbours merge."""
PLASTIC = 1.0
"""Plasticity index above which summits yield [-]: Greenwood and Williamson 1966."""
FULL_YIELD = 0.2
"""Highest p / H at which the flattening of yielded waves is meant [-]."""
MOST_STIFFENING = 1.5
"""Highest stiffness over that without yielding to which yielded waves may be flattened
[-]: beyond, the longest waves yield, and Persson's law has no form for it."""
PLASTIC_SLOPE = 3.0
"""E* times mean absolute slope over hardness from which contacts are plastic [-]:
Mikic, Int. J. Heat Mass Transf. 17 (1974) 205."""
PLASTIC_SD = 0.25
"""Standard deviation of ln k of plastic contact [-]: measured thermal conductances
scatter by it about the same law; no boundary elements have judged it."""
SKEWED = 0.5
"""Skewness of the heights beyond which they are not normal [-]: a surface whose hills
were cut off at one standard deviation has -0.7."""
PEAKED = 1.0
"""The same of the excess kurtosis [-]."""
