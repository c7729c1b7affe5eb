# SPDX-License-Identifier: MIT
"""Spectra of the hits that were used last, up to some megabytes."""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field

from jointbench.signal.hits.hit_spectra import HitSpectra
from jointbench.station.measure.stored_cut import Cut

MOST_KEPT = 2**25
"""Size of the spectra that are kept [bytes]: 50 hits of four channels and half a second
at 51.2 kS/s. Transforming a further one again takes some milliseconds."""


@dataclass(slots=True)
class KeptSpectra:
    """Spectra of hits under one window; the one used longest ago is dropped first.

    Attributes:
        most: size of what is kept [bytes].
    """

    most: int = MOST_KEPT
    _kept: OrderedDict[Cut, HitSpectra] = field(default_factory=OrderedDict)
    _size: int = 0

    def get(self, cut: Cut, transform: Callable[[], HitSpectra]) -> HitSpectra:
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

    def drop(self, cut: Cut) -> None:
        """Forget a hit."""
        found = self._kept.pop(cut, None)
        self._size -= 0 if found is None else _size(found)

    def clear(self) -> None:
        """Forget all."""
        self._kept.clear()
        self._size = 0


def _size(spectra: HitSpectra) -> int:
    return spectra.force.nbytes + spectra.response.nbytes
