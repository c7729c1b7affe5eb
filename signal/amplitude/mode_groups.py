# SPDX-License-Identifier: MIT
"""Which poles of a linear fit may be one mode, and the band in which to find out.

A mode that softens with amplitude is more than one pole to a linear estimator: a narrow
one from the tails, broader ones below it from the large-amplitude starts.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.signal.amplitude.band_fit import Band
from jointbench.signal.modal.modal_model import ModalModel

# Poles this close to a stronger one may belong to it: share of the frequency, and
# halves of its half-power width.
_CLOSE, _CLOSE_WIDTHS = 0.07, 8.0
# A band reaches this many halves of the half-power width beyond its poles, and at
# least this many where a stronger neighbour cuts it.
_REACH, _LEAST_REACH = 14.0, 5.0
# A wide band reaches this share of the frequency beyond its poles: where damping grows
# with amplitude, hard decays are broader than the poles (docs/decisions/0191).
_WIDE_SHARE = 0.25
# Neighbours whose flanks are taken along: within this many bandwidths, at most so many.
_FLANK, _MOST_BESIDE = 2.0, 3
# A pole broader than this is background, not a neighbour.
_BROAD = 0.03
_MOST_TOGETHER = 4
# A companion of a stronger pole: its shape, its distance in half-power half widths, how
# much broader and how much weaker it is.
_SAME_SHAPE, _OVERLAP, _BROADER, _WEAKER = 0.9, 3.0, 1.5, 0.3


@dataclass(frozen=True, slots=True)
class ModeGroup:
    """Poles that are looked at together.

    Attributes:
        members: indices into the modes, strongest first.
        low: of the band [Hz].
        high: of the band [Hz].
        beside: poles outside whose flanks reach in [rad/s].
        wide: lowest and highest frequency of the wide band [Hz].
    """

    members: tuple[int, ...]
    low: float
    high: float
    beside: tuple[complex, ...]
    wide: tuple[float, float]

    def band(self, model: ModalModel, count: int, *, wide: bool = False) -> Band:
        """Return the band, or the wide one, with the `count` strongest members."""
        poles = model.poles
        chosen = sorted(self.members[:count])
        low, high = self.wide if wide else (self.low, self.high)
        return Band(
            low,
            high,
            tuple(complex(poles[i]) for i in chosen),
            self.beside,
            # That of the strongest member, so that all fits see the same lines.
            float(-poles[self.members[0]].real),
        )


def mode_groups(model: ModalModel) -> tuple[ModeGroup, ...]:
    """Sort the modes of a linear fit into groups, strongest first in each.

    Args:
        model: of the linear fit.

    Returns:
        Groups by descending strength; every mode is in one of them.
    """
    frequency, ratio = model.natural_frequency, model.damping_ratio
    strength = _strength(model)
    left = np.ones(frequency.size, bool)
    heads: list[IntArray] = []
    for head in np.argsort(-strength):
        if not left[head]:
            continue
        near = np.maximum(
            _CLOSE * frequency[head], _CLOSE_WIDTHS * ratio[head] * frequency[head]
        )
        close = left & (np.abs(frequency - frequency[head]) < near)
        members = np.flatnonzero(close)
        members = members[np.argsort(-strength[members])][:_MOST_TOGETHER]
        left[members] = False
        heads.append(np.asarray(members))
    return tuple(_group(model, members, strength, heads) for members in heads)


def _strength(model: ModalModel) -> FloatArray:
    """Return how much each pole explains, narrow ones first."""
    significance = np.nan_to_num(model.significance, nan=1.0)
    return np.asarray(significance / np.maximum(model.damping_ratio, 1e-6))


def _group(
    model: ModalModel,
    members: IntArray,
    strength: FloatArray,
    every: list[IntArray],
) -> ModeGroup:
    frequency, ratio = model.natural_frequency, model.damping_ratio
    width = float(ratio[members[0]] * frequency[members[0]])
    own = frequency[members]
    heads = np.array([m[0] for m in every if m[0] != members[0]], int)
    strong = heads[strength[heads] > 1e-3 * strength[members[0]]]
    cuts = frequency[strong]
    low, high = _reached(own, _REACH * width, width, cuts)
    wide = _reached(own, max(_REACH * width, _WIDE_SHARE * own[0]), width, cuts)
    span = high - low
    gap = np.maximum(low - frequency[heads], frequency[heads] - high)
    flank = heads[(gap < _FLANK * span) & (ratio[heads] < _BROAD)]
    flank = flank[np.argsort(-strength[flank])][:_MOST_BESIDE]
    return ModeGroup(
        members=tuple(int(i) for i in members),
        low=float(low),
        high=float(high),
        beside=tuple(complex(p) for p in model.poles[flank]),
        wide=wide,
    )


def _reached(
    own: FloatArray, reach: float, width: float, cuts: FloatArray
) -> tuple[float, float]:
    """Return the ends of a band [Hz].

    Args:
        own: frequencies of its poles, the strongest first [Hz].
        reach: beyond them [Hz].
        width: half the half-power width of the strongest [Hz].
        cuts: frequencies of strong neighbours, half-way to which a band ends [Hz].
    """
    low, high = own.min() - reach, own.max() + reach
    for other in cuts:
        middle = 0.5 * (other + own[0])
        if low < other < own[0]:
            low = min(middle, own.min() - _LEAST_REACH * width)
        if own[0] < other < high:
            high = max(middle, own.max() + _LEAST_REACH * width)
    return float(max(low, 0.3 * own.min())), float(high)


def without_companions(model: ModalModel, group: ModeGroup) -> ModeGroup:
    """Leave out the poles that only patch up a stronger one which is not linear.

    A companion overlaps the strongest pole, is broader and weaker, and has its shape.
    A real neighbour of that kind cannot be distinguished from it; so this is tested
    only where hard and soft hits disagree.

    Args:
        model: of the linear fit.
        group: with its strongest member first.

    Returns:
        The group without them, its band unchanged.
    """
    head = group.members[0]
    frequency, ratio = model.natural_frequency, model.damping_ratio
    shapes = model.shapes / np.linalg.norm(model.shapes, axis=1)[:, None]
    alike = np.abs(shapes.conj() @ shapes[head]) ** 2 > _SAME_SHAPE
    strength = _strength(model)
    overlap = np.abs(frequency - frequency[head]) < _OVERLAP * ratio * frequency
    companion = alike & overlap & (ratio > _BROADER * ratio[head])
    companion &= strength < _WEAKER * strength[head]
    kept = tuple(i for i in group.members if i == head or not companion[i])
    return replace(group, members=kept)
