# SPDX-License-Identifier: MIT
"""Slopes that one fit leaves to the next."""

from jointbench.acquisition.basics.arrays import FloatArray


class SlopesOnHand:
    """Slopes that one fit leaves to the next, which alone keeps them.

    They are the largest array of a fit, and are dropped when others take their place.
    """

    def __init__(self, slopes: FloatArray) -> None:
        """Hold the slopes, shape (n_rows, n)."""
        self._held: list[FloatArray] = [slopes]

    def taken(self) -> FloatArray:
        """Return the slopes and forget them."""
        return self._held.pop()
