# SPDX-License-Identifier: MIT
"""The results file beside a session: its layout, written in one place.

It names its inputs by SHA-256 and can be deleted and made again at any time.
"""

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

import h5py

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.file_access.content_digest import new_signed_file
from jointbench.acquisition.file_access.netcdf_encodings import (
    write_complex,
    write_flags,
    write_texts,
)
from jointbench.acquisition.file_access.netcdf_write import (
    write_attributes,
    write_variable,
)
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.acquisition.records.session import software_version
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.signal.modal.mode_ranking import rate_modes
from jointbench.signal.modal.modes import ModalResult
from jointbench.station.files.computing_environment import computing_environment
from jointbench.station.files.input_files import is_session_name
from jointbench.station.pipeline.chain import ModalChain
from jointbench.station.results.amplitude_results import write_amplitude
from jointbench.station.results.result_rows import MODAL_SCHEMA

FRF_UNITS = {
    FrfKind.RECEPTANCE: "m N-1",
    FrfKind.MOBILITY: "m s-1 N-1",
    FrfKind.ACCELERANCE: "m s-2 N-1",
}
PAIR = ("output", "input", "frequency")


def results_path(session: Path) -> Path:
    """Return where the results of a session go, or those of a file of FRFs.

    The name of a file of FRFs keeps its ending, ``frf-uff.results.h5``: a session of
    the same name may lie beside it.
    """
    if is_session_name(session):
        return session.with_suffix(".results.h5")
    kind = session.suffix.lstrip(".")
    return session.with_name(f"{session.stem}{'-' if kind else ''}{kind}.results.h5")


def write_results(path: Path, chain: ModalChain, inputs: Sequence[Path]) -> None:
    """Write FRF, poles of all orders and modes, replacing earlier results.

    Args:
        path: file to write.
        chain: what was found.
        inputs: files it was found in, named in the results by their SHA-256.
    """
    with new_signed_file(
        path, schema=MODAL_SCHEMA, title="Results of jointbench"
    ) as file:
        write_attributes(
            file,
            {
                "software": software_version(),
                "created": datetime.now(UTC).isoformat(timespec="seconds"),
                "input_files": "\n".join(p.name for p in inputs),
                "input_sha256": "\n".join(file_digest(p) for p in inputs),
            },
        )
        write_environment(file)
        write_modal(file, chain)


def write_environment(file: h5py.File) -> None:
    """Write what computes a result: build, versions, kind of computer."""
    write_attributes(file.create_group("environment"), computing_environment())


def write_modal(group: h5py.Group, chain: ModalChain) -> None:
    """Write FRF, synthesis, poles of all orders, modes, curves and provenance."""
    _write_frf(group.create_group("frf"), chain.frf)
    _write_frf(group.create_group("synthesis"), chain.result.synthesis)
    write_variable(
        group["synthesis"],
        "missed",
        chain.result.synthesis_error,
        ("frequency",),
        units="1",
        long_name="rms of what the synthesis misses over the rms of the FRF",
    )
    _write_stabilisation(group.create_group("stabilisation"), chain.result)
    _write_modes(group.create_group("modes"), chain.result.model)
    _write_evidence(group["modes"], chain.result)
    _write_provenance(group.create_group("provenance"), chain)
    if chain.amplitude:
        write_amplitude(group.create_group("amplitude"), chain.amplitude)


def _write_frf(group: h5py.Group, frf: Frf) -> None:
    units = FRF_UNITS[frf.kind]
    _axis(group, "frequency", frf.frequency, "Hz")
    write_texts(group, "output_label", frf.outputs, "output", long_name="channel@point")
    write_texts(group, "input_label", frf.inputs, "input", long_name="hit point")
    write_complex(
        group, "frf", frf.response, PAIR, units=units, long_name=frf.kind.value
    )
    if frf.coherence is not None:
        write_variable(
            group, "coherence", frf.coherence, PAIR, units="1", long_name="coherence"
        )
    if frf.variance is not None:
        write_variable(
            group,
            "variance",
            frf.variance,
            PAIR,
            units=f"({units})2",
            long_name="variance of the average",
        )
    write_attributes(
        group,
        {
            "kind": frf.kind.value,
            "added_decay_rate_per_s": frf.added_decay_rate,
            "averages": frf.averages,
            "usable_from": None if frf.usable_band is None else frf.usable_band[0],
            "usable_to": None if frf.usable_band is None else frf.usable_band[1],
        },
    )


def _axis(group: h5py.Group, name: str, values: object, units: str) -> None:
    write_variable(group, name, values, (name,), units=units, long_name=name)


def _write_stabilisation(group: h5py.Group, result: ModalResult) -> None:
    poles = result.stabilisation
    _write_columns(
        group,
        "pole",
        ("order", poles.order, "1"),
        ("natural_frequency", poles.frequency, "Hz"),
        ("damping_ratio", poles.damping_ratio, "1"),
    )
    write_flags(
        group,
        "stable",
        poles.stable.astype("i1"),
        ("pole",),
        meanings=("no", "yes"),
        long_name="stable in frequency, damping and shape",
    )


def _write_modes(group: h5py.Group, model: ModalModel) -> None:
    _write_columns(
        group,
        "mode",
        ("natural_frequency", model.natural_frequency, "Hz"),
        ("natural_frequency_sd", model.frequency_sd, "Hz"),
        ("damping_ratio", model.damping_ratio, "1"),
        ("damping_ratio_sd", model.damping_ratio_sd, "1"),
    )
    write_flags(
        group,
        "chosen_by",
        model.by_hand.astype("i1"),
        ("mode",),
        meanings=("automatic", "hand"),
        long_name="who chose the mode",
    )
    write_texts(
        group, "output_label", model.outputs, "output", long_name="channel@point"
    )
    write_texts(group, "input_label", model.inputs, "input", long_name="hit point")
    write_complex(
        group,
        "residue",
        model.residues,
        ("mode", "output", "input"),
        units="m s-1 N-1",
        long_name="residue of the receptance",
    )


def _write_evidence(group: h5py.Group, result: ModalResult) -> None:
    """Write what each mode rests on, and what the Kalman stage did there."""
    model, gain = result.model, result.stage_gain
    rated = rate_modes(model, result.stabilisation.orders.size)
    _write_columns(
        group,
        "mode",
        ("natural_frequency_systematic", rated.frequency_error, "Hz"),
        ("damping_ratio_systematic", rated.damping_error, "1"),
        ("significance", model.significance, "1"),
        ("misfit", model.residual_ratio, "1"),
        ("stable_orders", model.stable_orders, "1"),
    )
    dims = ("mode", "output", "input")
    for name, values, own, units in (
        ("residue_sd", model.residues_sd, dims, "m s-1 N-1"),
        ("shape_sd", model.shapes_sd, dims[:2], "1"),
    ):
        words = f"{name.removesuffix('_sd')}: standard uncertainty of the part"
        write_complex(group, name, values, own, units=units, long_name=words)
    band = {"band_from": result.band[0], "band_to": result.band[1]}
    write_attributes(group, band)
    if gain is not None:
        _write_columns(
            group,
            "mode",
            ("kalman_gain", gain.gain, "1"),
            ("kalman_phase", gain.phase, "rad"),
        )
        write_attributes(group, {"kalman_model": gain.settings.model.value})


def _write_columns(
    group: h5py.Group, dim: str, *columns: tuple[str, FloatArray | IntArray, str]
) -> None:
    """Write variables of one dimension, each a name, its values and its unit."""
    for name, values, units in columns:
        words = name.replace("_", " ")
        write_variable(group, name, values, (dim,), units=units, long_name=words)


def _write_provenance(group: h5py.Group, chain: ModalChain) -> None:
    steps = chain.provenance
    write_texts(group, "step_name", [s.name for s in steps], "step", long_name="what")
    details = ["; ".join(f"{k}={v}" for k, v in s.detail) or "-" for s in steps]
    write_texts(group, "detail", details, "step", long_name="how and why")
