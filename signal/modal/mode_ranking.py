# SPDX-License-Identifier: MIT
"""How sure each mode is, and how much of its uncertainty is no noise.

Two things make a mode doubtful: it stands still at few model orders, and its damping is
hardly known. Confidence is the product of both on scales from 0 to 1. What the model
misses around a mode is not random: more hits would not lessen it, so it is given apart.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, IntArray, freeze
from jointbench.signal.modal.modal_model import ModalModel

FEW_ORDERS = 0.25
"""Share of the orders below which a mode is shown apart [-]."""
_SURE, _DOUBTFUL = 0.4, 0.2
"""Confidence from which a mode is sure, and below which it is doubtful [-]."""
_BROAD = 10.0
"""Damping over the median of all modes from which a pole may be background [-]."""
_VAGUE = 1.0 / 3.0
"""Relative sd of damping at which selection gives a mode up [-]."""


class Grade(StrEnum):
    """How far a mode can be relied on."""

    SURE = "sure"
    FAIR = "fair"
    DOUBTFUL = "doubtful"


@dataclass(frozen=True, slots=True, eq=False)
class ModeConfidence:
    """What speaks for each mode.

    Attributes:
        share: of the orders at which it was stable [-], shape (n_modes,).
        confidence: from 0, doubtful, to 1, sure [-], shape (n_modes,).
        rank: 1 for the surest, shape (n_modes,).
        grades: in words.
        broad: True where the damping is ten times that of the usual mode, so that the
            pole may stand for a background; never sure, shape (n_modes,).
        frequency_error: systematic part of the sd of the natural frequency [Hz], shape
            (n_modes,).
        damping_error: that of the damping ratio [-], shape (n_modes,).
    """

    share: FloatArray
    confidence: FloatArray
    rank: IntArray
    grades: tuple[Grade, ...]
    broad: BoolArray
    frequency_error: FloatArray
    damping_error: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "share", "confidence", "rank", "broad")
        freeze(self, "frequency_error", "damping_error")


def rate_modes(model: ModalModel, orders: int) -> ModeConfidence:
    """Rate the modes of a model.

    Args:
        model: the modes.
        orders: how many were fitted.

    Returns:
        Share of orders times 1 - 3 sd / value of the damping ratio, which is 0 where
        selection would give the mode up. The systematic part of an sd is what noise
        does not explain: sd sqrt(1 - 1 / misfit).
    """
    share = np.clip(model.stable_orders / max(orders, 1), 0.0, 1.0)
    vague = model.damping_ratio_sd / np.abs(model.damping_ratio) / _VAGUE
    confidence = share * np.clip(1.0 - vague, 0.0, 1.0)
    broad = np.asarray(model.damping_ratio > _BROAD * np.median(model.damping_ratio))
    rank = np.empty(confidence.size, np.int64)
    rank[np.argsort(-confidence, kind="stable")] = np.arange(1, confidence.size + 1)
    beyond_noise = np.sqrt(1.0 - 1.0 / np.maximum(model.misfit, 1.0))
    return ModeConfidence(
        share=share,
        confidence=confidence,
        rank=rank,
        grades=tuple(map(_grade, share, confidence, broad)),
        broad=broad,
        frequency_error=model.frequency_sd * beyond_noise,
        damping_error=model.damping_ratio_sd * beyond_noise,
    )


def _grade(share: float, confidence: float, broad: bool) -> Grade:
    if share < FEW_ORDERS or confidence < _DOUBTFUL:
        return Grade.DOUBTFUL
    return Grade.SURE if confidence >= _SURE and not broad else Grade.FAIR
