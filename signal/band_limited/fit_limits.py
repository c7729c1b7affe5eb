# SPDX-License-Identifier: MIT
"""Limits of the verdicts on band-limited surfaces, of lines and of maps."""

SATURATED_RATIO = 5.41
"""Twice the gain in log-likelihood by a roll-off above which it is named: a level of
1 % for a parameter at the end of its range [-]."""
BEYOND_RATIO = 3.84
"""The same for the limit that a roll-off is beyond [-]: the lower end of an interval of
95 % whose upper end is open. With 95 % on one side alone, 2.71, the intervals of named
and of open roll-offs together would cover 92.5 %."""
REJECTED = 3.1
"""Standard deviations of the deviance above which a model is rejected [-]: 0.1 %."""
WIDEST_TOLERANCE = 0.3
"""Widest tolerance of ln density of a self-affine surface [-]: a spectrum within 30 %
of a power law at every wavelength."""
LEAST_HURST = 0.03
"""H at or below which heights are unrelated, or noise [-]."""
OTHER_FORM = "the spectrum differs from every one with a roll-off and a short cut"
