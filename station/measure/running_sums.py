# SPDX-License-Identifier: MIT
"""Sums over the hits of one point, and the spectra of those that were used last.

A hit is added or taken out in constant time.
"""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.signal.frf.coherence_without import HitSums, coherence_of_each
from jointbench.signal.frf.estimators import pair_of_sums
from jointbench.signal.frf.excited_band import excited_band_of
from jointbench.signal.frf.frf import KIND_OF_RESPONSE, Frf
from jointbench.signal.hits.hit_spectra import HitSpectra
from jointbench.signal.hits.windows import HammerWindow
from jointbench.station.measure.stored_cut import HitCut

MOST_KEPT = 2**25
"""Size of the spectra that are kept [bytes]: 50 hits of four channels and half a second
at 51.2 kS/s. Transforming a further one again takes some milliseconds."""
_LINES = 256
"""Lines by which the hits that may spoil an average are separated from the others: 2 kB
a channel and hit. The median of coherence over them is that over all lines to some
percent of its spread."""
_WORTH_IT = 5
"""Hits of which the coherence without them is computed over all lines."""
_TOGETHER = 64  # hits whose few lines are looked at in one array


class RunningSums:
    """|F|^2, |X|^2 and X F* of each response, summed over hits at one point.

    Taking a hit out leaves the rounding of its terms, 1e-16 of the largest sum.

    Source:
        Bendat and Piersol, Random Data (2010), sec. 5.2 and 6.1.
    """

    def __init__(self, first: HitSpectra, window: HammerWindow) -> None:
        """Begin with the spectra of one hit.

        Args:
            first: of the hit.
            window: that it, and every further hit, is transformed under.
        """
        self.window, self.hits = window, 0
        self._frequency, self._quantity = first.frequency, first.quantity
        self._outputs, self._point = first.labels[0], first.points[0]
        self._force = np.zeros(first.frequency.size)
        self._power = np.zeros(first.response.shape[1:])
        self._cross = np.zeros(first.response.shape[1:], complex)
        self.add(first)

    def add(self, spectra: HitSpectra) -> None:
        """Add a hit."""
        self._change(spectra, 1)

    def take_out(self, spectra: HitSpectra) -> None:
        """Take a hit out that was added."""
        self._change(spectra, -1)

    @property
    def frequency(self) -> FloatArray:
        """Frequency of the lines [Hz]."""
        return self._frequency

    def totals(self) -> HitSums:
        """Return the sums over all hits."""
        return HitSums(self._force, self._power, self._cross)

    def band(self) -> tuple[float, float]:
        """Return the band that the hits excite together [Hz]."""
        return excited_band_of(self._force, self._frequency)

    def frf(self) -> Frf:
        """Return the average as H1, with coherence and variance from two hits on."""
        force = np.maximum(self._force, 0.0)
        safe = np.where(force > 0.0, force, 1.0)
        pairs = []
        for cross, power in zip(self._cross, self._power, strict=True):
            explained = np.abs(cross) ** 2 / safe
            sums = force, power, np.maximum(power - explained, 0.0)
            pairs.append(pair_of_sums(cross / safe, sums, self.hits))
        response = np.array([pair.response for pair in pairs])[:, None]
        coherence = np.array([pair.coherence for pair in pairs])[:, None]
        variance = np.array([pair.variance for pair in pairs])[:, None]
        several = self.hits > 1
        return Frf(
            frequency=self._frequency,
            response=response,
            kind=KIND_OF_RESPONSE[self._quantity],
            coherence=coherence if several else None,
            variance=variance if several else None,
            added_decay_rate=self.window.decay_rate or 0.0,
            outputs=self._outputs,
            inputs=(self._point,),
            averages=self.hits,
            usable_band=self.band(),
        )

    def _change(self, spectra: HitSpectra, sign: int) -> None:
        force, response = spectra.force[0], spectra.response[0]
        self.hits += sign
        self._force += sign * np.abs(force) ** 2
        self._power += sign * np.abs(response) ** 2
        self._cross += sign * (response * force.conj())


class FewLines:
    """A few lines of every hit in the sums: which one, left out, helps the others most.

    The coherence of the others over all lines costs milliseconds a hit; over some
    hundred lines of the band it costs microseconds, and shows as well which hits
    are worth the whole.
    """

    def __init__(self, sums: RunningSums) -> None:
        """Choose the lines, evenly over the band that the first hits excite."""
        low, high = sums.band()
        first, past = np.searchsorted(sums.frequency, (low, high), side="left")
        last = max(int(first), min(int(past), sums.frequency.size - 1))
        chosen = np.linspace(first, last, min(_LINES, last - int(first) + 1))
        self._lines: IntArray = np.unique(np.round(chosen).astype(np.int64))
        self._kept: dict[HitCut, tuple[ComplexArray, ComplexArray]] = {}

    def keep(self, cut: HitCut, spectra: HitSpectra) -> None:
        """Keep the lines of a hit, in single precision."""
        force, response = (
            part[0][..., self._lines].astype(np.complex64)
            for part in (spectra.force, spectra.response)
        )
        self._kept[cut] = force, response

    def drop(self, cut: HitCut) -> None:
        """Forget a hit."""
        self._kept.pop(cut, None)

    def most_likely(self, cuts: Sequence[HitCut], sums: RunningSums) -> list[int]:
        """Return the positions of the hits without which the others agree best.

        Args:
            cuts: of all hits in the sums.
            sums: over all lines.
        """
        if len(cuts) <= _WORTH_IT:
            return list(range(len(cuts)))
        totals, lines = sums.totals(), self._lines
        low, high = sums.band()
        some = HitSums(
            totals.force[lines], totals.response[:, lines], totals.cross[:, lines]
        )
        at = sums.frequency[lines]
        inside = (at >= low) & (at <= high)
        found = [
            coherence_of_each(
                some,
                np.array([self._kept[cut][0] for cut in part]),
                np.array([self._kept[cut][1] for cut in part]),
                inside,
            )
            for part in (
                cuts[first : first + _TOGETHER]
                for first in range(0, len(cuts), _TOGETHER)
            )
        ]
        order = np.argsort(-np.concatenate(found), kind="stable")
        return sorted(order[:_WORTH_IT].tolist())


@dataclass(slots=True)
class KeptSpectra:
    """Spectra of hits under one window; the one used longest ago is dropped first.

    Attributes:
        most: size of what is kept [bytes].
    """

    most: int = MOST_KEPT
    _kept: OrderedDict[HitCut, HitSpectra] = field(default_factory=OrderedDict)
    _size: int = 0

    def get(self, cut: HitCut, transform: Callable[[], HitSpectra]) -> HitSpectra:
        """Return the spectra of a hit.

        Args:
            cut: of the hit.
            transform: makes them where they are not kept.
        """
        if cut in self._kept:
            self._kept.move_to_end(cut)
            return self._kept[cut]
        found = self._kept[cut] = transform()
        self._size += _size(found)
        while self._size > self.most and len(self._kept) > 1:
            self._size -= _size(self._kept.popitem(last=False)[1])
        return found

    def drop(self, cut: HitCut) -> None:
        """Forget a hit."""
        found = self._kept.pop(cut, None)
        self._size -= 0 if found is None else _size(found)

    def clear(self) -> None:
        """Forget all."""
        self._kept.clear()
        self._size = 0


def _size(spectra: HitSpectra) -> int:
    return spectra.force.nbytes + spectra.response.nbytes
