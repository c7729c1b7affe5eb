# SPDX-License-Identifier: MIT
"""FRF files as SDynPy, pyuff and pyFRF write them, of hits that are given as samples.

The peers are the optional extra `benchmarks`. Each file holds the FRFs that a peer
estimated from the samples, written by the peer's own functions or, where it has none
(pyFRF), by `numpy.save`, as its examples do.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray

ACCELERANCE = "frf:m/s^2/N"
_FREQUENCY, _ACCELERATION, _FORCE = 18, 12, 13
_FRF, _COHERENCE = 4, 6
_DOWN, _UP = 3, -3
"""Codes of data set 58: axes, function types, directions +z and -z."""


@dataclass(frozen=True, slots=True, eq=False)
class Hits:
    """Hits of one structure, all records of one length.

    Attributes:
        name: of the structure.
        rate: [Hz].
        force: [N], shape (n_inputs, n_hits, n_samples); one input at a time.
        acceleration: [m/s^2], shape (n_inputs, n_hits, n_outputs, n_samples).
        nodes: of the outputs, shape (n_outputs,).
        drives: outputs where the hammer strikes, shape (n_inputs,).
        band: that is fitted [Hz].
    """

    name: str
    rate: float
    force: FloatArray
    acceleration: FloatArray
    nodes: tuple[int, ...]
    drives: tuple[int, ...]
    band: tuple[float, float]

    @property
    def step(self) -> float:
        """Distance of the lines of a whole record [Hz]."""
        return self.rate / self.force.shape[-1]


@dataclass(frozen=True, slots=True, eq=False)
class PeerFrf:
    """FRFs that a peer estimated.

    Attributes:
        frequency: [Hz], shape (n_lines,).
        response: accelerance, shape (n_outputs, n_inputs, n_lines).
        coherence: same shape.
    """

    frequency: FloatArray
    response: ComplexArray
    coherence: FloatArray


def airplane(hits: int = 3, seed: int = 1) -> Hits:
    """Return hits on the demonstration airplane of SDynPy, by its own integration.

    Six of its modes below 110 Hz that the outputs show, with 0.8 to 2 % of damping;
    two hit points, six outputs; records of 32 s, after which the motion has decayed;
    white noise of 0.1 % of the rms of the motion.
    """
    import sdynpy as sdp
    from sdynpy.demo import beam_airplane

    whole = beam_airplane.create_models()[0]
    nodes = np.unique(whole.coordinate.node)[[3, 9, 20, 31, 45, 60]]
    outputs = sdp.coordinate_array(nodes, _DOWN)
    shapes = whole.eigensolution(maximum_frequency=110.0)
    seen = np.abs(shapes.system().transformation_matrix_at_coordinates(outputs)).sum(0)
    kept: list[int] = []
    for mode in np.argsort(-seen):
        far = all(abs(shapes.frequency[mode] - shapes.frequency[k]) > 5.0 for k in kept)
        if shapes.frequency[mode] > 5.0 and far and len(kept) < 6:
            kept.append(int(mode))
    modes = shapes[sorted(kept)]
    modes.damping = np.array([0.02, 0.015, 0.01, 0.01, 0.012, 0.008])
    system = modes.system()
    drives, lines, rate = (0, 3), 8192, 256.0
    force = np.zeros((2, hits, lines))
    motion = np.zeros((2, hits, nodes.size, lines))
    rng = np.random.default_rng(seed)
    for row, drive in enumerate(drives):
        for hit in range(hits):
            pulse = _pulse(lines, rate, 20.0 + 60.0 * rng.uniform())
            load = sdp.data_array(
                sdp.data.FunctionTypes.TIME_RESPONSE,
                np.arange(lines) / rate,
                pulse,
                outputs[drive : drive + 1],
            )
            made = system.time_integrate(load, responses={2: outputs})
            force[row, hit], motion[row, hit] = pulse, made.ordinate.real
    motion += 1e-3 * motion.std() * rng.normal(size=motion.shape)
    force += 1e-5 * rng.normal(size=force.shape)
    nodes = tuple(int(node) for node in nodes)
    return Hits("airplane of SDynPy", rate, force, motion, nodes, drives, (5.0, 100.0))


def real_hits(folder: Path) -> Hits:
    """Return the three real hits that pyFRF had in its repository."""
    files = sorted(folder.glob("measurements_*.npy"))
    time, force, motion = np.moveaxis(np.array([np.load(f) for f in files]), 1, 0)
    rate = 1.0 / float(np.mean(np.diff(time[0])))
    arrays = force[None], motion[None, :, None]
    return Hits("real hits of pyFRF", round(rate), *arrays, (1,), (0,), (5.0, 5000.0))


def _pulse(lines: int, rate: float, peak: float) -> FloatArray:
    """Return a half sine of 8 ms after a quarter of a second [N]."""
    turn = (np.arange(lines) / rate - 0.25) / 0.008
    return peak * np.sin(np.pi * np.clip(turn, 0.0, 1.0))


def by_pyfrf(hits: Hits) -> PeerFrf:
    """Return H1 and coherence of pyFRF, one input after the other, without windows."""
    from pyFRF import FRF

    responses, coherences = [], []
    for force, motion in zip(hits.force, hits.acceleration, strict=True):
        frf = FRF(
            sampling_freq=round(hits.rate),
            exc=force[:, None],
            resp=motion,
            exc_type="f",
            resp_type="a",
            window="none",
        )
        lines = frf.get_f_axis().size
        responses.append(
            np.asarray(frf.get_FRF(frf_form="accelerance")).reshape(-1, lines)
        )
        coherences.append(np.asarray(frf.get_coherence()).reshape(-1, lines))
        axis = np.asarray(frf.get_f_axis())
    return PeerFrf(axis, np.stack(responses, 1), np.stack(coherences, 1).real)


def by_sdynpy(hits: Hits) -> Any:
    """Return H1 of SDynPy as its own array of functions."""
    import sdynpy as sdp

    outputs = sdp.coordinate_array(np.array(hits.nodes), _DOWN)
    found = []
    kind = sdp.data.FunctionTypes.TIME_RESPONSE
    length = hits.force.shape[-1]
    axis = np.arange(length * hits.force.shape[1]) / hits.rate
    for drive, force, motion in zip(
        hits.drives, hits.force, hits.acceleration, strict=True
    ):
        joined = np.moveaxis(motion, 0, 1).reshape(len(hits.nodes), -1)
        load = sdp.data_array(kind, axis, force.ravel(), outputs[drive : drive + 1])
        answer = sdp.data_array(kind, axis, joined, outputs[:, None])
        found.append(
            sdp.data.TransferFunctionArray.from_time_data(
                load, answer, length, method="H1"
            ).reshape_to_matrix()
        )
    return np.concatenate(found, axis=1)


def write_pyuff(path: Path, hits: Hits, frf: PeerFrf, *, binary: bool) -> None:
    """Write FRFs and coherence by pyuff, as its documentation shows."""
    import pyuff

    file = pyuff.UFF(str(path))
    axes = {
        "abscissa_spacing": 1,
        "abscissa_min": 0.0,
        "abscissa_inc": hits.step,
        "abscissa_spec_data_type": _FREQUENCY,
        "abscissa_axis_units_lab": "Hz",
    }
    for output, drive in np.ndindex(frf.response.shape[:2]):
        place = {
            "rsp_node": hits.nodes[output],
            "rsp_dir": _DOWN,
            "ref_node": hits.nodes[hits.drives[drive]],
            "ref_dir": _UP,
        }
        pair = output, drive
        for function, data in (
            (_FRF, frf.response[pair]),
            (_COHERENCE, frf.coherence[pair].astype(np.complex128)),
        ):
            units = ("m/s^2", "N") if function == _FRF else ("NONE", "NONE")
            made = pyuff.prepare_58(
                binary=int(binary),
                func_type=function,
                id1="FRF",
                ord_data_type=6,
                num_pts=frf.frequency.size,
                x=frf.frequency,
                data=data,
                ordinate_spec_data_type=_ACCELERATION if function == _FRF else 0,
                ordinate_axis_units_lab=units[0],
                orddenom_spec_data_type=_FORCE if function == _FRF else 0,
                orddenom_axis_units_lab=units[1],
                **axes,
                **place,
            )
            file.write_sets(made, mode="add")


def write_sdynpy_universal(path: Path, frf: Any) -> None:
    """Write FRFs as data sets 58 by the writer of SDynPy."""
    from sdynpy.fileio.sdynpy_uff_datasets import sdynpy_uff_dataset_58 as uff58

    sets = []
    for one in frf.flatten():
        response, reference = one.coordinate
        made = uff58.Sdynpy_UFF_Dataset_58(
            *("FRF", "NONE", "NONE", "NONE", "NONE"),
            *(_FRF, 0, 1, 0),
            *("NONE", int(response.node), int(response.direction)),
            *("NONE", int(reference.node), int(reference.direction)),
            *(_FREQUENCY, 0, 0, 0, "Frequency", "Hz"),
            *(_ACCELERATION, 0, 0, 0, "Acceleration", "m/s^2"),
            *(_FORCE, 0, 0, 0, "Force", "N"),
            *(0, 0, 0, 0, "NONE", "NONE", 0.0),
            np.asarray(one.abscissa),
            np.asarray(one.ordinate),
        )
        sets.append(f"    -1\n    58\n{made.write_string()}    -1\n")
    path.write_text("".join(sets))


def files_of_peers(folder: Path, hits: Hits) -> list[tuple[str, Path, str | None, int]]:
    """Write every file; return what wrote it, its path, --columns and --averages."""
    made: list[tuple[str, Path, str | None, int]] = []
    averages = hits.force.shape[1]

    def add(
        words: str, name: str, write: Callable[[Path], object], columns: str | None
    ) -> None:
        path = folder / name
        write(path)
        made.append((words, path, columns, 0))

    whole = by_pyfrf(hits)
    arrays = {"f": whole.frequency, "H": whole.response, "c": whole.coherence}
    single = f"{ACCELERANCE}@{hits.step!r}Hz"
    add("pyFRF, `numpy.save`", "h1.npy", lambda p: np.save(p, whole.response), single)
    named = "frequency.f:Hz,frf.H:m/s^2/N"
    add("pyFRF, `numpy.savez`", "h1.npz", lambda p: np.savez(p, **arrays), named)
    made.append(
        (f"{made[-1][0]} with coherence", made[-1][1], f"{named},coherence.c", averages)
    )
    for binary in (False, True):
        name = f"pyuff-{'binary' if binary else 'text'}.uff"
        words = f"pyFRF, pyuff ({'58b' if binary else '58'})"
        add(
            words, name, lambda p, b=binary: write_pyuff(p, hits, whole, binary=b), None
        )
        made.append((f"{words} with coherence", made[-1][1], None, averages))
    own = by_sdynpy(hits)
    add("SDynPy, `save`", "sdynpy.npz", lambda p: own.save(str(p)), ACCELERANCE)
    add("SDynPy, `savemat`", "sdynpy.mat", lambda p: own.savemat(str(p)), ACCELERANCE)
    add(
        "SDynPy, data set 58",
        "sdynpy.uff",
        lambda p: write_sdynpy_universal(p, own),
        None,
    )
    return made


def read_by_peers(path: Path) -> dict[str, Sequence[ComplexArray]]:
    """Return the FRFs that pyuff and SDynPy find in a universal file, in its order."""
    import pyuff
    import sdynpy as sdp

    sets = pyuff.UFF(str(path)).read_sets()
    listed = sets if isinstance(sets, list) else [sets]
    by_pyuff = [
        np.asarray(one["data"])
        for one in listed
        if one["type"] == 58 and one["func_type"] == _FRF
    ]
    content = sdp.data.NDDataArray.from_unv(sdp.uff.readuff(str(path)))
    kinds = content if isinstance(content, (list, tuple)) else [content]
    functions = [
        one
        for kind in kinds
        for one in np.atleast_1d(kind.flatten())
        if kind.function_type == sdp.data.FunctionTypes.FREQUENCY_RESPONSE_FUNCTION
    ]
    return {
        "pyuff": by_pyuff,
        "SDynPy": [np.asarray(one.ordinate) for one in functions],
    }
