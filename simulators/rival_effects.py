# SPDX-License-Identifier: MIT
"""Small catalogue effects on a coarse grid of shapes: the rivals of a hidden one."""

from itertools import product

import numpy as np

from jointbench.simulators.effect_draws import Scales
from jointbench.simulators.hidden_effects import HiddenEffect

# Small enough to change the responses in proportion, large enough for differences.
_SMALL = 1e-3


def rival_effects(scales: Scales) -> list[HiddenEffect]:
    """Return small effects whose responses span what each rival could explain.

    Args:
        scales: of the specimen.

    Returns:
        Effects; those of one name and site differ in shape and belong together.
    """
    return [
        *_elastic(scales),
        *_frictional(scales),
        *_viscous(scales),
        *_masses(scales),
        *_by_record(),
        *_sensors(),
    ]


def _elastic(s: Scales) -> list[HiddenEffect]:
    force = _SMALL * s.kj
    return [
        HiddenEffect("cubic_stiffness", {"k3": force / s.elongation**2}),
        HiddenEffect("quadratic_stiffness", {"k2": force / s.elongation}),
        *(
            HiddenEffect("gap", {"k": force, "g": share * s.elongation})
            for share in (0.1, 0.25, 0.5)
        ),
    ]


def _frictional(s: Scales) -> list[HiddenEffect]:
    kt = _SMALL * s.kj
    return [
        *(
            HiddenEffect(
                "jenkins", {"kt": kt, "Fs": kt * x * s.elongation, "sharpness": 13.0}
            )
            for x in (0.06, 0.15, 0.35, 0.7)
        ),
        *(
            HiddenEffect(
                "iwan",
                {
                    "kt": kt,
                    "phimax": phimax * s.elongation,
                    "chi": chi,
                    "sharpness": 13.0,
                    "sliders": 8.0,
                },
            )
            for phimax, chi in product((0.4, 1.5), (-0.6, -0.1))
        ),
        *(
            HiddenEffect(
                "bouc_wen",
                {"k": kt, "n": 1.0, "b": 0.6, "g": g, "zy": zy * s.elongation},
            )
            for zy, g in product((0.15, 0.6), (-0.2, 0.2))
        ),
        HiddenEffect("coulomb", {"Fc": 0.02 * kt * s.elongation}),
    ]


def _viscous(s: Scales) -> list[HiddenEffect]:
    return [
        HiddenEffect("quadratic_damping", {"c": 0.02 * s.cj / s.rate}),
        *(
            HiddenEffect("maxwell", {"k": _SMALL * s.kj, "tau": tau})
            for tau in (1e-4, 4e-4)
        ),
        HiddenEffect("extra_damping", {"c": 0.02 * s.cj}),
    ]


def _masses(s: Scales) -> list[HiddenEffect]:
    first, second = s.frequency
    modes = (0.7 * first, 1.3 * first, 0.8 * second, 1.2 * second, 2.5 * second)
    rivals = [HiddenEffect("added_mass", {"m": 2e-3, "dof": d}) for d in (0.0, 1.0)]
    for dof, frequency in product((0.0, 1.0), modes):
        mass, omega = 1e-3, 2 * np.pi * frequency
        rivals.append(
            HiddenEffect(
                "hidden_mode",
                {
                    "m": mass,
                    "k": mass * omega**2,
                    "c": 0.04 * mass * omega,
                    "dof": dof,
                },
            )
        )
    return rivals


def _by_record() -> list[HiddenEffect]:
    return [
        HiddenEffect("preload_stiffness", {"n": _SMALL}),
        HiddenEffect("preload_damping", {"n": 0.01}),
        HiddenEffect("loosening", {"frac": _SMALL}),
    ]


def _sensors() -> list[HiddenEffect]:
    return [
        HiddenEffect("cross_talk", {"frac": _SMALL}),
        *(
            HiddenEffect(name, {parameter: value, "dof": dof})
            for dof in (0.0, 1.0)
            for name, parameter, value in (
                ("delay", "tau", 2e-7),
                ("gain_error", "frac", _SMALL),
                ("sensor_lowpass", "fc", 8e5),
            )
        ),
    ]
