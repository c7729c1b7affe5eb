# SPDX-License-Identifier: MIT
"""What sessions say of a structure: a state for each session and preload."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.session_file.session_origin import any_simulated
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.analysis.structures.identification.frf_gains import FrfGains
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.mounted_sensors import (
    MountedSensor,
    readout,
)
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel
from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.signal.modal.modes import ModalSettings
from jointbench.station.files.frf_files import read_frf
from jointbench.station.files.input_files import is_session_name, read_recordings
from jointbench.station.joints.structure_model import StructureModel, sensors_of
from jointbench.station.joints.structure_tables import IdentifyTable
from jointbench.station.pipeline.chain import (
    ChainSettings,
    ModalChain,
    frf_chain,
    judge_hits,
    judged_modes,
)
from jointbench.station.pipeline.modal_options import parse_band
from jointbench.station.pipeline.recordings_by_preload import by_preload, preload_sd
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.screen.terminal import working

MEASURED_LABEL = "measured"
"""State of the frequencies that the model file itself holds."""
SENSITIVITY_SD = 0.02
"""Relative sd of a shape component [-]: accelerometers of one batch differ by 2 %."""


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredState:
    """A structure as it was measured under one preload.

    Attributes:
        preload: on the joint [N], None where the session does not say.
        chain: from its hits to modes.
        preload_sd: its standard uncertainty where it was measured [N], else None.
        simulated: whether the instruments were.
    """

    preload: float | None
    chain: ModalChain
    preload_sd: float | None = None
    simulated: bool = False


def measured_states(
    sessions: Sequence[Path], band: str | None, options: FrfOptions
) -> dict[str, MeasuredState]:
    """Take every session, and every preload in it, to modes; and every file of FRFs.

    Args:
        sessions: files; a state is named after its file and, where the session holds
            several preloads, "@" and the preload. A file of FRFs is one state.
        band: as typed, or None.
        options: what the user states about files that are no sessions.
    """
    settings = ChainSettings(modal=ModalSettings(band=parse_band(band)))
    found: dict[str, MeasuredState] = {}
    for path in sessions:
        frf = read_frf([path], options)
        if frf is not None:
            with working(f"fitting modes of {path.stem}"):
                chain = frf_chain(frf, settings, StageRun())
            found[path.stem] = MeasuredState(None, chain)
            continue
        columns, point = options.columns, options.point
        stored = read_recordings([path], columns=columns, point=point)
        simulated = is_session_name(path) and any_simulated([path])
        groups = by_preload(judge_hits(stored, settings))
        for preload, recordings in groups:
            label = path.stem
            if len(groups) > 1:
                label += "@" + ("none" if preload is None else f"{preload:g}N")
            with working(f"fitting modes of {label}"):
                chain = judged_modes(recordings, settings, preload=preload)
            deviation = preload_sd(recordings)
            found[label] = MeasuredState(preload, chain, deviation, simulated)
    return found


def all_evidence(
    structure: Structure,
    reduced: ReducedModel,
    settings: StructureModel,
    measured: dict[str, MeasuredState],
) -> list[StructureEvidence]:
    """Return what was measured, state by state, printed frequencies first."""
    none = np.zeros((0, reduced.size))
    found = []
    if settings.measured is not None:
        frequency = np.array(settings.measured.frequencies)
        sd = settings.measured.relative_sd * frequency
        found.append(
            StructureEvidence(
                MEASURED_LABEL, MeasuredModes(frequency, sd), None, none, none
            )
        )
    for label, state in measured.items():
        found.append(_evidence(label, structure, reduced, settings, state.chain))
    return found


def _evidence(
    label: str,
    structure: Structure,
    reduced: ReducedModel,
    settings: StructureModel,
    chain: ModalChain,
) -> StructureEvidence:
    modes, frf = chain.result.model, chain.frf
    none = np.zeros((0, reduced.size))
    if settings.identify.data == "frequencies":
        plain = _measured(modes, settings.identify)
        plain = MeasuredModes(plain.natural_frequency, plain.frequency_sd)
        return StructureEvidence(label, plain, None, none, none)
    sensors = sensors_of(settings.sensors)
    outputs = readout(
        structure, reduced, named_sensors(frf.outputs, sensors, "sensors")
    )
    if settings.identify.data == "modes":
        return StructureEvidence(
            label, _measured(modes, settings.identify), None, outputs, none
        )
    hits = {**sensors, **sensors_of(settings.hits)}
    inputs = readout(structure, reduced, named_sensors(frf.inputs, hits, "hits"))
    low, high = chain.result.band
    picked = _thinned(frf, low, high, settings.identify.lines)
    gains = FrfGains(settings.identify.gain_sd, settings.identify.force_sd)
    return StructureEvidence(label, None, picked, outputs, inputs, gains=gains)


def named_sensors(
    labels: Sequence[str], places: dict[str, MountedSensor], kind: str
) -> list[MountedSensor]:
    """Return the places of channels ``"channel@point"`` or of hit points.

    Raises:
        BadData: one of them has none.
    """
    require_named(labels, places, kind)
    return [places[label.partition("@")[0]] for label in labels]


def require_named(
    labels: Sequence[str], places: dict[str, MountedSensor], kind: str
) -> None:
    """Require a place for channels ``"channel@point"`` or for hit points.

    Raises:
        BadData: one of them has none.
    """
    names = [label.partition("@")[0] for label in labels]
    missing = [name for name in names if name not in places]
    if missing:
        raise BadData(
            f"{missing[0]!r} of the measurement is not among [{kind}.*] of the model, "
            f"which are {list(places)}; add [{kind}.{missing[0]}] with body, "
            "position and direction"
        )


def _measured(modes: ModalModel, trust: IdentifyTable) -> MeasuredModes:
    """Return modes, their uncertainty widened by what the model is good for."""
    shapes = modes.shapes
    largest: FloatArray = np.abs(shapes).max(axis=1, keepdims=True)
    several = shapes.shape[1] > 1
    return MeasuredModes(
        natural_frequency=modes.natural_frequency,
        frequency_sd=np.hypot(
            modes.frequency_sd, trust.frequency_sd * modes.natural_frequency
        ),
        damping_ratio=modes.damping_ratio,
        damping_ratio_sd=np.hypot(
            modes.damping_ratio_sd, trust.damping_sd * modes.damping_ratio
        ),
        shapes=shapes if several else None,
        shape_sd=SENSITIVITY_SD * np.broadcast_to(largest, shapes.shape)
        if several
        else None,
        outputs=modes.outputs,
    )


def _thinned(frf: Frf, low: float, high: float, most: int) -> Frf:
    """Return the lines of a band, at most so many."""
    inside = np.flatnonzero((frf.frequency >= low) & (frf.frequency <= high))
    if not inside.size:
        raise BadData(f"no FRF line between {low:g} and {high:g} Hz; widen --band")
    step = -(-inside.size // most)
    chosen = inside[::step]
    return Frf(
        frequency=frf.frequency[chosen],
        response=frf.response[:, :, chosen],
        kind=frf.kind,
        variance=None if frf.variance is None else frf.variance[:, :, chosen],
        added_decay_rate=frf.added_decay_rate,
        outputs=frf.outputs,
        inputs=frf.inputs,
    )
