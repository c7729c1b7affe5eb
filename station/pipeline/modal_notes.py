# SPDX-License-Identifier: MIT
"""What a person at the bench must know beside the table of modes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.frf.beyond_band import Beyond, look_beyond
from jointbench.signal.frf.frf_of_functions import noise_source
from jointbench.signal.frf.linearity import Linearity
from jointbench.signal.frf.measured_frf import check_levels
from jointbench.signal.hits.find_hits import accepted_hits
from jointbench.signal.hits.hit_pairs import point_of
from jointbench.signal.hits.pulse_duration import time_scale_words
from jointbench.signal.modal.data_limits import (
    block_words,
    mode_words,
    requested_band_words,
)
from jointbench.station.pipeline.chain import ModalChain


@dataclass(frozen=True, slots=True, eq=False)
class ModalNotes:
    """What was looked at beside the modes.

    Attributes:
        beyond: what lies above the band.
        linearity: whether the FRF depends on the level, None where it was not checked.
        unchecked: why linearity was not checked, or empty.
        limits: what cannot be in the data, a sentence each.
        sources: origin of the noise of FRFs from files, a sentence each.
        possible: modes that the data hint at, pairs taken by reciprocity, and
            temperatures of the hits, a sentence each.
    """

    beyond: Beyond
    linearity: Linearity | None
    unchecked: str
    limits: tuple[str, ...]
    sources: tuple[str, ...] = ()
    possible: tuple[str, ...] = ()

    def remarks(self) -> tuple[str, ...]:
        """Return what the modes should be read with, a sentence each."""
        words = []
        if self.linearity is not None and self.linearity.nonlinear:
            words.append(f"levels disagree: {self.linearity.words}")
        return (
            *self.sources,
            *words,
            *self.possible,
            *filter(None, [self.beyond.words()]),
        )


def modal_notes(chain: ModalChain) -> ModalNotes:
    """Look at what a chain leaves out: band, levels, length, rate and decay.

    Args:
        chain: recordings with judged hits, FRF and modes.
    """
    if not chain.recordings:
        return _frf_notes(chain)
    judged = [r for r in chain.recordings if accepted_hits(r)]
    levels = chain.levels or check_levels(judged)
    power = np.interp(chain.frf.frequency, levels.frequency, levels.force_power)
    beyond = look_beyond(chain.frf, chain.result.band, power)
    possible = (
        *chain.result.remarks,
        *_reciprocal_words(chain, judged),
        *_temperature_words(judged),
    )
    return ModalNotes(
        beyond, levels.linearity, levels.unchecked, limit_words(chain), (), possible
    )


def _temperature_words(judged: Sequence[Recording]) -> tuple[str, ...]:
    """State at which temperatures the accepted hits were made, where measured."""
    found = [
        hit.temperature
        for recording in judged
        for hit in accepted_hits(recording)
        if hit.temperature is not None
    ]
    if not found:
        return ()
    return (f"accepted hits were made at {min(found):.1f} to {max(found):.1f} °C",)


def _reciprocal_words(
    chain: ModalChain, judged: Sequence[Recording]
) -> tuple[str, ...]:
    """Name the outputs that were hit and never measured."""
    measured = {f"{c.name}@{c.point}" for r in judged for c in r.channels}
    turned = [point_of(o) for o in chain.frf.outputs if o not in measured]
    if not turned:
        return ()
    return (
        f"points {', '.join(turned)} were hit, not measured: their FRFs are taken by "
        f"reciprocity with point {', '.join(chain.frf.inputs)}, which holds where hits "
        "and accelerometer act along the same direction",
    )


def _frf_notes(chain: ModalChain) -> ModalNotes:
    """Return the notes on FRFs from files, which hold neither hits nor levels."""
    source = noise_source(chain.provenance)
    words = "" if source is None else source.sentence
    return ModalNotes(
        look_beyond(chain.frf, chain.result.band, None),
        None,
        "FRFs from files have no hits at different levels",
        limit_words(chain),
        (words,) if words else (),
        chain.result.remarks,
    )


def limit_words(chain: ModalChain) -> tuple[str, ...]:
    """State what the data of a chain cannot contain, one sentence each."""
    judged = [r for r in chain.recordings if accepted_hits(r)]
    low, high = chain.result.band
    frequency = chain.frf.frequency
    lines = int(np.count_nonzero((frequency >= low) & (frequency <= high)))
    hits = sum(len(recording.hits) for recording in chain.recordings)
    alone = "single hit: a glancing hit cannot be recognised"
    return (
        *time_scale_words(judged),
        *requested_band_words(judged, chain.result.settings.band),
        *block_words(judged, lines),
        *mode_words(judged, chain.result.model),
        *([alone] if hits == 1 else []),
    )
