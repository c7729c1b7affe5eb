# SPDX-License-Identifier: MIT
"""The average of one condition while it grows: FRF, coherence, and who spoils it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.errors import BadData, NoHitFound
from jointbench.acquisition.records.recordings import Channel, Hit, Recording, Verdict
from jointbench.signal.frf.coherence_without import (
    coherence_of_others,
    typical_coherence,
)
from jointbench.signal.frf.frf import Frf
from jointbench.signal.hits.hit_spectra import (
    HitSpectra,
    hit_spectra,
    require_alive,
)
from jointbench.signal.hits.hit_verdicts import HitLimits
from jointbench.signal.hits.windows import HammerWindow, choose_window, join_windows
from jointbench.station.measure.running_sums import (
    MOST_KEPT,
    FewLines,
    KeptSpectra,
    RunningSums,
)
from jointbench.station.measure.stored_cut import HitCut

_ELSEWHERE = 0.5  # a slender point is struck more softly than the others
_ENOUGH = 3  # hits from which a single outlier can be recognised


@dataclass(frozen=True, slots=True, eq=False)
class Accepted:
    """A hit in an average.

    Attributes:
        cut: its samples.
        hit: as judged.
    """

    cut: HitCut
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


class GrowingAverage:
    """The average of the hits of one condition, by their sums.

    A hit is transformed when it comes. Those before it are transformed again, from the
    samples in the file, where it asks for a wider window or a shorter block than they
    had. The memory does not depend on the number of hits.
    """

    def __init__(
        self, channels: Sequence[Channel], sample_rate: float, *, kept: int = MOST_KEPT
    ) -> None:
        """Begin without a hit.

        Args:
            channels: of the rows of every hit.
            sample_rate: [Hz].
            kept: size of the spectra that are not transformed again [bytes].
        """
        self._channels, self._rate = tuple(channels), sample_rate
        self._length = 0
        self._windows: dict[HitCut, HammerWindow] = {}
        self._sums: RunningSums | None = None
        self._few: FewLines | None = None
        self._summed: dict[HitCut, Accepted] = {}
        self._spectra = KeptSpectra(kept)
        self._last: tuple[tuple[HitCut, ...], Frf | None] = ((), None)

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
        without = self._without_each(accepted)
        position = max(without, key=lambda place: without[place])
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
            return self._summed_up(accepted).frf()
        except BadData:
            return None

    def _without_each(self, accepted: Sequence[Accepted]) -> dict[int, float]:
        """Return the coherence without the hits that may spoil it [-], by position."""
        sums = self._summed_up(accepted)
        totals, found = sums.totals(), {}
        cuts = [each.cut for each in accepted]
        assert self._few is not None
        for position in self._few.most_likely(cuts, sums):
            own = self._transformed(accepted[position], sums.window)
            force, response = own.force[0], own.response[0]
            found[position] = coherence_of_others(
                totals, force, response, sums.frequency
            )
        return found

    def _summed_up(self, accepted: Sequence[Accepted]) -> RunningSums:
        """Return the sums over hits; only those that changed are touched.

        Raises:
            NoHitFound: there are none.
            ChannelMissing: a response saw nothing of a hit.
        """
        window = self._window(accepted)
        wanted = {each.cut: each for each in accepted}
        sums = self._sums
        if (
            sums is None
            or sums.window != window
            or self._summed.keys().isdisjoint(wanted)
        ):
            # Under another window or length each hit has other spectra.
            self._spectra.clear()
            first = self._transformed(accepted[0], window)
            sums = RunningSums(first, window)
            self._sums, self._summed = sums, {accepted[0].cut: accepted[0]}
            self._few = FewLines(sums)
            self._few.keep(accepted[0].cut, first)
        assert self._few is not None
        for cut in [cut for cut in self._summed if cut not in wanted]:
            sums.take_out(self._transformed(self._summed.pop(cut), window))
            self._spectra.drop(cut)
            self._few.drop(cut)
        for cut, each in wanted.items():
            if cut not in self._summed:
                spectra = self._transformed(each, window)
                sums.add(spectra)
                self._few.keep(cut, spectra)
                self._summed[cut] = each
        return sums

    def _window(self, accepted: Sequence[Accepted]) -> HammerWindow:
        """Return the one window that serves all hits."""
        if not accepted:
            raise NoHitFound("there are no hits yet; strike one")
        length = min(each.cut.count for each in accepted)
        if length != self._length:
            self._length, self._windows, self._sums = length, {}, None
        self._windows = {
            each.cut: self._windows.get(each.cut) or self._own_window(each)
            for each in accepted
        }
        return join_windows(list(self._windows.values()))

    def _own_window(self, accepted: Accepted) -> HammerWindow:
        recording = self._recording(accepted)
        require_alive(recording, recording.hits[0])
        # Its words would differ for every hit.
        return replace(choose_window(recording), reason="")

    def _transformed(self, accepted: Accepted, window: HammerWindow) -> HitSpectra:
        return self._spectra.get(
            accepted.cut, lambda: hit_spectra([self._recording(accepted)], window)
        )

    def _recording(self, accepted: Accepted) -> Recording:
        """Return a hit as a recording, cut to the common length."""
        hit = replace(
            accepted.hit,
            start=0,
            trigger=accepted.cut.trigger,
            stop=self._length,
            verdict=Verdict.OK,
        )
        return Recording(
            "average",
            accepted.cut.samples[:, : self._length],
            self._rate,
            self._channels,
            hits=(hit,),
        )


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
