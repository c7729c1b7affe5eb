# SPDX-License-Identifier: MIT
"""The average of one condition while it grows: FRF, coherence, and who spoils it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.errors import BadData, NoHitFound
from jointbench.acquisition.records.recordings import Channel, Hit, Recording, Verdict
from jointbench.signal.frf.coherence_without import coherence_without, typical_coherence
from jointbench.signal.frf.frf import Frf
from jointbench.signal.hits.hit_spectra import (
    HitSpectra,
    hit_spectra,
    join_spectra,
    require_alive,
)
from jointbench.signal.hits.hit_verdicts import HitLimits
from jointbench.signal.hits.live_hits import CutHit
from jointbench.signal.hits.windows import HammerWindow, choose_window, join_windows
from jointbench.station.measure.running_sums import RunningSums

_ELSEWHERE = 0.5  # a slender point is struck more softly than the others
_ENOUGH = 3  # hits from which a single outlier can be recognised


@dataclass(frozen=True, slots=True, eq=False)
class Accepted:
    """A hit in an average.

    Attributes:
        cut: its samples.
        hit: as judged.
    """

    cut: CutHit
    hit: Hit


@dataclass(frozen=True, slots=True)
class Spoiler:
    """The one hit of an average without which the others agree.

    Attributes:
        position: among the hits of the average.
        together: coherence with it [-].
        reason: one line.
    """

    position: int
    together: float
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class _Transformed:
    """A hit, and what became of it under one window and length."""

    recording: Recording
    own: HammerWindow
    window: HammerWindow | None = None
    spectra: HitSpectra | None = None


class GrowingAverage:
    """The average of the hits of one condition.

    A hit is transformed when it comes. Those before it are transformed again only
    where it asks for a wider window or a shorter block than they had.
    """

    def __init__(self, channels: Sequence[Channel], sample_rate: float) -> None:
        """Begin without a hit.

        Args:
            channels: of the rows of every hit.
            sample_rate: [Hz].
        """
        self._channels, self._rate = tuple(channels), sample_rate
        self._kept: dict[CutHit, _Transformed] = {}
        self._length = 0
        self._sums: RunningSums | None = None
        self._summed: dict[CutHit, HitSpectra] = {}
        self._last: tuple[tuple[CutHit, ...], Frf | None] = ((), None)

    def frf(self, accepted: Sequence[Accepted]) -> Frf | None:
        """Return the FRF of hits, None where they give none."""
        cuts = tuple(each.cut for each in accepted)
        if cuts != self._last[0]:
            self._last = (cuts, self._averaged(accepted))
        return self._last[1]

    def spoiler(self, accepted: Sequence[Accepted], *, wanted: float) -> Spoiler | None:
        """Find the hit that takes the coherence of the others below what is wanted.

        Whether it was the first or the last of them does not matter: each is left out
        in turn.

        Args:
            accepted: hits of one condition.
            wanted: coherence [-].

        Returns:
            The hit without which the coherence is highest, if that is what is wanted;
            None where all agree, or where no single hit is the cause.
        """
        if len(accepted) < _ENOUGH:
            return None
        together = mean_coherence(self.frf(accepted))
        if together is None or together >= wanted:
            return None
        without = coherence_without(self._spectra(accepted))
        position = int(np.argmax(without))
        if without[position] < wanted:
            return None
        return Spoiler(
            position,
            together,
            f"coherence {without[position]:.3f} without this hit, {together:.3f} with "
            f"it (limit {wanted:g}); it struck another place or direction",
        )

    def _averaged(self, accepted: Sequence[Accepted]) -> Frf | None:
        try:
            window = self._transform(accepted)
        except BadData:
            return None
        return self._summed_up(window).frf()

    def _summed_up(self, window: HammerWindow) -> RunningSums:
        """Return the sums over the kept hits; only those that changed are touched."""
        wanted = {c: h.spectra for c, h in self._kept.items() if h.spectra is not None}
        sums, summed = self._sums, self._summed
        # Under another window or length each hit has other spectra.
        same = all(wanted.get(cut, own) is own for cut, own in summed.items())
        same &= not summed.keys().isdisjoint(wanted)
        if sums is None or sums.window != window or not same:
            first, summed = next(iter(wanted)), {}
            sums = RunningSums(wanted[first], window)
            summed[first] = wanted[first]
        for cut in [cut for cut in summed if cut not in wanted]:
            sums.take_out(summed.pop(cut))
        for cut, own in wanted.items():
            if cut not in summed:
                sums.add(own)
                summed[cut] = own
        self._sums, self._summed = sums, summed
        return sums

    def _transform(self, accepted: Sequence[Accepted]) -> HammerWindow:
        """Transform hits under the one window that serves them all, and keep them.

        Raises:
            NoHitFound: there are none.
            ChannelMissing: a response saw nothing of a hit.
        """
        if not accepted:
            raise NoHitFound("there are no hits yet; strike one")
        length = min(each.cut.samples.shape[1] for each in accepted)
        kept = self._kept if length == self._length else {}
        self._length = length
        self._kept = {
            each.cut: kept.get(each.cut) or self._cut(each, length) for each in accepted
        }
        window = join_windows([hit.own for hit in self._kept.values()])
        self._kept = {cut: _under(hit, window) for cut, hit in self._kept.items()}
        return window

    def _spectra(self, accepted: Sequence[Accepted]) -> HitSpectra:
        """Return the spectra of hits; see `_transform`."""
        self._transform(accepted)
        parts = [hit.spectra for hit in self._kept.values()]
        return join_spectra([part for part in parts if part is not None])

    def _cut(self, accepted: Accepted, length: int) -> _Transformed:
        trigger = accepted.cut.trigger
        hit = replace(
            accepted.hit, start=0, trigger=trigger, stop=length, verdict=Verdict.OK
        )
        recording = Recording(
            "average",
            accepted.cut.samples[:, :length],
            self._rate,
            self._channels,
            hits=(hit,),
        )
        require_alive(recording, hit)
        # Its words would differ for every hit.
        return _Transformed(recording, replace(choose_window(recording), reason=""))


def _under(hit: _Transformed, window: HammerWindow) -> _Transformed:
    """Return a hit transformed under a window, which it may be already."""
    if hit.window == window:
        return hit
    return replace(hit, window=window, spectra=hit_spectra([hit.recording], window))


def mean_coherence(frf: Frf | None) -> float | None:
    """Return the coherence over the excited band, each output weighed alike [-]."""
    if frf is None or frf.coherence is None or frf.averages < 2:
        return None
    band = frf.usable_band or (float(frf.frequency[0]), float(frf.frequency[-1]))
    return typical_coherence(frf.coherence[:, 0], frf.frequency, band)


def weak_force(
    level: float | None, accepted: Sequence[Accepted], elsewhere: Sequence[float] = ()
) -> float | None:
    """Return the least useful peak [N]: a third of the level, or of the usual hit.

    Args:
        level: that was asked for [N], None for any.
        accepted: hits of the condition so far.
        elsewhere: peaks of trial hits and of hits at other conditions [N]. The first
            hit of a condition is compared with these, half as strictly: a slender part
            is struck more softly.
    """
    limits = HitLimits()
    if level is not None:
        return limits.weak_ratio * level
    peaks = [each.hit.peak_force for each in accepted]
    if not peaks and not elsewhere:
        return None
    if peaks:
        return limits.weak_ratio * float(np.median(peaks))
    return _ELSEWHERE * limits.weak_ratio * float(np.median(elsewhere))
