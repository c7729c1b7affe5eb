# SPDX-License-Identifier: MIT
"""The chain from recordings to modes, in the order in which a bench runs it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from jointbench.acquisition.errors import NoHitFound
from jointbench.acquisition.records import Provenance, Recording
from jointbench.signal.frf import Frf, estimate_frf
from jointbench.signal.hits import HitCriteria, find_hits
from jointbench.signal.kalman import KalmanSettings, smooth_recording
from jointbench.signal.modes import ModalResult, ModalSettings, identify_modes


@dataclass(frozen=True, slots=True)
class ChainSettings:
    """How recordings become modes.

    Attributes:
        hits: how hits are found and judged.
        kalman: the smoother, run on all channels alike; None leaves it out.
        modal: band, order and stability limits of the extraction.
    """

    hits: HitCriteria = field(default_factory=HitCriteria)
    kalman: KalmanSettings | None = field(default_factory=KalmanSettings)
    modal: ModalSettings = field(default_factory=ModalSettings)


@dataclass(frozen=True, slots=True, eq=False)
class ModalChain:
    """Recordings with judged hits, the FRF they give, and its modes.

    Attributes:
        recordings: as recorded, with hits and verdicts.
        frf: from the accepted hits, after the Kalman stage.
        result: modes, stabilisation and synthesis.
        provenance: every step from the recordings to the modes.
    """

    recordings: tuple[Recording, ...]
    frf: Frf
    result: ModalResult
    provenance: Provenance


def judge_hits(
    recordings: Sequence[Recording], settings: ChainSettings
) -> tuple[Recording, ...]:
    """Find and judge the hits of recordings that carry none yet.

    Where others were judged as they were recorded, one without a hit is a quiet
    stretch between them, and is left out.

    Raises:
        NoHitFound: there is no hit in a recording, and none was judged before.
    """
    some = any(recording.hits for recording in recordings)
    found = []
    for recording in recordings:
        try:
            found.append(
                recording if recording.hits else find_hits(recording, settings.hits)
            )
        except NoHitFound:
            if not some:
                raise
    return tuple(found)


def run_chain(
    recordings: Sequence[Recording], settings: ChainSettings | None = None
) -> ModalChain:
    """Take recordings to modes.

    Hits are judged on the samples as recorded: a smoother would round off the flat
    tops that betray an overload.

    Args:
        recordings: force and responses; hits that are already judged are kept.
        settings: None for the defaults.

    Returns:
        The whole chain, so that every stage can be shown.

    Raises:
        BadData: no usable hit, channels missing, or no mode above the noise.
    """
    settings = settings or ChainSettings()
    judged = judge_hits(recordings, settings)
    frf = estimate_frf([_smoothed(recording, settings) for recording in judged])
    result = identify_modes(frf, settings.modal)
    return ModalChain(judged, frf, result, result.model.provenance)


def _smoothed(recording: Recording, settings: ChainSettings) -> Recording:
    if settings.kalman is None:
        return recording
    return replace(smooth_recording(recording, settings.kalman), hits=recording.hits)
