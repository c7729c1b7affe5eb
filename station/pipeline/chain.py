# SPDX-License-Identifier: MIT
"""The stages from recordings to modes, each put in once, and the chain of them.

::

    hits    <- samples                      kalman  <- samples
    frf     <- hits, kalman, windows        modes   <- frf
    fill    <- modes, samples (lost ones)   amplitude <- modes, hits

Every command and every recipe runs these stages, each through a store
(`stage_store`) that keeps what it gives, or nothing.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from jointbench.acquisition.basics.errors import NoHitFound, NoModeFound
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.basics.steady_memory import return_freed_memory
from jointbench.acquisition.records.provenance import Provenance, Step
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.amplitude.amplitude_curve import AmplitudeMode
from jointbench.signal.amplitude.amplitude_modes import amplitude_modes
from jointbench.signal.amplitude.resolved_model import resolved_model
from jointbench.signal.frf.estimators import Estimator
from jointbench.signal.frf.frf import Frf
from jointbench.signal.frf.measured_frf import (
    LevelCheck,
    MeasuredFrf,
    measure_frf,
)
from jointbench.signal.hits.find_hits import HitCriteria
from jointbench.signal.hits.plausibility import plausibility_words
from jointbench.signal.hits.windows import WindowRequest, requested_window
from jointbench.signal.kalman.oscillator_bank import repair_dropouts
from jointbench.signal.kalman.smoothing import (
    KalmanSettings,
    observe_noise,
)
from jointbench.signal.kalman.stage_provenance import stage_gain_of
from jointbench.signal.modal.data_limits import block_words
from jointbench.signal.modal.lscf import Progress
from jointbench.signal.modal.modes import ModalResult, ModalSettings, identify_modes
from jointbench.signal.modal.response_harmonics import without_growing_harmonics
from jointbench.station.pipeline.judge_again import (
    FoundHits,
    StoredHits,
    judge_again,
    with_hits,
)
from jointbench.station.pipeline.recordings_by_preload import at_words
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.pipeline.survey import survey

# A gap spoils the modes that fill it; what a second round leaves is below the noise.
_REPAIRS = 2


@dataclass(frozen=True, slots=True)
class ChainSettings:
    """How recordings become modes.

    Attributes:
        hits: how hits are found and judged.
        kalman: the smoother, whose innovations state the noise of each channel and
            whose gain cancels in the FRF; None leaves it out.
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
        frf: from the accepted hits.
        result: modes, stabilisation and synthesis.
        provenance: every step from the recordings to the modes.
        amplitude: the modes over their amplitude; empty where that was not looked at.
        levels: whether the FRF depends on the level of the hits; None where no hits
            were looked at.
    """

    recordings: tuple[Recording, ...]
    frf: Frf
    result: ModalResult
    provenance: Provenance
    amplitude: tuple[AmplitudeMode, ...] = ()
    levels: LevelCheck | None = None


def run_chain(
    recordings: Sequence[Recording],
    settings: ChainSettings | None = None,
    run: StageRun | None = None,
) -> ModalChain:
    """Take recordings to modes.

    Args:
        recordings: force and responses; hits that are already judged are kept.
        settings: None for the defaults.
        run: store and source of the stages; None to keep none.

    Returns:
        The whole chain, so that every stage can be shown.

    Raises:
        BadData: no usable hit, channels missing, or no mode above the noise.
    """
    settings, run = settings or ChainSettings(), run or StageRun()
    with one_thread():
        return judged_modes(judge_hits(recordings, settings, run), settings, run)


def judge_hits(
    recordings: Sequence[Recording],
    settings: ChainSettings,
    run: StageRun | None = None,
) -> tuple[Recording, ...]:
    """Find and judge the hits of recordings that carry none yet.

    Where others were judged as they were recorded, one without a hit is a quiet
    stretch between them, and is left out.

    Raises:
        NoHitFound: there is no hit in a recording, and none was judged before.
    """
    found = hits_stage(
        recordings,
        settings.hits,
        StoredHits(),
        run or StageRun(),
        each=lambda recording: survey(recording, settings.kalman),
    )
    return tuple(
        with_hits(recording, one)
        for recording, one in zip(recordings, found, strict=True)
        if one.hits
    )


def judged_modes(
    judged: Sequence[Recording],
    settings: ChainSettings,
    run: StageRun | None = None,
    preload: float | None = None,
) -> ModalChain:
    """Take recordings with judged hits to modes, see `modal_chain`.

    Raises:
        NoHitFound: none was accepted; likewise.
        NoModeFound: there is none; the message gives possible causes.
    """
    try:
        with one_thread():
            return modal_chain(judged, settings, run or StageRun(), preload)
    except NoHitFound as error:
        why = plausibility_words(judged)
        raise NoHitFound("; ".join((str(error), *why))) from error
    except NoModeFound as error:
        why = (*plausibility_words(judged), *block_words(judged))
        raise NoModeFound("; ".join((str(error), *why))) from error


def modal_chain(
    judged: Sequence[Recording],
    settings: ChainSettings,
    run: StageRun,
    preload: float | None = None,
    *,
    over_amplitude: bool = True,
) -> ModalChain:
    """Run the stages that follow the hits.

    Hits are judged on the samples as recorded: a smoother would round off the flat
    tops that betray an overload. Where a response stood still for a while, the modes
    found without regard to that fill the gap; a few rounds, as those modes get better.

    Args:
        judged: with judged hits.
        settings: of the chain.
        run: store and source.
        preload: of these recordings [N], part of the names of the stages.
        over_amplitude: whether the modes are resolved over their amplitude.

    Returns:
        The chain, its recordings with lost samples filled.

    Raises:
        BadData: no usable hit, channels missing, or no mode above the noise.
    """
    at = at_words(preload)
    measured = _frf_stage(judged, settings, run, at)
    result = _modes_stage(measured.frf, settings, run, at)
    result = _without_harmonics(result, measured)
    filled = _fill_stage(judged, result, settings, run, at)
    whole = filled[0] if filled else _chain_of(judged, measured, result)
    return _amplitude_stage(whole, run, at) if over_amplitude else whole


def _without_harmonics(result: ModalResult, measured: MeasuredFrf) -> ModalResult:
    """Leave out what grows with the level of the hits as a harmonic does."""
    model, remarks = without_growing_harmonics(
        result.model, result.remarks, measured.frf, measured.levels.linearity
    )
    if remarks == result.remarks:
        return result
    gain = stage_gain_of(measured.frf.provenance, model.natural_frequency)
    return replace(result, model=model, stage_gain=gain, remarks=remarks)


def _chain_of(
    recordings: Sequence[Recording], measured: MeasuredFrf, result: ModalResult
) -> ModalChain:
    return ModalChain(
        tuple(recordings),
        measured.frf,
        result,
        result.model.provenance,
        levels=measured.levels,
    )


def _amplitude_stage(chain: ModalChain, run: StageRun, at: str) -> ModalChain:
    """Resolve the modes over their amplitude; poles on one curve become one mode."""
    found = run.stages.run(
        f"amplitude{at}",
        run.stages.key("amplitude", [], run.stages.keys[f"fill{at}"]),
        tuple[AmplitudeMode, ...],
        lambda: amplitude_modes(
            chain.recordings, chain.result.model, progress=run.progress
        ),
    )
    model = resolved_model(chain.result.model, found)
    if model is chain.result.model:
        return replace(chain, amplitude=found)
    gain = stage_gain_of(chain.frf.provenance, model.natural_frequency)
    result = replace(chain.result, model=model, stage_gain=gain)
    return replace(chain, result=result, provenance=model.provenance, amplitude=found)


def frf_chain(frf: Frf, settings: ChainSettings, run: StageRun) -> ModalChain:
    """Find the modes of FRFs that come from files; there are no hits to judge.

    Args:
        frf: from `frf_of_functions`.
        settings: of the chain; those of hits, windows and Kalman stage do not count.
        run: store of the stages.

    Raises:
        NoModeFound: there is none; the message gives possible causes.
    """
    run.stages.keys["frf"] = run.stages.digest(frf)
    with one_thread():
        result = _modes_stage(frf, settings, run, "")
    return ModalChain((), frf, result, result.model.provenance)


def hits_stage(
    recordings: Sequence[Recording],
    criteria: HitCriteria,
    stored: StoredHits,
    run: StageRun,
    each: Callable[[Recording], None] | None = None,
) -> tuple[FoundHits, ...]:
    """Return the hits of each recording, see `judge_again`; none for no recordings."""
    if not recordings:
        return ()
    source = run.digest or run.stages.digest(tuple(recordings))
    return run.stages.run(
        "hits",
        run.stages.key("hits", [criteria, stored], source),
        tuple[FoundHits, ...],
        lambda: judge_again(recordings, criteria, stored, each),
    )


def _kalman_stage(
    recording: Recording, key: str, settings: ChainSettings, run: StageRun
) -> Recording:
    """State what noise the Kalman stage sees in a recording, if there is a stage.

    Its gain is that of all channels and cancels in the FRF, so that no sample is
    filtered (record 0095).
    """
    if settings.kalman is None:
        return recording
    kalman = settings.kalman
    seen = run.stages.run(
        f"kalman of {recording.name}",
        key,
        tuple[Step, ...],
        lambda: (observe_noise(recording, kalman),),
    )
    return replace(recording, provenance=(*recording.provenance, *seen))


def _recorded(recording: Recording) -> tuple[object, ...]:
    """Return what the Kalman stage of a recording depends on."""
    return recording.name, recording.samples, recording.sample_rate, recording.channels


def _frf_stage(
    judged: Sequence[Recording], settings: ChainSettings, run: StageRun, at: str
) -> MeasuredFrf:
    """Estimate the FRF of recordings with judged hits, and the noise in each."""
    for recording in judged:
        survey(recording, settings.kalman)
    stages = run.stages
    keys = [
        stages.key("kalman", settings.kalman, *run.source(r.name, _recorded(r)))
        for r in judged
    ]
    found = stages.digest(tuple((r.name, r.hits, r.provenance) for r in judged))
    return stages.run(
        f"frf{at}",
        stages.key("frf", [settings.window, settings.estimator.value], found, *keys),
        MeasuredFrf,
        lambda: _measured(
            [_kalman_stage(*p, settings, run) for p in zip(judged, keys, strict=True)],
            settings,
        ),
    )


def _modes_stage(
    frf: Frf, settings: ChainSettings, run: StageRun, at: str
) -> ModalResult:
    """Find the modes of an FRF that `_frf_stage` gave."""
    return run.stages.run(
        f"modes{at}",
        run.stages.key("modes", settings.modal, run.stages.keys[f"frf{at}"]),
        ModalResult,
        lambda: _modes(frf, settings.modal, run.progress),
    )


def _modes(frf: Frf, settings: ModalSettings, progress: Progress | None) -> ModalResult:
    result = identify_modes(frf, settings, progress=progress)
    return_freed_memory()
    return result


def _fill_stage(
    judged: Sequence[Recording],
    result: ModalResult,
    settings: ChainSettings,
    run: StageRun,
    at: str,
) -> tuple[ModalChain, ...]:
    """Fill lost samples with what the modes make of the good ones, and fit again.

    Args:
        judged: with judged hits.
        result: modes that `_modes_stage` found with the losses in them.
        settings: of the chain.
        run: store and source.
        at: which preload, part of the name.

    Returns:
        The chain with the losses filled, or none where nothing was lost.
    """
    used = [settings.kalman, settings.modal, settings.window, settings.estimator.value]
    return run.stages.run(
        f"fill{at}",
        run.stages.key("fill", used, run.stages.keys[f"modes{at}"]),
        tuple[ModalChain, ...],
        lambda: _filled(judged, result, settings, run.progress),
    )


def _filled(
    judged: Sequence[Recording],
    result: ModalResult,
    settings: ChainSettings,
    progress: Progress | None,
) -> tuple[ModalChain, ...]:
    chain: tuple[ModalChain, ...] = ()
    for _ in range(_REPAIRS):
        model = result.model
        repaired = tuple(
            repair_dropouts(r, model.natural_frequency, model.damping_ratio)
            for r in judged
        )
        if all(new is old for new, old in zip(repaired, judged, strict=True)):
            return chain
        measured = _measured([_observed(r, settings) for r in repaired], settings)
        result = identify_modes(measured.frf, settings.modal, progress=progress)
        chain = (_chain_of(repaired, measured, result),)
    return chain


def _observed(recording: Recording, settings: ChainSettings) -> Recording:
    if settings.kalman is None:
        return recording
    seen = observe_noise(recording, settings.kalman)
    return replace(recording, provenance=(*recording.provenance, seen))


def _measured(recordings: Sequence[Recording], settings: ChainSettings) -> MeasuredFrf:
    """Estimate the FRF of recordings whose noise the Kalman stage has seen."""
    window = requested_window(recordings, settings.window)
    measured = measure_frf(recordings, window=window, estimator=settings.estimator)
    # The sums over hits are left; the fit begins without the memory that held them.
    return_freed_memory()
    return measured
