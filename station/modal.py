# SPDX-License-Identifier: MIT
"""``jointbench modal``: FRFs and modes of sessions and hit files."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np

from jointbench.acquisition.errors import UsageError
from jointbench.acquisition.records import Hit, Recording
from jointbench.signal.choices import Choices
from jointbench.signal.frf_estimators import Estimator
from jointbench.signal.mode_confidence import rate_modes
from jointbench.signal.modes import ModalSettings
from jointbench.station.chain import (
    ChainSettings,
    ModalChain,
    judge_hits,
    judged_modes,
)
from jointbench.station.inputs import is_session_name, read_recordings
from jointbench.station.modal_notes import ModalNotes, modal_notes
from jointbench.station.modal_show import show_modal
from jointbench.station.output import console, progress_bar, write_json
from jointbench.station.outputs import check_outputs
from jointbench.station.preloads import by_preload, join_pages, of_preload
from jointbench.station.results_file import results_path, write_results
from jointbench.station.stage_store import StageRun
from jointbench.station.universal_file import write_universal

STAGE_COLUMNS = ("|W| [-]", "phase of W [deg]")
"""Headings of `stage_cells`."""


def modal_settings(
    band: str | None,
    order: int | None,
    estimator: str,
    keep: Sequence[float],
    drop: Sequence[float],
) -> ChainSettings:
    """Return the settings that the options stand for.

    Raises:
        UsageError: an option is not what it should be.
    """
    names = {e.value.lower(): e for e in Estimator}
    if estimator.lower() not in names:
        raise UsageError(f"--estimator is {estimator!r}; write H1, H2 or Hv")
    for option, frequency in (
        *(("--keep", f) for f in keep),
        *(("--drop", f) for f in drop),
    ):
        if not 0.0 < frequency < inf:
            raise UsageError(f"{option} is {frequency:g}; write a frequency in Hz")
    return ChainSettings(
        estimator=names[estimator.lower()],
        modal=ModalSettings(
            band=parse_band(band),
            highest_order=order,
            choices=Choices(tuple(keep), tuple(drop)),
        ),
    )


def run_modal(
    files: Sequence[Path],
    settings: ChainSettings | None = None,
    *,
    columns: str | None = None,
    point: str = "1",
    out: Path | None = None,
    universal: Path | None = None,
    json_target: str | None = None,
    run: StageRun | None = None,
) -> ModalChain:
    """Identify the modes in `files`, show them and keep them beside the session.

    Recordings under different preloads are never averaged: each preload has modes, a
    table and a results file of its own.

    Args:
        files: sessions, or files of hits.
        settings: None for the defaults.
        columns: of files of hits.
        point: that was struck, in files that do not say.
        out: results file; None for beside the session.
        universal: universal file to write, or None.
        json_target: where the JSON goes.
        run: store and source of the stages; None to keep none.

    Returns:
        What was found at the first preload.
    """
    target = out or _beside(files)
    check_outputs(files, [target, universal, json_target])
    settings = settings or ChainSettings()
    stored = read_recordings(files, columns=columns, point=point)
    # A hit's level is that of the campaign, whatever the preload.
    run = run or StageRun()
    groups = by_preload(judge_hits(stored, settings, run))
    chains, pages = [], []
    for preload, group in groups:
        with progress_bar("judging hits, estimating FRFs") as progress:
            own_run = replace(run, progress=progress)
            chain = judged_modes(group, settings, own_run, preload)
        own, shared = target, universal
        if len(groups) > 1:
            console(json_target).print(f"\nPreload {preload} N")
            own = None if target is None else of_preload(target, preload)
            shared = None if universal is None else of_preload(universal, preload)
        if own is not None:
            write_results(own, chain, files)
        if shared is not None:
            write_universal(shared, chain.frf, chain.result.model)
        notes = modal_notes(chain)
        show_modal(chain, notes, json_target)
        chains.append(chain)
        pages.append(modal_json(chain, notes))
    content = join_pages([preload for preload, _ in groups], pages)
    write_json(json_target, content | {"results": str(target or "")})
    return chains[0]


def parse_band(text: str | None) -> tuple[float, float] | None:
    """Read ``"50:5000"`` as a band in hertz.

    Raises:
        UsageError: it is no such pair, or runs backwards.
    """
    if text is None:
        return None
    try:
        low, high = (float(part) for part in text.split(":"))
    except ValueError:
        raise UsageError(
            f"--band is {text!r}; write lowest and highest frequency in Hz, as 50:5000"
        ) from None
    if not 0 <= low < high < inf:
        raise UsageError(
            f"--band is {text!r}; write two frequencies in Hz, the lower one first"
        )
    return low, high


def _beside(files: Sequence[Path]) -> Path | None:
    sessions = [path for path in files if is_session_name(path)]
    return results_path(sessions[0]) if len(sessions) == len(files) == 1 else None


def stage_cells(chain: ModalChain, number: int) -> tuple[str, str]:
    """Return what the Kalman stage did at a mode: its gain and its phase."""
    gain = chain.result.stage_gain
    if gain is None:
        return "-", "-"
    return f"{gain.gain[number]:.4f}", f"{np.degrees(gain.phase[number]):.1f}"


def modal_json(chain: ModalChain, notes: ModalNotes) -> dict[str, object]:
    """Return what the contract promises of ``modal``, and more."""
    model, gain = chain.result.model, chain.result.stage_gain
    orders = chain.result.stabilisation.orders.size
    rated = rate_modes(model, orders)
    modes = [
        {
            "frequency_hz": float(model.natural_frequency[i]),
            "frequency_sd_hz": float(model.frequency_sd[i]),
            "damping_ratio": float(model.damping_ratio[i]),
            "damping_ratio_sd": float(model.damping_ratio_sd[i]),
            "stable_orders": int(model.stable_orders[i]),
            "chosen_by": "hand" if model.by_hand[i] else "automatic",
            "misfit_over_noise": float(model.misfit[i]),
            "systematic": bool(model.systematic[i]),
            "frequency_systematic_hz": float(rated.frequency_error[i]),
            "damping_ratio_systematic": float(rated.damping_error[i]),
            "confidence": float(rated.confidence[i]),
            "rank": int(rated.rank[i]),
            "grade": rated.grades[i].value,
            "broad": bool(rated.broad[i]),
            "shape_re": [float(v) for v in model.shapes[i].real],
            "shape_im": [float(v) for v in model.shapes[i].imag],
            "kalman_gain": None if gain is None else float(gain.gain[i]),
            "kalman_phase_deg": (
                None if gain is None else float(np.degrees(gain.phase[i]))
            ),
        }
        for i in range(model.natural_frequency.size)
    ]
    return {
        "modes": modes,
        "outputs": list(model.outputs),
        "inputs": list(model.inputs),
        "band_hz": list(chain.result.band),
        "orders": orders,
        "warnings": list(notes.limits),
        "notes": list(notes.remarks()),
        "beyond_band": _beyond_json(notes),
        "linearity": _linearity_json(notes),
        "averages": chain.frf.averages,
        "added_decay_rate_per_s": chain.frf.added_decay_rate,
        "synthesis_error_rms": synthesis_error(chain),
        "hits": [
            _hit_json(recording, hit)
            for recording in chain.recordings
            for hit in recording.hits
        ],
    }


def _hit_json(recording: Recording, hit: Hit) -> dict[str, object]:
    return {
        "recording": recording.name,
        "time_s": recording.start_time + hit.trigger / recording.sample_rate,
        "point": hit.point,
        "peak_n": float(hit.peak_force),
        "verdict": hit.verdict.value,
        "measure": float(hit.measure),
        "reason": hit.reason,
    }


def _beyond_json(notes: ModalNotes) -> dict[str, object]:
    """Return the peaks above the band, heights over the highest within."""
    beyond = notes.beyond
    return {
        "force_drop_db": beyond.force_drop,
        "alias_free_to_hz": beyond.reach,
        "peaks": [
            {
                "frequency_hz": peak.frequency,
                "height": peak.height,
                "coherence": peak.coherence,
                "force_drop_db": peak.force_drop,
            }
            for peak in beyond.peaks
        ],
    }


def _linearity_json(notes: ModalNotes) -> dict[str, object]:
    """Return whether the FRF depends on the level, or why nobody can tell."""
    found = notes.linearity
    if found is None:
        return {"checked": False, "words": notes.unchecked}
    return {
        "checked": True,
        "nonlinear": found.nonlinear,
        "change_per_doubling": found.change_per_doubling,
        "significance": found.significance,
        "words": found.words,
    }


def synthesis_error(chain: ModalChain) -> float:
    """Return what the synthesis misses of the FRF, as a share of its rms [-]."""
    synthesis, frf = chain.result.synthesis, chain.frf
    inside = np.isin(frf.frequency, synthesis.frequency)
    measured = frf.response[:, :, inside]
    missed = np.abs(synthesis.response - measured) ** 2
    return float(np.sqrt(missed.sum() / (np.abs(measured) ** 2).sum()))
