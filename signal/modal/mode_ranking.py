# SPDX-License-Identifier: MIT
"""Confidence in each mode, and the systematic part of its uncertainty.

A mode is doubtful if it is stable at few model orders or its damping is uncertain.
Confidence is the product of both on scales from 0 to 1. The model error around a mode
is not random: more hits would not reduce it, so it is reported separately.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, IntArray, freeze
from jointbench.signal.modal.modal_model import ModalModel

FEW_ORDERS = 0.25
"""Share of the orders below which a mode is listed separately [-]."""
_SURE, _DOUBTFUL = 0.4, 0.2
"""Least confidence of a reliable mode, and of one that is not doubtful [-]."""
_BROAD = 10.0
"""Damping over the median of all modes above which a pole may be background [-]."""
_VAGUE = 1.0 / 3.0
"""Relative sd of damping at which selection drops a mode [-]."""


class Grade(StrEnum):
    """Reliability of a mode."""

    SURE = "sure"
    FAIR = "fair"
    DOUBTFUL = "doubtful"


@dataclass(frozen=True, slots=True, eq=False)
class ModeConfidence:
    """Confidence in each mode, with its parts.

    Attributes:
        share: of the orders at which it was stable [-], shape (n_modes,).
        confidence: from 0, doubtful, to 1, reliable [-], shape (n_modes,).
        rank: 1 for the highest confidence, shape (n_modes,).
        grades: reliability of each.
        broad: True where the damping is ten times the median, so that the pole may
            represent a background; never reliable, shape (n_modes,).
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
        selection would drop the mode. The systematic part of an sd is what noise does
        not explain: sd sqrt(1 - 1 / residual_ratio).
    """
    share = np.clip(model.stable_orders / max(orders, 1), 0.0, 1.0)
    vague = model.damping_ratio_sd / np.abs(model.damping_ratio) / _VAGUE
    confidence = share * np.clip(1.0 - vague, 0.0, 1.0)
    broad = np.asarray(model.damping_ratio > _BROAD * np.median(model.damping_ratio))
    rank = np.empty(confidence.size, np.int64)
    rank[np.argsort(-confidence, kind="stable")] = np.arange(1, confidence.size + 1)
    beyond_noise = np.sqrt(1.0 - 1.0 / np.maximum(model.residual_ratio, 1.0))
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
