# SPDX-License-Identifier: MIT
"""The modes of a results file, as records again: what a report shows.

Files of earlier versions lack some of the evidence; it is NaN, or left out.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.file_access.hdf5_layout import find_group
from jointbench.acquisition.file_access.netcdf_read import (
    read_array,
    read_attribute,
    read_complex,
    read_flags,
    read_integers,
    read_texts,
)
from jointbench.acquisition.records.provenance import Provenance, Step
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.amplitude.amplitude_curve import AmplitudeMode
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.kalman.process_models import (
    KalmanModel,
    KalmanSettings,
    StageGain,
)
from jointbench.signal.modal.modal_model import ModalModel, split_residues
from jointbench.signal.modal.modes import ModalResult, ModalSettings
from jointbench.signal.modal.stabilisation import Stabilisation
from jointbench.station.pipeline.chain import ModalChain
from jointbench.station.results.amplitude_results import read_amplitude
from jointbench.station.results.results_read import open_result

_KEY = re.compile(r"(?:^|; )(\w+)=")
_FILE_NAMES = "\n"


@dataclass(frozen=True, slots=True, eq=False)
class StoredModes:
    """Modes of one group of a results file.

    Attributes:
        preload: [N], or None where the file does not say.
        frf: as measured.
        result: its modes.
        steps: how both came about.
        amplitude: modes over amplitude; None where the file has none.
    """

    preload: float | None
    frf: Frf
    result: ModalResult
    steps: Provenance
    amplitude: tuple[AmplitudeMode, ...] | None = None

    def with_recordings(self, recordings: Sequence[Recording]) -> ModalChain:
        """Return the chain that these modes are the end of."""
        return ModalChain(
            tuple(recordings),
            self.frf,
            self.result,
            self.steps,
            amplitude=self.amplitude or (),
        )


@dataclass(frozen=True, slots=True, eq=False)
class StoredRun:
    """A results file: whose it is, and its modes.

    Attributes:
        path: of the file.
        inputs: SHA-256 of each file that it was made of.
        words: by what and when it was made.
        modes: at each preload.
    """

    path: Path
    inputs: tuple[str, ...]
    words: str
    modes: tuple[StoredModes, ...]


def read_run(path: Path) -> StoredRun:
    """Read the modes of a results file of any layout.

    Raises:
        CorruptedFile: its content is not what its digest says.
        FormatError: it is damaged, or no results file.
        HostileFile: it asks for more than a result would.
    """
    with open_result(path) as file:
        digests = str(read_attribute(file, "input_sha256") or "")
        modes = tuple(_stored(group) for group in _groups(file))
        words = _run_words(file, modes)
    return StoredRun(path, tuple(digests.split(_FILE_NAMES)), words, modes)


def _groups(file: h5py.File) -> Iterator[h5py.Group]:
    if "modes" in file:
        yield file
    below = find_group(file, "modal")
    if below is not None:
        yield from (below[name] for name in sorted(below, key=int))


def _run_words(file: h5py.File, modes: Sequence[StoredModes]) -> str:
    recipe = read_attribute(file, "recipe_name")
    run = "`jointbench modal`" if recipe is None else f"recipe {recipe!r}"
    words = [f"{run}, {read_attribute(file, 'software') or 'version not stated'}"]
    created = read_attribute(file, "created")
    words += [f"of {created}"] if created else []
    asked = _asked(modes[0].steps) if modes else ""
    return " ".join(words) + (f": {asked}" if asked else "")


def _asked(steps: Provenance) -> str:
    """Return the options of a run, as far as its steps record them."""
    details = {step.name: dict(step.detail) for step in steps}
    frf, modes = (details.get(n, {}) for n in ("estimate_frf", "identify_modes"))
    known = (
        ("estimator", frf.get("estimator")),
        ("band", modes.get("band")),
        ("highest order", modes.get("highest_order")),
        ("kept by hand", modes.get("kept_by_hand")),
        ("dropped by hand", modes.get("dropped_by_hand")),
    )
    return "; ".join(f"{name} {value}" for name, value in known if value is not None)


def _stored(group: h5py.Group) -> StoredModes:
    steps = tuple(_steps(group["provenance"]))
    frf, synthesis = (stored_frf(group[n], steps) for n in ("frf", "synthesis"))
    modes = group["modes"]
    model = _model(modes, frf, steps)
    lines = synthesis.frequency
    band = _pair(modes, "band") or (float(lines[0]), float(lines[-1]))
    result = ModalResult(
        model=model,
        stabilisation=_stabilisation(group["stabilisation"]),
        synthesis=synthesis,
        synthesis_error=_missed(group["synthesis"], frf, synthesis),
        settings=ModalSettings(band=band),
        band=band,
        stage_gain=_stage_gain(modes, model),
    )
    preload = read_attribute(group, "preload")
    own = float(preload) if isinstance(preload, int | float) else None
    curves = find_group(group, "amplitude")
    found = None if curves is None else read_amplitude(curves)
    return StoredModes(own, frf, result, steps, found)


def stored_frf(group: h5py.Group, steps: Provenance = ()) -> Frf:
    """Return the FRF of a group, with all that states its noise."""
    decay = read_attribute(group, "added_decay_rate_per_s")
    averages = read_attribute(group, "averages")
    return Frf(
        read_array(group["frequency"]),
        read_complex(group, "frf"),
        FrfKind(str(read_attribute(group, "kind"))),
        coherence=_optional(group, "coherence"),
        variance=_optional(group, "variance"),
        added_decay_rate=float(decay or 0.0),
        outputs=read_texts(group["output_label"]),
        inputs=read_texts(group["input_label"]),
        averages=int(averages or 0),
        provenance=steps,
        usable_band=_pair(group, "usable"),
    )


def _optional(group: h5py.Group, name: str) -> FloatArray | None:
    return read_array(group[name]) if name in group else None


def _pair(group: h5py.Group, name: str) -> tuple[float, float] | None:
    ends = [read_attribute(group, f"{name}_{end}") for end in ("from", "to")]
    low, high = (float(e) if isinstance(e, int | float) else None for e in ends)
    return None if low is None or high is None else (low, high)


def _missed(group: h5py.Group, frf: Frf, synthesis: Frf) -> FloatArray:
    """Return the synthesis error of each line, computed where the file lacks it."""
    stored = _optional(group, "missed")
    if stored is not None:
        return stored
    inside = np.isin(frf.frequency, synthesis.frequency)
    measured = frf.response[:, :, inside]
    missed = np.sum(np.abs(measured - synthesis.response) ** 2, axis=(0, 1))
    whole = np.sum(np.abs(measured) ** 2, axis=(0, 1))
    return np.asarray(np.sqrt(missed / np.where(whole > 0.0, whole, 1.0)))


def _model(group: h5py.Group, frf: Frf, steps: Provenance) -> ModalModel:
    residues = read_complex(group, "residue")
    shapes, participation = split_residues(residues)
    count = residues.shape[0]
    unknown = np.full(count, np.nan)
    orders = group.get("stable_orders")
    significance, residual = (
        _optional(group, name) for name in ("significance", "misfit")
    )
    return ModalModel(
        natural_frequency=read_array(group["natural_frequency"]),
        frequency_sd=read_array(group["natural_frequency_sd"]),
        damping_ratio=read_array(group["damping_ratio"]),
        damping_ratio_sd=read_array(group["damping_ratio_sd"]),
        residues=residues,
        residues_sd=_complex_or_nan(group, "residue_sd", residues.shape),
        shapes=shapes,
        shapes_sd=_complex_or_nan(group, "shape_sd", shapes.shape),
        participation=participation,
        significance=unknown if significance is None else significance,
        residual_ratio=unknown if residual is None else residual,
        stable_orders=np.zeros(count, np.int64)
        if orders is None
        else read_integers(orders),
        by_hand=np.array([w == "hand" for w in read_flags(group["chosen_by"])]),
        outputs=frf.outputs,
        inputs=frf.inputs,
        provenance=steps,
    )


def _complex_or_nan(
    group: h5py.Group, name: str, shape: tuple[int, ...]
) -> ComplexArray:
    if f"{name}_re" in group:
        return read_complex(group, name)
    return np.full(shape, complex(np.nan, np.nan))


def _stabilisation(group: h5py.Group) -> Stabilisation:
    order = read_integers(group["order"])
    frequency = read_array(group["natural_frequency"])
    ratio = read_array(group["damping_ratio"])
    stable = np.array([word == "yes" for word in read_flags(group["stable"])])
    omega = 2.0 * np.pi * frequency
    root = np.sqrt(np.maximum(0.0, 1.0 - ratio**2))
    return Stabilisation(
        order=order,
        pole=omega * (-ratio + 1j * root),
        frequency=frequency,
        damping_ratio=ratio,
        stable_frequency=stable,
        stable_damping=stable.copy(),
        stable_shape=stable.copy(),
        track=np.zeros(order.size, np.int64),
        orders=np.unique(order),
    )


def _stage_gain(group: h5py.Group, model: ModalModel) -> StageGain | None:
    kind = read_attribute(group, "kalman_model")
    if kind is None:
        return None
    return StageGain(
        model.natural_frequency.copy(),
        read_array(group["kalman_gain"]),
        read_array(group["kalman_phase"]),
        KalmanSettings(KalmanModel(str(kind))),
    )


def _steps(group: h5py.Group) -> Iterator[Step]:
    names, texts = read_texts(group["step_name"]), read_texts(group["detail"])
    for name, text in zip(names, texts, strict=True):
        yield Step(name, tuple(_details(text)))


def _details(text: str) -> Iterator[tuple[str, str]]:
    """Yield what ``key=value; key=value`` holds; a value may hold a semicolon."""
    marks = list(_KEY.finditer(text))
    ends = [mark.start() for mark in marks[1:]] + [len(text)]
    for mark, end in zip(marks, ends, strict=True):
        yield mark[1], text[mark.end() : end]
