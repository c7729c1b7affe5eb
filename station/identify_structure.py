# SPDX-License-Identifier: MIT
"""``jointbench identify`` of meshed structures: sessions to joints."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import BadData, UsageError
from jointbench.analysis.identification import IdentificationVerdict
from jointbench.analysis.measured_modes import MeasuredModes
from jointbench.analysis.structures.cache import cached, content_key
from jointbench.analysis.structures.evidence import Evidence
from jointbench.analysis.structures.identify_structure import identify_structure
from jointbench.analysis.structures.joint_result import (
    StructureIdentification,
    structure_json,
)
from jointbench.analysis.structures.reduced import ReducedModel
from jointbench.analysis.structures.reduction import reduce_structure
from jointbench.analysis.structures.sensors import Sensor, readout, sensor_rows
from jointbench.analysis.structures.structure import Structure
from jointbench.signal.frf import Frf
from jointbench.signal.modal_model import ModalModel
from jointbench.signal.modes import ModalSettings
from jointbench.station.chain import ChainSettings, ModalChain, run_chain
from jointbench.station.inputs import read_recordings
from jointbench.station.modal import parse_band
from jointbench.station.output import console, table, with_sd, working, write_json
from jointbench.station.outputs import check_outputs
from jointbench.station.structure_model import (
    StructureModel,
    sensors_of,
    structure_of,
)
from jointbench.station.toml_file import read_toml

RIGID_MODES = 6
SPARE_MODES = 4
SENSITIVITY_SD = 0.02
"""Relative sd of a shape component [-]: accelerometers of one batch differ by 2 %."""


def run_identify_structure(
    model: Path,
    sessions: Sequence[Path],
    *,
    band: str | None,
    cache: Path | None,
    report: Path | None,
    json_target: str | None,
) -> bool:
    """Identify the joints of a structure, show and write them.

    Returns:
        Whether the structure can have what was measured, and the full mesh agrees.
    """
    check_outputs([model, *sessions], [json_target, report])
    settings = read_toml(model, StructureModel)
    with working("meshing"):
        structure = structure_of(settings, model.parent)
    chains = _chains(sessions, band)
    sensors = {**sensors_of(settings.hits), **sensors_of(settings.sensors)}
    with working("reducing, identifying joints"):
        reduced = _reduced(structure, settings, chains, sensors, cache)
        evidence = _all_evidence(structure, reduced, settings, chains)
        result = identify_structure(
            reduced,
            evidence,
            sought=settings.identify.sought,
            shared=settings.identify.shared,
            structure=structure,
        )
    show_structure(result, json_target)
    write_json(json_target, structure_json(result, reduced.names))
    if report is not None:
        from jointbench.station.report_structure import write_structure_report

        write_structure_report(report, model.name, structure, reduced, result)
    return result.verdict is not IdentificationVerdict.INCONSISTENT and all(
        one.agrees for one in result.full_check
    )


def _chains(sessions: Sequence[Path], band: str | None) -> dict[str, ModalChain]:
    """Take every session to modes; each is a state of its own."""
    settings = ChainSettings(modal=ModalSettings(band=parse_band(band)))
    chains: dict[str, ModalChain] = {}
    for path in sessions:
        with working(f"fitting modes of {path.name}"):
            recordings = read_recordings([path], columns=None, point="1")
            chains[path.stem] = run_chain(recordings, settings)
    return chains


def _reduced(
    structure: Structure,
    settings: StructureModel,
    chains: dict[str, ModalChain],
    sensors: dict[str, Sensor],
    cache: Path | None,
) -> ReducedModel:
    counts = [chain.result.model.natural_frequency.size for chain in chains.values()]
    if settings.measured is not None:
        counts.append(len(settings.measured.frequencies))
    if not counts:
        raise UsageError("nothing was measured: give a session, or [measured] in TOML")
    modes = settings.identify.modes or RIGID_MODES + max(counts) + SPARE_MODES
    box = settings.identify.stiffness_box
    loads = sensor_rows(structure, list(sensors.values())) if sensors else None
    key = content_key(structure, modes, box, sorted(map(repr, sensors.values())))
    return cached(
        cache,
        key,
        lambda: reduce_structure(structure, modes=modes, box=box, loads=loads),
    )


def _all_evidence(
    structure: Structure,
    reduced: ReducedModel,
    settings: StructureModel,
    chains: dict[str, ModalChain],
) -> list[Evidence]:
    none = np.zeros((0, reduced.size))
    found = []
    if settings.measured is not None:
        frequency = np.array(settings.measured.frequencies)
        sd = settings.measured.relative_sd * frequency
        found.append(
            Evidence("measured", MeasuredModes(frequency, sd), None, none, none)
        )
    for label, chain in chains.items():
        found.append(_evidence(label, structure, reduced, settings, chain))
    return found


def _evidence(
    label: str,
    structure: Structure,
    reduced: ReducedModel,
    settings: StructureModel,
    chain: ModalChain,
) -> Evidence:
    modes, frf = chain.result.model, chain.frf
    none = np.zeros((0, reduced.size))
    if settings.identify.data == "frequencies":
        plain = MeasuredModes(modes.natural_frequency, modes.frequency_sd)
        return Evidence(label, plain, None, none, none)
    sensors = sensors_of(settings.sensors)
    outputs = readout(structure, reduced, _named(frf.outputs, sensors, "sensors"))
    if settings.identify.data == "modes":
        return Evidence(label, _measured(modes), None, outputs, none)
    hits = {**sensors, **sensors_of(settings.hits)}
    inputs = readout(structure, reduced, _named(frf.inputs, hits, "hits"))
    low, high = chain.result.band
    picked = _thinned(frf, low, high, settings.identify.lines)
    return Evidence(label, None, picked, outputs, inputs)


def _named(labels: Sequence[str], places: dict[str, Sensor], kind: str) -> list[Sensor]:
    """Return the places of channels ``"channel@point"`` or of hit points."""
    names = [label.partition("@")[0] for label in labels]
    missing = [name for name in names if name not in places]
    if missing:
        raise BadData(
            f"{missing[0]!r} of the session is not among [{kind}.*] of the model, "
            f"which are {list(places)}; say where it sits"
        )
    return [places[name] for name in names]


def _measured(modes: ModalModel) -> MeasuredModes:
    shapes = modes.shapes
    largest: FloatArray = np.abs(shapes).max(axis=1, keepdims=True)
    several = shapes.shape[1] > 1
    return MeasuredModes(
        natural_frequency=modes.natural_frequency,
        frequency_sd=modes.frequency_sd,
        damping_ratio=modes.damping_ratio,
        damping_ratio_sd=modes.damping_ratio_sd,
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


def show_structure(result: StructureIdentification, json_target: str | None) -> None:
    """Print the identified parameters, the solutions and the full check."""
    screen = console(json_target)
    rows = [
        (
            one.name,
            with_sd(one.value, one.sd),
            one.unit,
            "yes" if one.identifiable else "no",
        )
        for one in result.parameters
    ]
    title = f"Joints: {result.verdict.value} (± one standard deviation)"
    screen.print(table(title, ("parameter", "value", "unit", "identifiable"), rows))
    for reason in result.reasons:
        screen.print(f"  {reason}", markup=False)
    for state in result.states:
        pairs = [
            (f"{m:.6g}", f"{p:.6g}", f"{100 * (p / m - 1):+.3f} %")
            for m, p in zip(state.measured, state.predicted, strict=False)
        ]
        if pairs:
            columns = ("measured [Hz]", "predicted [Hz]", "error")
            screen.print(table(f"Modes of {state.label}", columns, pairs))
    for check in result.full_check:
        word = "agrees with" if check.agrees else "DISAGREES with"
        worst = (np.abs(check.reduced - check.full) / check.full).max(initial=0.0)
        screen.print(
            f"{check.label}: one full solve {word} the reduced model "
            f"(largest difference {worst:.1e} of the frequency)"
        )
