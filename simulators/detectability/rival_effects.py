# SPDX-License-Identifier: MIT
"""Small catalogue effects on a coarse grid of shapes: the rivals of a hidden one."""

from collections.abc import Mapping
from itertools import product

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.hidden.effect_draws import Scales
from jointbench.simulators.hidden.hidden_effects import HiddenEffect
from jointbench.simulators.hidden.sensor_faults import ALL_CHANNELS

# Small enough to change the responses in proportion, large enough for differences.
_SMALL = 1e-5

# Parameters that an analyst would fit, size first.
_FREE: Mapping[str, tuple[str, ...]] = {
    "cubic_stiffness": ("k3",),
    "quadratic_stiffness": ("k2",),
    "gap": ("k", "g"),
    "jenkins": ("kt", "Fs"),
    "iwan": ("kt", "phimax", "chi"),
    # zy absorbs b: only their ratio to g matters.
    "bouc_wen": ("k", "zy", "n", "g"),
    "coulomb": ("Fc",),
    "quadratic_damping": ("c",),
    "maxwell": ("k", "tau"),
    "extra_damping": ("c",),
    "added_mass": ("m",),
    "hidden_mode": ("m", "k", "c"),
    "preload_stiffness": ("n",),
    "preload_damping": ("n",),
    "loosening": ("frac",),
    "cross_talk": ("frac",),
    "delay": ("tau",),
    "gain_error": ("frac",),
    "sensor_lowpass": ("fc",),
}
# n, b, g; the last is a Jenkins slider with a corner.
_BOUC_WEN = ((1.0, 0.6, -0.2), (1.0, 0.6, 0.2), (5.0, 0.5, 0.5))
_SIGNED = frozenset(
    (
        *("cubic_stiffness", "quadratic_stiffness", "gap", "loosening", "delay"),
        *("preload_stiffness", "preload_damping", "cross_talk", "gain_error"),
    )
)


def rival_effects(scales: Scales, *, shared: bool = False) -> list[HiddenEffect]:
    """Return small effects whose responses span those of each rival.

    Args:
        scales: of the specimen.
        shared: whether delay and low pass of all channels together are rivals as well.

    Returns:
        Effects; those of one name and site differ in shape only.
    """
    return [
        *_elastic(scales),
        *_frictional(scales),
        *_viscous(scales),
        *_masses(scales),
        *_by_record(),
        *_sensors(),
        *(_shared_faults() if shared else []),
    ]


def may_turn(name: str) -> bool:
    """Return whether a rival of negative size is physical."""
    return name in _SIGNED


def free_count(rival: HiddenEffect) -> int:
    """Return the number of free parameters of a rival."""
    return len(_FREE[rival.name])


def move_rival(rival: HiddenEffect, moves: FloatArray) -> HiddenEffect:
    """Move the free parameters of a rival.

    Args:
        rival: where the moves start.
        moves: changes of the logarithms of its free parameters, and of those that may
            be zero [-], shape (n_free,).

    Returns:
        The moved rival, every parameter within the limits of its law.
    """
    moved = dict(rival.parameters)
    for name, move in zip(_FREE[rival.name], moves, strict=True):
        start, factor = moved[name], float(np.exp(np.clip(move, -30, 30)))
        if name == "chi":
            moved[name] = min((1 + start) * factor, 3.0) - 1
        elif rival.name == "bouc_wen" and name == "g":
            moved[name] = float(np.clip(start + move, -moved["b"], moved["b"]))
        elif rival.name == "bouc_wen" and name == "n":
            moved[name] = float(np.clip(start * factor, 0.5, 6.0))
        else:
            moved[name] = start * factor
    return HiddenEffect(rival.name, moved)


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
                "bouc_wen", {"k": kt, "n": n, "b": b, "g": g, "zy": zy * s.elongation}
            )
            for zy, (n, b, g) in product((0.15, 0.6), _BOUC_WEN)
        ),
        HiddenEffect("coulomb", {"Fc": 0.02 * kt * s.elongation}),
    ]


def _viscous(s: Scales) -> list[HiddenEffect]:
    return [
        HiddenEffect("quadratic_damping", {"c": 20 * _SMALL * s.cj / s.rate}),
        *(
            HiddenEffect("maxwell", {"k": _SMALL * s.kj, "tau": tau})
            for tau in (1e-4, 4e-4)
        ),
        HiddenEffect("extra_damping", {"c": 20 * _SMALL * s.cj}),
    ]


def _masses(s: Scales) -> list[HiddenEffect]:
    first, second = s.frequency
    modes = (0.7 * first, 1.3 * first, 0.8 * second, 1.2 * second, 2.5 * second)
    rivals = [
        HiddenEffect("added_mass", {"m": 2 * _SMALL, "dof": d}) for d in (0.0, 1.0)
    ]
    for dof, frequency in product((0.0, 1.0), modes):
        mass, omega = _SMALL, 2 * np.pi * frequency
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
        HiddenEffect("preload_damping", {"n": 10 * _SMALL}),
        HiddenEffect("loosening", {"frac": _SMALL}),
    ]


def _sensors() -> list[HiddenEffect]:
    return [
        HiddenEffect("cross_talk", {"frac": _SMALL}),
        *(
            HiddenEffect(name, {parameter: value, "dof": dof})
            for dof in (0.0, 1.0)
            for name, parameter, value in (
                ("delay", "tau", 2e-4 * _SMALL),
                ("gain_error", "frac", _SMALL),
                ("sensor_lowpass", "fc", 800 / _SMALL),
            )
        ),
    ]


def _shared_faults() -> list[HiddenEffect]:
    """Return faults of all channels; a gain of all is that of the force."""
    return [
        HiddenEffect("delay", {"tau": 2e-4 * _SMALL, "dof": ALL_CHANNELS}),
        HiddenEffect("sensor_lowpass", {"fc": 800 / _SMALL, "dof": ALL_CHANNELS}),
    ]
