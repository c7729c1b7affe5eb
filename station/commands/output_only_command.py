# SPDX-License-Identifier: MIT
"""``jointbench modal --output-only``: operational modal analysis."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.output_only.output_only_modes import (
    OutputOnlyModes,
    OutputOnlySettings,
    identify_output_only,
)
from jointbench.station.files.input_files import read_recordings
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.screen.terminal import console, table, working, write_json
from jointbench.station.screen.value_text import with_sd


def run_output_only(
    files: Sequence[Path],
    *,
    columns: str | None,
    band: tuple[float, float] | None,
    order: int | None,
    json_target: str | None,
    keep_sines: bool = False,
    rate: float | None = None,
) -> OutputOnlyModes:
    """Identify modes from the responses in `files` and show them.

    Args:
        files: one recording.
        columns: of files without units.
        band: lowest and highest frequency [Hz], or None.
        order: states of the largest model, or None for the default.
        json_target: where the JSON goes.
        keep_sines: leave steady sines in the record.
        rate: of a file without times [Hz], or None.
    """
    check_outputs(files, [json_target])
    recording = only_recording(
        read_recordings(files, columns=columns, point="", rate=rate)
    )
    settings = OutputOnlySettings(band=band, take_out_sines=not keep_sines)
    if order is not None:
        settings = replace(settings, highest_order=order)
    with working("estimating correlations, fitting modes"):
        modes = identify_output_only(recording, settings)
    show_output_only(recording, modes, json_target)
    write_json(json_target, output_only_json(recording, modes))
    return modes


def only_recording(recordings: Sequence[Recording]) -> Recording:
    """Return the only recording.

    Raises:
        BadData: there are several; correlations cannot be joined across recordings.
    """
    if len(recordings) > 1:
        names = ", ".join(repr(r.name) for r in recordings)
        raise BadData(
            f"{len(recordings)} recordings ({names}), but operational modal analysis "
            "needs a single long recording; give one file"
        )
    return recordings[0]


def show_output_only(
    recording: Recording, modes: OutputOnlyModes, json_target: str | None
) -> None:
    """Print the modes."""
    low, high = modes.band
    seconds = recording.samples.shape[1] / recording.sample_rate
    rows = [
        (
            str(i + 1),
            with_sd(modes.natural_frequency[i], modes.frequency_sd[i]),
            with_sd(100 * modes.damping_ratio[i], 100 * modes.damping_ratio_sd[i]),
            "harmonic excitation, no mode" if modes.sine_like[i] else "",
        )
        for i in range(modes.natural_frequency.size)
    ]
    title = (
        f"Operational modes, {low:.0f} to {high:.0f} Hz, {seconds:.4g} s of data "
        "(± one standard deviation)"
    )
    columns = ("mode", "natural frequency [Hz]", "damping ratio [%]", "remark")
    console(json_target).print(table(title, columns, rows))
    if modes.sines.words:
        console(json_target).print(f"note: {modes.sines.words}")


def output_only_json(recording: Recording, modes: OutputOnlyModes) -> dict[str, object]:
    """Return the modes as JSON; there are no residues and no modal masses."""
    return {
        "output_only": True,
        "recording": recording.name,
        "band_hz": list(modes.band),
        "outputs": list(modes.outputs),
        "sines_hz": modes.sines.frequency.tolist(),
        "sine_amplitudes": modes.sines.amplitude.tolist(),
        "modes": [
            {
                "frequency_hz": float(modes.natural_frequency[i]),
                "frequency_sd_hz": float(modes.frequency_sd[i]),
                "damping_ratio": float(modes.damping_ratio[i]),
                "damping_ratio_sd": float(modes.damping_ratio_sd[i]),
                "stable_orders": int(modes.stable_orders[i]),
                "sine_like": bool(modes.sine_like[i]),
                "shape_re": [float(v) for v in modes.shapes[i].real],
                "shape_im": [float(v) for v in modes.shapes[i].imag],
            }
            for i in range(modes.natural_frequency.size)
        ],
    }
