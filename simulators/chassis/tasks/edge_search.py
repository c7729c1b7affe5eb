# SPDX-License-Identifier: MIT
"""Analogue triggers: the first sample of a stream that fulfils a condition."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class EdgeSearch:
    """A condition on one channel.

    Attributes:
        channel: index of it; below zero for a digital line, which rises at once.
        level: of an edge, or top of a window [V].
        bottom: of a window [V]; None for an edge.
        rising: direction of the edge, or entering the window.
        hysteresis: below a rising level that arms it [V].
    """

    channel: int
    level: float = 0.0
    bottom: float | None = None
    rising: bool = True
    hysteresis: float = 0.0

    def first(self, volts: FloatArray, *, least: int) -> int | None:
        """Return the index of the first sample that fulfils it, None for none.

        Args:
            volts: samples, shape (n_channels, n).
            least: index before which it is ignored.
        """
        if self.channel < 0:
            return least if volts.shape[1] > least else None
        beyond = self._beyond(volts[self.channel])
        hits = np.flatnonzero(~beyond[:-1] & beyond[1:]) + 1
        hits = hits[hits >= least]
        if self.hysteresis and self.bottom is None:
            hits = self._armed(volts[self.channel], hits)
        return int(hits[0]) if hits.size else None

    def _beyond(
        self, signal: FloatArray
    ) -> "np.ndarray[tuple[int], np.dtype[np.bool]]":
        if self.bottom is not None:
            inside = (signal >= self.bottom) & (signal <= self.level)
            return np.asarray(inside if self.rising else ~inside)
        sign = 1 if self.rising else -1
        return np.asarray(sign * signal >= sign * self.level)

    def _armed(
        self, signal: FloatArray, hits: "np.ndarray[tuple[int], np.dtype[np.intp]]"
    ) -> "np.ndarray[tuple[int], np.dtype[np.intp]]":
        sign = 1 if self.rising else -1
        low = np.flatnonzero(sign * signal <= sign * self.level - self.hysteresis)
        return hits[hits > low[0]] if low.size else hits[:0]
