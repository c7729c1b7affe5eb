# SPDX-License-Identifier: MIT
"""``jointbench modal``: FRFs and modes of sessions and hit files."""

from collections.abc import Sequence
from math import inf
from pathlib import Path

import numpy as np

from jointbench.acquisition.errors import UsageError
from jointbench.acquisition.records import Recording, Verdict
from jointbench.signal.modes import ModalSettings
from jointbench.station.chain import ChainSettings, ModalChain, run_chain
from jointbench.station.inputs import is_session_name, read_recordings
from jointbench.station.output import console, table, with_sd, working, write_json
from jointbench.station.outputs import check_outputs
from jointbench.station.results_file import results_path, write_results


def run_modal(
    files: Sequence[Path],
    *,
    columns: str | None,
    point: str,
    band: str | None,
    order: int | None,
    out: Path | None,
    json_target: str | None,
) -> ModalChain:
    """Identify the modes in `files`, show them and keep them beside the session.

    Recordings under different preloads are never averaged: each preload has modes, a
    table and a results file of its own.

    Returns:
        What was found at the first preload.
    """
    settings = ChainSettings(
        modal=ModalSettings(band=parse_band(band), highest_order=order)
    )
    target = out or _beside(files)
    check_outputs(files, [target, json_target])
    recordings = read_recordings(files, columns=columns, point=point)
    groups = by_preload(recordings)
    chains = []
    for preload, group in groups:
        with working("judging hits, estimating FRFs, fitting modes"):
            chain = run_chain(group, settings)
        if len(groups) > 1:
            console(json_target).print(f"\nPreload {preload:g} N")
        if target is not None:
            own = target if len(groups) == 1 else _of_preload(target, preload)
            write_results(own, chain, files)
        show_modal(chain, json_target)
        chains.append(chain)
    content = _all_json(groups, chains) | {"results": str(target or "")}
    write_json(json_target, content)
    return chains[0]


def by_preload(
    recordings: Sequence[Recording],
) -> tuple[tuple[float | None, tuple[Recording, ...]], ...]:
    """Part recordings by the preload of the joint: each has modes of its own.

    Args:
        recordings: of one session or of several files.

    Returns:
        Preload [N] and its recordings, in the order met. All in one where there are
        not two preloads among those with an accepted hit; else recordings without a
        preload or without an accepted hit are left out.
    """
    groups: dict[float | None, list[Recording]] = {}
    for recording in recordings:
        if any(hit.verdict is Verdict.OK for hit in recording.hits):
            groups.setdefault(recording.preload, []).append(recording)
    if len(groups) < 2:
        return ((next(iter(groups), None), tuple(recordings)),)
    return tuple((preload, tuple(group)) for preload, group in groups.items())


def _of_preload(target: Path, preload: float | None) -> Path:
    word = "no-preload" if preload is None else f"{preload:g}N"
    stem = target.name.removesuffix(".results.h5").removesuffix(".h5")
    return target.with_name(f"{stem}.{word}.results.h5")


def _all_json(
    groups: Sequence[tuple[float | None, tuple[Recording, ...]]],
    chains: Sequence[ModalChain],
) -> dict[str, object]:
    """Return the JSON of one group, or of all with the modes of all in one list."""
    pages = [modal_json(chain) for chain in chains]
    if len(pages) == 1:
        return pages[0]
    preloads = [preload for preload, _ in groups]
    modes: list[object] = []
    for preload, page in zip(preloads, pages, strict=True):
        own = page["modes"]
        assert isinstance(own, list)
        modes += [{**mode, "preload_n": preload} for mode in own]
    preload_pages = [
        {"preload_n": preload, **page}
        for preload, page in zip(preloads, pages, strict=True)
    ]
    return pages[0] | {"modes": modes, "preloads": preload_pages}


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


def show_modal(chain: ModalChain, json_target: str | None) -> None:
    """Print verdicts, FRF and modes."""
    screen = console(json_target)
    for recording in chain.recordings:
        screen.print(_hits_line(recording))
    model = chain.result.model
    rows = [
        (
            str(number + 1),
            with_sd(model.natural_frequency[number], model.frequency_sd[number]),
            with_sd(
                100 * model.damping_ratio[number], 100 * model.damping_ratio_sd[number]
            ),
        )
        for number in range(model.natural_frequency.size)
    ]
    low, high = chain.result.band
    title = f"Modes between {low:.0f} and {high:.0f} Hz (± one standard deviation)"
    screen.print(
        table(title, ("mode", "natural frequency [Hz]", "damping ratio [%]"), rows)
    )


def _hits_line(recording: Recording) -> str:
    good = sum(hit.verdict == "ok" for hit in recording.hits)
    bad = [
        f"hit {number} {hit.verdict.value}: {hit.reason}"
        for number, hit in enumerate(recording.hits, 1)
        if hit.verdict != "ok"
    ]
    line = f"{recording.name}: {good} of {len(recording.hits)} hits accepted"
    return "\n  ".join([line, *bad])


def modal_json(chain: ModalChain) -> dict[str, object]:
    """Return what the contract promises of ``modal``, and more."""
    model, gain = chain.result.model, chain.result.stage_gain
    modes = [
        {
            "frequency_hz": float(model.natural_frequency[i]),
            "frequency_sd_hz": float(model.frequency_sd[i]),
            "damping_ratio": float(model.damping_ratio[i]),
            "damping_ratio_sd": float(model.damping_ratio_sd[i]),
            "stable_orders": int(model.stable_orders[i]),
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
        "averages": chain.frf.averages,
        "added_decay_rate_per_s": chain.frf.added_decay_rate,
        "synthesis_error_rms": synthesis_error(chain),
        "hits": [
            {
                "recording": recording.name,
                "time_s": recording.start_time + hit.trigger / recording.sample_rate,
                "point": hit.point,
                "peak_n": float(hit.peak_force),
                "verdict": hit.verdict.value,
                "measure": float(hit.measure),
                "reason": hit.reason,
            }
            for recording in chain.recordings
            for hit in recording.hits
        ],
    }


def synthesis_error(chain: ModalChain) -> float:
    """Return what the synthesis misses of the FRF, as a share of its rms [-]."""
    synthesis, frf = chain.result.synthesis, chain.frf
    inside = np.isin(frf.frequency, synthesis.frequency)
    measured = frf.response[:, :, inside]
    missed = np.abs(synthesis.response - measured) ** 2
    return float(np.sqrt(missed.sum() / (np.abs(measured) ** 2).sum()))
