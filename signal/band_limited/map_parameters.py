# SPDX-License-Identifier: MIT
"""Places of the parameters of a map in a vector.

They are ln level, H, ln roll-off [samples], blur [samples^2], noise over the largest
possible, ln ratio along over across, angle [rad] and e, see `LaySpectrum`.
"""

LEVEL, HURST, ROLL_OFF, BLUR, NOISE, RATIO, ANGLE, SKEW = range(8)
