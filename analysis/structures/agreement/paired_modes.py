# SPDX-License-Identifier: MIT
"""Measured and computed modes beside each other: pairs, MAC, CoMAC, differences."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.analysis.structures.identification.structure_evidence import mac

# A pair is one mode if its MAC is above this ...
_SAME_SHAPE = 0.5
# ... or, with too few outputs for shapes, if its frequencies are as near as this in ln.
_SAME_FREQUENCY = 0.1
# Weight of ln frequency against the MAC of a pair.
_FREQUENCY_WEIGHT = 0.5
# Half width of a 95 % interval in standard deviations.
_INTERVAL = 1.96


@dataclass(frozen=True, slots=True, eq=False)
class ModeSet:
    """Modes at the same outputs and inputs, measured or computed.

    Attributes:
        frequency: [Hz], shape (n_modes,), ascending.
        frequency_sd: [Hz], shape (n_modes,).
        damping: ratio [-], shape (n_modes,).
        damping_sd: [-], shape (n_modes,).
        shapes: at the outputs, of any scale, shape (n_modes, n_outputs).
        constants: modal constants phi_o phi_i of the receptance [1/kg], shape (n_modes,
            n_outputs, n_inputs).
        constants_sd: [1/kg], same shape.
    """

    frequency: FloatArray
    frequency_sd: FloatArray
    damping: FloatArray
    damping_sd: FloatArray
    shapes: ComplexArray
    constants: FloatArray
    constants_sd: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "frequency_sd", "damping", "damping_sd")
        freeze(self, "shapes", "constants", "constants_sd")


@dataclass(frozen=True, slots=True)
class ModeDifference:
    """One measured mode and its computed partner.

    Attributes:
        measured: number among the measured modes, from 0.
        computed: number among the computed ones, from 0.
        mac: of their shapes [-].
        frequency: computed over measured, minus 1 [-].
        frequency_interval: of 95 % [-].
        damping: computed minus measured ratio [-].
        damping_interval: of 95 % [-].
    """

    measured: int
    computed: int
    mac: float
    frequency: float
    frequency_interval: tuple[float, float]
    damping: float
    damping_interval: tuple[float, float]


def pair_mode_sets(
    measured: ModeSet, computed: ModeSet
) -> tuple[tuple[ModeDifference, ...], FloatArray]:
    """Pair measured with computed modes.

    Args:
        measured: modes.
        computed: modes at the same outputs.

    Returns:
        Pairs in the order of the measured frequencies, and the MAC of all, shape
        (n_measured, n_computed). Modes without a partner are in no pair.

    Source:
        Allemang and Brown 1982, Proc. 1st IMAC, 110-116 (MAC).
    """
    likeness = mac(measured.shapes, computed.shapes)
    apart = np.abs(np.log(measured.frequency[:, None] / computed.frequency))
    several = measured.shapes.shape[1] > 1
    cost = _FREQUENCY_WEIGHT * np.minimum(apart, 2.0)
    if several:
        cost = cost + 1.0 - likeness
    rows, columns = linear_sum_assignment(cost)
    kept = (likeness[rows, columns] > _SAME_SHAPE) if several else True
    kept = kept & (apart[rows, columns] < (1.0 if several else _SAME_FREQUENCY))
    pairs = [
        _difference(measured, computed, int(i), int(j), float(likeness[i, j]))
        for i, j, good in zip(rows, columns, kept, strict=True)
        if good
    ]
    return tuple(sorted(pairs, key=lambda one: one.measured)), likeness


def comac(measured: ComplexArray, computed: ComplexArray) -> FloatArray:
    """Return the coordinate MAC of each output over paired modes [-].

    Args:
        measured: shapes, shape (n_pairs, n_outputs), of any scale.
        computed: likewise; each mode counts alike.

    Source:
        Lieven and Ewins 1988, Proc. 6th IMAC, 690-695.
    """
    measured, computed = _unit(measured), _unit(computed)
    crossed = np.sum(np.abs(measured * computed.conj()), axis=0) ** 2
    size = np.sum(np.abs(measured) ** 2, axis=0) * np.sum(np.abs(computed) ** 2, axis=0)
    return np.asarray(crossed / np.maximum(size, 1e-300))


def _unit(shapes: ComplexArray) -> ComplexArray:
    size = np.linalg.norm(shapes, axis=1, keepdims=True)
    return np.asarray(shapes / np.maximum(size, 1e-300))


def enhanced_comac(measured: ComplexArray, computed: ComplexArray) -> FloatArray:
    """Return the enhanced coordinate MAC: 0 where shapes agree, sign included [-].

    Args:
        measured: shapes, shape (n_pairs, n_outputs).
        computed: likewise; each is scaled to fit.

    Source:
        Hunt 1992, Sound and Vibration 26(8), 42-46.
    """
    scale = np.sum(computed.conj() * measured, axis=1)
    scale = scale / np.maximum(np.sum(np.abs(computed) ** 2, axis=1), 1e-300)
    largest = np.maximum(np.abs(measured).max(axis=1), 1e-300)[:, None]
    apart = np.abs(measured - scale[:, None] * computed) / largest
    return np.asarray(apart.mean(axis=0) / 2.0)


def frac(measured: ComplexArray, computed: ComplexArray) -> FloatArray:
    """Return the frequency response assurance criterion of each pair of points [-].

    Args:
        measured: FRFs, shape (n_outputs, n_inputs, n_lines).
        computed: likewise, at the same lines.

    Source:
        Heylen and Lammens 1996, Proc. Int. Conf. on Identification, Swansea, 48-55.
    """
    crossed = np.abs(np.sum(measured * computed.conj(), axis=-1)) ** 2
    size = np.sum(np.abs(measured) ** 2, axis=-1)
    size = size * np.sum(np.abs(computed) ** 2, axis=-1)
    return np.asarray(crossed / np.maximum(size, 1e-300))


def unpaired(pairs: tuple[ModeDifference, ...], count: int, side: str) -> IntArray:
    """Return the numbers of the modes of one side, "measured" or "computed", left."""
    taken = [getattr(one, side) for one in pairs]
    return np.setdiff1d(np.arange(count), taken)


def _difference(
    measured: ModeSet, computed: ModeSet, i: int, j: int, likeness: float
) -> ModeDifference:
    ratio = float(computed.frequency[j] / measured.frequency[i] - 1.0)
    sd = np.hypot(measured.frequency_sd[i], computed.frequency_sd[j])
    wide = _INTERVAL * float(sd / measured.frequency[i])
    damping = float(computed.damping[j] - measured.damping[i])
    loose = _INTERVAL * float(np.hypot(measured.damping_sd[i], computed.damping_sd[j]))
    return ModeDifference(
        i,
        j,
        likeness,
        ratio,
        (ratio - wide, ratio + wide),
        damping,
        (damping - loose, damping + loose),
    )
