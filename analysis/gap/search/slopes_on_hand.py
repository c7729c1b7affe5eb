# SPDX-License-Identifier: MIT
"""Slopes that one fit leaves to the next."""

from jointbench.analysis.gap.residuals.slopes import SlopeArray


class SlopesOnHand:
    """Slopes that one fit leaves to the next, which alone keeps them.

    They are the largest array of a fit, and are dropped when others take their place.
    """

    def __init__(self, slopes: SlopeArray) -> None:
        """Hold the slopes, shape (n_rows, n)."""
        self._held: list[SlopeArray] = [slopes]

    def taken(self) -> SlopeArray:
        """Return the slopes and forget them."""
        return self._held.pop()
