# SPDX-License-Identifier: MIT
"""What the errors of Fig. 9 (Appl. Sci. 2025, 15, 9040) ask of the models' ratios.

They are printed without a sign. Whether a model lies below or above the test decides
which ratio of two models its error asks for.
"""

import math

import numpy as np
from claim import between

from jointbench.acquisition.basics.arrays import FloatArray

ERRORS = {"2D": 0.62966, "3D": 0.2521, "modified": 0.1597}
"""Mean relative error of the stiffness over three torques [-]."""
SIDES = {"low": -1, "high": 1}
_LOW, _HIGH = ("low", "low"), ("high", "high")
_MIXED = (("high", "low"), ("low", "high"))


def asked(first: str, second: str) -> dict[tuple[str, str], float]:
    """Return what the printed errors ask of a ratio of two models, by their sides.

    Args:
        first: model above the line.
        second: model below it.

    Returns:
        K of the first over K of the second [-], by the sides of the test that (first,
        second) lie on. The averages are taken for the errors at each torque.
    """
    return {
        (one, other): (1 + SIDES[one] * ERRORS[first])
        / (1 + SIDES[other] * ERRORS[second])
        for one in SIDES
        for other in SIDES
    }


def what_errors_ask(spatial: FloatArray, modified: FloatArray) -> str:
    """Compare what the errors ask for, by sign, with what the models give.

    Args:
        spatial: 3D over 2D as computed [-], shape (n_hardness,).
        modified: modified 3D over 3D [-], same shape.
    """
    first, second = asked("3D", "2D"), asked("modified", "3D")
    mixed = [" or ".join(f"{one[k]:.2f}" for k in _MIXED) for one in (first, second)]
    agrees = math.ceil(100 * float(np.abs(spatial / first[_HIGH] - 1).max()))
    off = [np.abs(modified / value - 1).min() for value in second.values()]
    missed = math.floor(100 * float(min(off)))
    return (
        "The print does not say on which side of the test a model errs. If all err to "
        f"the low side the errors ask 3D/2D = {first[_LOW]:.2f} and modified/3D = "
        f"{second[_LOW]:.2f}, if all to the high side {first[_HIGH]:.3f} and "
        f"{second[_HIGH]:.3f}, with sides mixed {mixed[0]} and {mixed[1]}; the models "
        f"give {between(list(spatial))} and {between(list(modified))}. On the high "
        f"side 3D/2D agrees within {agrees} %; modified/3D is missed by {missed} % or "
        "more whatever the sides"
    )
