# SPDX-License-Identifier: MIT
"""A measured structure beside its identified model, state by state: the work."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.analysis.structures.agreement.compare_structure import (
    Agreement,
    ComparedPlaces,
    compare_structure,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import scaled_structure
from jointbench.analysis.structures.reduction.mounted_sensors import (
    MountedSensor,
    readout,
    sensor_rows,
)
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel
from jointbench.analysis.structures.reduction.reduction_cache import (
    cached,
    content_key,
)
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.identify_checks import SPARE_MODES
from jointbench.station.joints.state_values import (
    IdentifiedFile,
    StateValues,
    state_labels,
    state_values,
)
from jointbench.station.joints.structure_model import (
    StructureModel,
    sensors_of,
    structure_of,
)
from jointbench.station.joints.structure_states import (
    MeasuredState,
    measured_states,
    named_sensors,
)
from jointbench.station.screen.terminal import working

_RIGID = 6


@dataclass(frozen=True, slots=True, eq=False)
class ComparedStates:
    """A model beside what was measured of it.

    Attributes:
        states: the comparison of each, by its label.
        simulated: whether a session was.
    """

    states: Mapping[str, Agreement]
    simulated: bool

    @property
    def suspected(self) -> bool:
        """Whether the sign, label or axis of a coordinate is in doubt."""
        return any(one.suspects for one in self.states.values())


def compare_states(
    model: Path,
    identified: IdentifiedFile,
    sessions: Sequence[Path],
    *,
    band: str | None = None,
    cache: Path | None = None,
) -> ComparedStates:
    """Compare sessions with a model.

    Args:
        model: structure model (TOML).
        identified: joints of the model.
        sessions: measured, at least one.
        band: of the modes, as typed.
        cache: folder that keeps reduced structures.

    Raises:
        BadData: the model or a session cannot be used.
    """
    settings = read_toml(model, StructureModel)
    measured = measured_states(sessions, band, FrfOptions())
    with working("reducing, comparing"):
        found = {
            label: agreement_of(
                model,
                settings,
                _state_of(identified, label, len(measured)),
                state,
                cache,
            )
            for label, state in measured.items()
        }
    return ComparedStates(found, any(one.simulated for one in measured.values()))


@dataclass(frozen=True, slots=True)
class _Known:
    """The identified file, and the label of a state in it."""

    file: IdentifiedFile
    label: str | None


def _state_of(file: IdentifiedFile, label: str, count: int) -> _Known:
    """Return the label of a measured state in the file; None where it has none."""
    labels = state_labels(file)
    return _Known(file, label if label in labels or (count > 1 and labels) else None)


def agreement_of(
    path: Path,
    settings: StructureModel,
    known: _Known,
    state: MeasuredState,
    cache: Path | None,
) -> Agreement:
    """Compare one measured state with the model.

    Args:
        path: of the model; files in it are relative to its folder.
        settings: the model.
        known: identified values.
        state: measured.
        cache: folder that keeps reduced structures.
    """
    structure = structure_of(settings, path.parent)
    values = state_values(known.file, structure, settings.identify, known.label)
    structure = _at_values(settings, path, structure, values)
    chain = state.chain
    sensors = sensors_of(settings.sensors)
    out = named_sensors(chain.frf.outputs, sensors, "sensors")
    hits = {**sensors, **sensors_of(settings.hits)}
    inputs = named_sensors(chain.frf.inputs, hits, "hits")
    axes = [_along(one, axis) for one in out for axis in range(3)]
    count = chain.result.model.natural_frequency.size
    reduced = _reduced(structure, settings, [*out, *inputs, *axes], count, cache)
    places = ComparedPlaces(
        readout(structure, reduced, out),
        readout(structure, reduced, inputs),
        readout(structure, reduced, axes),
        np.array([int(np.argmax(np.abs(one.direction))) for one in out]),
    )
    return compare_structure(
        reduced,
        values.joints,
        places,
        chain.result.model,
        chain.frf,
        values.covariance,
        band=chain.result.band,
    )


def _at_values(
    settings: StructureModel, path: Path, structure: Structure, values: StateValues
) -> Structure:
    if values.masses:
        structure = structure_of(settings.with_masses(values.masses), path.parent)
    if values.moduli:
        structure = scaled_structure(structure, values.moduli)
    return structure


def _reduced(
    structure: Structure,
    settings: StructureModel,
    places: Sequence[MountedSensor],
    count: int,
    cache: Path | None,
) -> ReducedModel:
    modes = settings.identify.modes or _RIGID + count + SPARE_MODES
    box = settings.identify.stiffness_box
    loads: FloatArray = sensor_rows(structure, places)
    key = content_key(structure, modes, box, sorted(map(repr, places)))
    return cached(
        cache,
        key,
        lambda: reduce_structure(structure, modes=modes, box=box, loads=loads),
    )


def _along(sensor: MountedSensor, axis: int) -> MountedSensor:
    unit: Mapping[int, tuple[float, float, float]] = {
        0: (1.0, 0.0, 0.0),
        1: (0.0, 1.0, 0.0),
        2: (0.0, 0.0, 1.0),
    }
    return replace(sensor, name=f"{sensor.name} {'xyz'[axis]}", direction=unit[axis])
