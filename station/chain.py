# SPDX-License-Identifier: MIT
"""The chain from recordings to modes, in the order in which a bench runs it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from jointbench.acquisition.errors import NoHitFound, NoModeFound
from jointbench.acquisition.records import Provenance, Recording
from jointbench.signal.campaign_level import compare_levels
from jointbench.signal.data_limits import block_words, time_scale_words
from jointbench.signal.frf import Frf, estimate_frf
from jointbench.signal.frf_estimators import Estimator
from jointbench.signal.hits import HitCriteria, find_hits
from jointbench.signal.kalman import KalmanSettings, smooth_recording
from jointbench.signal.lscf import Progress
from jointbench.signal.modes import ModalResult, ModalSettings, identify_modes
from jointbench.signal.one_thread import one_thread
from jointbench.signal.oscillator_bank import repair_dropouts
from jointbench.signal.windows import WindowRequest, requested_window

# A gap spoils the modes that fill it; what a second round leaves is below the noise.
_REPAIRS = 2


@dataclass(frozen=True, slots=True)
class ChainSettings:
    """How recordings become modes.

    Attributes:
        hits: how hits are found and judged.
        kalman: the smoother, run on all channels alike; None leaves it out.
        modal: band, order and stability limits of the extraction.
        estimator: of the FRF.
        window: what is asked of the windows; by default nothing, the hits choose.
    """

    hits: HitCriteria = field(default_factory=HitCriteria)
    kalman: KalmanSettings | None = field(default_factory=KalmanSettings)
    modal: ModalSettings = field(default_factory=ModalSettings)
    estimator: Estimator = Estimator.H1
    window: WindowRequest = field(default_factory=WindowRequest)


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
    stretch between them, and is left out. A file of one hit has nothing to compare its
    level with: that is judged over all recordings, or by the plan.

    Raises:
        NoHitFound: there is no hit in a recording, and none was judged before.
    """
    some = any(recording.hits for recording in recordings)
    found, fresh = [], []
    for recording in recordings:
        try:
            found.append(
                recording if recording.hits else find_hits(recording, settings.hits)
            )
            fresh.append(not recording.hits)
        except NoHitFound:
            if not some:
                raise
    return compare_levels(found, settings.hits.limits, fresh)


def run_chain(
    recordings: Sequence[Recording],
    settings: ChainSettings | None = None,
    *,
    progress: Progress | None = None,
) -> ModalChain:
    """Take recordings to modes.

    Hits are judged on the samples as recorded: a smoother would round off the flat
    tops that betray an overload. Where a response stood still for a while, the modes
    found without regard to that fill the gap; a few rounds, as those modes get better.

    Args:
        recordings: force and responses; hits that are already judged are kept.
        settings: None for the defaults.
        progress: told what is done, and the share of it; None for nobody.

    Returns:
        The whole chain, so that every stage can be shown.

    Raises:
        BadData: no usable hit, channels missing, or no mode above the noise.
    """
    with one_thread():
        return _run(recordings, settings or ChainSettings(), progress)


def _run(
    recordings: Sequence[Recording], settings: ChainSettings, progress: Progress | None
) -> ModalChain:
    judged = judge_hits(recordings, settings)
    frf = chain_frf([smoothed(r, settings) for r in judged], settings)
    try:
        result = identify_modes(frf, settings.modal, progress=progress)
    except NoModeFound as error:
        why = (*time_scale_words(judged), *block_words(judged))
        raise NoModeFound("; ".join((str(error), *why))) from error
    filled = fill_and_repeat(judged, result, settings, progress=progress)
    if filled is not None:
        return filled
    return ModalChain(judged, frf, result, result.model.provenance)


def fill_and_repeat(
    judged: Sequence[Recording],
    result: ModalResult,
    settings: ChainSettings,
    *,
    progress: Progress | None = None,
) -> ModalChain | None:
    """Fill lost samples with what the modes make of the good ones, and fit again.

    Args:
        judged: with judged hits.
        result: modes found with the losses in them.
        settings: of the chain.
        progress: told what is done, and the share of it; None for nobody.

    Returns:
        The chain with the losses filled, or None where nothing was lost.
    """
    chain = None
    for _ in range(_REPAIRS):
        model = result.model
        repaired = tuple(
            repair_dropouts(r, model.natural_frequency, model.damping_ratio)
            for r in judged
        )
        if all(new is old for new, old in zip(repaired, judged, strict=True)):
            return chain
        frf = chain_frf([smoothed(r, settings) for r in repaired], settings)
        result = identify_modes(frf, settings.modal, progress=progress)
        chain = ModalChain(repaired, frf, result, result.model.provenance)
    return chain


def smoothed(recording: Recording, settings: ChainSettings) -> Recording:
    """Put a recording through the Kalman stage, if there is one; hits are kept."""
    if settings.kalman is None:
        return recording
    return replace(smooth_recording(recording, settings.kalman), hits=recording.hits)


def chain_frf(recordings: Sequence[Recording], settings: ChainSettings) -> Frf:
    """Estimate the FRF of recordings that have been through the Kalman stage."""
    window = requested_window(recordings, settings.window)
    return estimate_frf(recordings, window=window, estimator=settings.estimator)
