# SPDX-License-Identifier: MIT
"""Modes for tables and JSON: what a chain found, remarks and synthesis error."""

import numpy as np

from jointbench.acquisition.records.recordings import Hit, Recording
from jointbench.signal.modal.mode_ranking import rate_modes
from jointbench.station.pipeline.amplitude_summary import amplitude_json
from jointbench.station.pipeline.chain import (
    ModalChain,
)
from jointbench.station.pipeline.modal_notes import ModalNotes

STAGE_COLUMNS = ("|W| [-]", "phase of W [deg]")
"""Headings of `stage_cells`."""


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
            "misfit_over_noise": float(model.residual_ratio[i]),
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
        "amplitude": amplitude_json(chain.amplitude),
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
        **(
            {}
            if hit.temperature is None
            else {"temperature_degc": float(hit.temperature)}
        ),
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
    """Return whether the FRF depends on level, or why that is unknown."""
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
