# SPDX-License-Identifier: MIT
"""Files of other programs for `files_of_others.py`, and what their libraries read."""

import sys
import types
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import scipy.io
from scipy.io import wavfile

RATE, COUNT, HITS = 4096.0, 512, 3
GRAVITY = 9.80665
FACTORS = {
    "N": 1.0,
    "g": GRAVITY,
    "m/s2": 1.0,
    "m/s^2": 1.0,
    "m/s\u00b2": 1.0,
    "(1/N)*(m/s\u00b2)": 1.0,
}
ARRAYS = "time.t:s,force.F:N,acceleration.a:g"


@dataclass(frozen=True, slots=True, eq=False)
class Made:
    """A file, and what its own library reads of it.

    Attributes:
        path: of the file.
        writer: library that wrote it, or layout.
        holds: for the table.
        kind: ``"histories"``, ``"FRFs"`` or ``"nodes"``.
        values: by its library, in SI units, in the order of the file.
        columns: what the user states.
        rate: sample rate as typed.
        full_scale: of whole numbers.
        expected: whether it must be read.
    """

    path: Path
    writer: str
    holds: str
    kind: str
    values: list[np.ndarray]
    columns: str | None = None
    rate: str | None = None
    full_scale: float | None = None
    expected: bool = True

    @property
    def words(self) -> tuple[str, str, str]:
        """Name, writer and content, for the table."""
        return self.path.name, self.writer, self.holds


def samples() -> np.ndarray:
    """Return hits: force [N] and acceleration [g], shape (HITS, 2, COUNT)."""
    rng = np.random.default_rng(5)
    time = np.arange(COUNT) / RATE
    hits = np.zeros((HITS, 2, COUNT))
    for k in range(HITS):
        hits[k, 0, 40:48] = (100 + 20 * k) * np.sin(np.pi * (np.arange(8) + 0.5) / 8)
        late = np.maximum(time - 44 / RATE, 0.0)
        hits[k, 1] = 5 * np.exp(-20 * late) * np.sin(2 * np.pi * 300 * late)
    return hits + 1e-3 * rng.normal(size=hits.shape)


def frfs() -> tuple[np.ndarray, np.ndarray]:
    """Return frequency [Hz] and two accelerances [m/s^2/N]."""
    frequency = np.arange(1.0, 257.0)
    omega, poles = 2 * np.pi * frequency, 2 * np.pi * np.array([[60.0], [150.0]])
    one = -(omega**2) / (poles**2 - omega**2 + 2j * 0.01 * poles * omega)
    return frequency, np.array([one.sum(0), one[0] - one[1]])


def pyuff_files(folder: Path) -> Iterator[Made]:
    """Yield the test files of pyuff, as pyuff reads them."""
    import pyuff

    for path in sorted(folder.iterdir()):
        sets = _sets(pyuff, path)
        nodes = [one for kind, one in sets if kind in (15, 2411)]
        if nodes:
            places = np.column_stack([nodes[0][axis] for axis in "xyz"])
            yield Made(path, "pyuff, tests", "nodes", "nodes", list(places))
            continue
        times = [one for kind, one in sets if kind == 58 and one["func_type"] == 1]
        lines = [one for kind, one in sets if kind == 58 and one["func_type"] == 4]
        kind, found = ("FRFs", lines) if lines else ("histories", times)
        units = [_unit(path, one) for one in found]
        known = bool(found) and all(unit in FACTORS for unit in units)
        words = f"{len(found)} {kind} in {', '.join(sorted(set(units))) or 'none'}"
        values = [
            np.asarray(one["data"]) * FACTORS.get(unit, 1.0)
            for one, unit in zip(found, units, strict=True)
        ]
        values = values if kind == "FRFs" else [np.real(one) for one in values]
        yield Made(path, "pyuff, tests", words, kind, values, expected=known)


def _sets(pyuff: Any, path: Path) -> list[tuple[int, dict[str, Any]]]:
    try:
        file = pyuff.UFF(str(path))
        kinds = [int(kind) for kind in file.get_set_types()]
        return [(kind, dict(file.read_sets(n))) for n, kind in enumerate(kinds)]
    except Exception:  # noqa: BLE001 - it raises whatever its content makes it raise
        return []


def _unit(path: Path, one: dict[str, Any]) -> str:
    """Return the unit of a set; pyuff reads Latin letters as errors."""
    unit = str(one["ordinate_axis_units_lab"]).strip()
    return unit.replace("\ufffd", "\u00b2") if "\ufffd" in unit else unit


def all_made(folder: Path) -> Iterator[Made]:
    """Write the files, and yield them."""
    hits = samples()
    si = hits * np.array([1.0, GRAVITY])[None, :, None]
    rows = [row for hit in si for row in hit]
    yield from _by_pyuff(folder, hits, rows)
    yield from _by_nptdms(folder, hits)
    yield from _by_netcdf(folder, hits, rows)
    yield from _by_matlab(folder, hits, rows)
    yield from _by_numpy(folder, hits, rows)
    yield from _by_sdynpy(folder, hits)


def _by_pyuff(folder: Path, hits: np.ndarray, rows: list[np.ndarray]) -> Iterator[Made]:
    import pyuff

    for binary in (0, 1):
        path = folder / f"three-hits-{'58b' if binary else '58'}.uff"
        file = pyuff.UFF(str(path))
        for hit in hits:
            for row, code, unit, node in ((hit[0], 13, "N", 1), (hit[1], 12, "g", 2)):
                file.write_sets(_set58(row, binary, code, unit, node, 1), "add")
        words = "3 hits: force, acceleration in g"
        yield Made(path, "pyuff", words, "histories", rows)
        path = folder / f"frf-{'58b' if binary else '58'}.uff"
        file = pyuff.UFF(str(path))
        for node, row in enumerate(frfs()[1], 1):
            file.write_sets(_set58(row, binary, 12, "m/s^2/N", node, 4), "add")
        read = [np.asarray(one["data"]) for one in pyuff.UFF(str(path)).read_sets()]
        yield Made(path, "pyuff", "2 FRFs", "FRFs", read)


def _set58(
    row: np.ndarray, binary: int, code: int, unit: str, node: int, kind: int
) -> dict[str, Any]:
    time = kind == 1
    axis = np.arange(row.size) / RATE if time else frfs()[0]
    return {
        "type": 58,
        "binary": binary,
        "func_type": kind,
        "rsp_node": node,
        "rsp_dir": 3,
        "ref_node": 1,
        "ref_dir": 3,
        "data": row,
        "x": axis,
        "id1": "made",
        "rsp_ent_name": "NONE",
        "ref_ent_name": "NONE",
        "abscissa_spacing": 1,
        "abscissa_min": float(axis[0]),
        "abscissa_inc": float(axis[1] - axis[0]),
        "abscissa_spec_data_type": 17 if time else 18,
        "abscissa_axis_units_lab": "s" if time else "Hz",
        "ordinate_spec_data_type": code,
        "ordinate_axis_units_lab": unit,
        "orddenom_spec_data_type": 0 if time else 13,
        "orddenom_axis_units_lab": "NONE" if time else "N",
        "ord_data_type": 4 if time else 6,
        "num_pts": row.size,
        "ver_num": 0,
        "load_case_id": 0,
        "z_axis_value": 0.0,
    }


def _by_nptdms(folder: Path, hits: np.ndarray) -> Iterator[Made]:
    from nptdms import ChannelObject, TdmsFile, TdmsWriter

    path = folder / "labview.tdms"
    with TdmsWriter(path) as writer:
        for name, unit, row in (("F", "N", hits[0, 0]), ("a", "g", hits[0, 1])):
            about = {"unit_string": unit, "wf_increment": 1 / RATE}
            writer.write_segment([ChannelObject("hits", name, row, about)])
    with TdmsFile.open(path) as file:
        read = [np.asarray(c[:]) for c in file["hits"].channels()]
    values = [read[0], GRAVITY * read[1]]
    yield Made(path, "npTDMS", "force, acceleration in g", "histories", values)


def _by_netcdf(
    folder: Path, hits: np.ndarray, rows: list[np.ndarray]
) -> Iterator[Made]:
    import xarray

    path = folder / "rattlesnake.nc4"
    with h5py.File(path, "w") as file:
        file.attrs["sample_rate"] = RATE
        file.create_dataset("time_data", data=hits[0])
        table = file.create_group("channels")
        for name, texts in (
            ("node_number", ["1", "2"]),
            ("node_direction", ["Z+", "Z+"]),
            ("unit", ["N", "g"]),
        ):
            kind = h5py.string_dtype()
            table.create_dataset(name, data=np.array(texts, dtype=object), dtype=kind)
    yield Made(path, "layout of Rattlesnake", "2 channels", "histories", rows[:2])
    content = xarray.Dataset(
        {
            "F": (("hit", "time"), hits[:, 0], {"units": "N"}),
            "a": (("hit", "time"), hits[:, 1], {"units": "g"}),
        },
        coords={"time": ("time", np.arange(COUNT) / RATE, {"units": "s"})},
    )
    engines: tuple[Any, ...] = ("h5netcdf", "scipy", "netcdf4")
    for engine in engines:
        path = folder / f"xarray-{engine}.nc"
        content.to_netcdf(path, engine=engine)
        with xarray.open_dataset(path, engine=engine) as read:
            values = [
                v for k in range(HITS) for v in (read.F.values[k], read.a.values[k])
            ]
        values = [v * (1.0, GRAVITY)[i % 2] for i, v in enumerate(values)]
        words = f"3 hits, engine {engine}"
        yield Made(path, "xarray", words, "histories", values)
    frequency, response = frfs()
    path = folder / "xarray-frf.nc"
    xarray.Dataset(
        {"H": (("output", "frequency"), response, {"units": "m s-2 N-1"})},
        coords={
            "frequency": ("frequency", frequency, {"units": "Hz"}),
            "output": ["a1", "a2"],
        },
    ).to_netcdf(path, engine="h5netcdf")
    yield Made(path, "xarray", "2 complex FRFs", "FRFs", list(response))


def testlab(values: np.ndarray, unit: str, label: str, kind: str) -> dict[str, Any]:
    """Return a struct as Simcenter Testlab exports it."""
    time = kind == "time"
    first, step = (0.0, 1 / RATE) if time else (1.0, 1.0)
    return {
        "x_values": {
            "start_value": first,
            "increment": step,
            "number_of_values": float(values.shape[0]),
            "quantity": {"label": "s" if time else "Hz"},
        },
        "y_values": {
            "values": values,
            "quantity": {"label": unit, "unit_transformation": {"factor": 1.0}},
        },
        "function_record": {
            "name": kind,
            "primary_channel": {"point_info": {"label": label}},
            "reference_channel": {"point_info": {"label": "plate:1:+Z"}},
        },
    }


def _by_matlab(
    folder: Path, hits: np.ndarray, rows: list[np.ndarray]
) -> Iterator[Made]:
    response = frfs()[1]
    layout = "layout of Testlab"
    content = {}
    for k, (force, motion) in enumerate(hits):
        content[f"Force_{k}"] = testlab(force, "N", "hammer", "time")
        content[f"Acc_{k}"] = testlab(motion, "g", "plate:2:+Z", "time")
    lines = {
        f"FRF_{k}": testlab(one, "m/s^2/N", f"plate:{k}:+Z", "FRF")
        for k, one in enumerate(response)
    }
    for suffix, write in (("v5", scipy.io.savemat), ("v73", write_v73)):
        path = folder / f"testlab-hits-{suffix}.mat"
        write(path, content)
        order = rows if suffix == "v5" else _sorted_rows(content)
        yield Made(path, layout, f"3 hits, {suffix}", "histories", order)
        path = folder / f"testlab-frf-{suffix}.mat"
        write(path, lines)
        yield Made(path, layout, f"2 FRFs, {suffix}", "FRFs", list(response))
    arrays = {"t": np.arange(COUNT) / RATE, "F": hits[:, 0].T, "a": hits[:, 1].T}
    for suffix, write in (("v5", scipy.io.savemat), ("v73", write_v73)):
        path = folder / f"variables-{suffix}.mat"
        write(path, arrays)
        words = "tables of samples and hits"
        writer = "SciPy" if suffix == "v5" else "h5py, layout of MATLAB"
        yield Made(path, writer, words, "histories", rows, ARRAYS)


def _sorted_rows(content: dict[str, Any]) -> list[np.ndarray]:
    """Return the rows as HDF5 lists them: by name; of each hit Acc before Force."""
    names = [n for k in range(HITS) for n in (f"Acc_{k}", f"Force_{k}")]
    scale = {"A": GRAVITY, "F": 1.0}
    return [content[n]["y_values"]["values"] * scale[n[0]] for n in names]


def write_v73(path: Path, content: dict[str, Any]) -> None:
    """Write variables as `save -v7.3` stores them."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in content.items():
            _put(file, name, value)
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


def _put(group: h5py.Group, name: str, value: Any) -> None:
    if isinstance(value, dict):
        inner = group.create_group(name)
        inner.attrs["MATLAB_class"] = np.bytes_("struct")
        for key, one in value.items():
            _put(inner, key, one)
        return
    if isinstance(value, str):
        codes = np.array([[ord(letter)] for letter in value], np.uint16)
        group[name] = codes
        group[name].attrs["MATLAB_class"] = np.bytes_("char")
        group[name].attrs["MATLAB_int_decode"] = np.int32(2)
        return
    array = np.atleast_2d(np.asarray(value))
    if np.iscomplexobj(array):
        pair = np.zeros(array.shape, [("real", "<f8"), ("imag", "<f8")])
        pair["real"], pair["imag"] = array.real, array.imag
        array = pair
    group[name] = array if array.shape[0] == 1 else array.T
    group[name].attrs["MATLAB_class"] = np.bytes_("double")


def _by_numpy(folder: Path, hits: np.ndarray, rows: list[np.ndarray]) -> Iterator[Made]:
    path = folder / "hits.npz"
    np.savez(path, t=np.arange(COUNT) / RATE, F=hits[:, 0], a=hits[:, 1])
    yield Made(path, "NumPy", "arrays of 3 hits", "histories", rows, ARRAYS)
    path, order = folder / "cube.npy", "force:N,acceleration:g"
    np.save(path, hits)
    words = "3 hits, no times"
    yield Made(path, "NumPy", words, "histories", rows, order, "4096 Hz")
    path = folder / "hit.npy"
    np.save(path, hits[0])
    words = "1 hit, no times"
    yield Made(path, "NumPy", words, "histories", rows[:2], order, "4096 Hz")
    path = folder / "comma.csv"
    with path.open("w", encoding="latin-1") as file:
        file.write("Zeit;Kraft;Beschleunigung\ns;N;g\n")
        for k in range(COUNT):
            cells = (f"{k / RATE:.9f}", *(f"{row[k]:.9e}" for row in hits[0]))
            file.write(";".join(cells).replace(".", ",") + "\n")
    words = "decimal commas, unit row"
    yield Made(path, "text", words, "histories", rows[:2])
    path = folder / "hit.wav"
    scale = np.array([200.0, 20.0])
    wavfile.write(path, int(RATE), (hits[0] / scale[:, None]).T.astype(np.float32))
    read = wavfile.read(path)[1].T.astype(float)
    columns = "force:V@5mV/N,acceleration:V@50mV/g"
    values = [read[0] / 5e-3, read[1] / 50e-3 * GRAVITY]
    yield Made(path, "SciPy", "2 channels", "histories", values, columns)


def _by_sdynpy(folder: Path, hits: np.ndarray) -> Iterator[Made]:
    sdynpy = import_sdynpy()
    if sdynpy is None:
        return
    frequency, response = frfs()
    places = sdynpy.coordinate_array([[1, 1], [2, 1]], 3)
    types = sdynpy.data.FunctionTypes
    kind = types.FREQUENCY_RESPONSE_FUNCTION
    lines = sdynpy.data_array(kind, frequency, response, places)
    unit = "frf:m/s^2/N"
    path = folder / "sdynpy-frf.npz"
    lines.save(str(path))
    yield Made(path, "SDynPy, save", "2 FRFs", "FRFs", list(response), unit)
    path = folder / "sdynpy-frf.mat"
    lines.savemat(str(path))
    yield Made(path, "SDynPy, savemat", "2 FRFs", "FRFs", list(response), unit)
    time = np.arange(COUNT) / RATE
    at = sdynpy.coordinate_array([1, 2], 3)[:, None]
    row = sdynpy.data_array(types.TIME_RESPONSE, time, hits[0], at)
    path = folder / "sdynpy-time.npz"
    row.save(str(path))
    words = "time histories without units"
    yield Made(path, "SDynPy, save", words, "histories", [], expected=False)


_WINDOWS = (
    *("matplotlib.backends.backend_qt5agg", "qtpy", "qtpy.QtWidgets"),
    *("sdynpy.fileio.sdynpy_escdf", "sdynpy.fileio.sdynpy_pdf3D"),
)
"""Modules of windows and drawings."""


class _Anything(type):
    """Class of what a missing module holds."""

    def __getattr__(cls, name: str) -> type:
        if name.startswith("__"):
            raise AttributeError(name)
        return _anything(name)


def _anything(name: str) -> type:
    return _Anything(name, (), {"__init__": lambda self, *a, **k: None})


class _Missing(types.ModuleType):
    """Stand-in of a module of windows or meshes that SDynPy imports."""

    __path__: list[str] = []  # noqa: RUF012 - that of a package

    def __getattr__(self, name: str) -> type:
        if name.startswith("__"):
            raise AttributeError(name)
        return _anything(name)


def import_sdynpy() -> Any:
    """Return SDynPy, or None; windows and meshes it does not find are left out."""
    for name in _WINDOWS:
        sys.modules.setdefault(name, _Missing(name))
    for _ in range(40):
        try:
            import sdynpy
        except ModuleNotFoundError as error:
            if error.name == "sdynpy":
                return None
            sys.modules[str(error.name)] = _Missing(str(error.name))
            for name in [n for n in sys.modules if n.startswith("sdynpy")]:
                if name not in _WINDOWS:
                    del sys.modules[name]
        else:
            return sdynpy
    return None
