"""Files that cost their reader time and memory, and the readers of foreign bytes."""

import io
import json
import struct
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.formats.samples.hit_tables import read_recording
from jointbench.acquisition.formats.samples.mat_recording import read_mat_recording
from jointbench.acquisition.formats.samples.rattlesnake import read_rattlesnake
from jointbench.acquisition.formats.samples.tdms import read_tdms
from jointbench.acquisition.formats.samples.universal import read_universal
from jointbench.acquisition.formats.samples.wave import read_wave
from jointbench.acquisition.session_file.describe_file import describe_file
from jointbench.acquisition.session_file.store import read_session
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.analysis.structures.matrices.mesh_files import read_matrix, read_mesh
from jointbench.station.archive.ledger import read_ledger
from jointbench.station.commands.identify_links_command import describes_structure
from jointbench.station.commands.verify_command import run_verify
from jointbench.station.files.toml_file import read_toml
from jointbench.station.measure.plan import read_plan
from jointbench.station.results.processed_file import PROCESSED_SCHEMA
from jointbench.station.results.results_read import read_result
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.geometry_file import Geometry
from jointbench.station.schemas.recipe import read_recipe

MAT = "time.t:s,force.F:N,acceleration.a1:m/s^2"
TABLE = "time:s,force:N,acceleration:m/s^2"
Maker = Callable[[Path, float], None]

READERS: dict[str, Callable[[Path], object]] = {
    "TOML: bench model": lambda p: read_toml(p, BenchModel),
    "TOML: structure or bench": describes_structure,
    "TOML: recipe": read_recipe,
    "TOML: plan": read_plan,
    "TOML: geometry": lambda p: read_toml(p, Geometry),
    "ledger": read_ledger,
    "hits": lambda p: read_recording(p, columns=TABLE),
    "hits, units of the file": lambda p: read_recording(p, columns=None),
    "heights": read_surface,
    "heights x, z": lambda p: read_surface(p, columns="x:um,z:um"),
    "heights x, y, z": lambda p: read_surface(p, columns="x:um,y:um,z:um"),
    "heights alone": lambda p: read_surface(p, columns="z:um@1um"),
    "session": read_session,
    "inspect": describe_file,
    "verify": lambda p: run_verify(p, json_target=None),
    "results": read_result,
    "campaign": read_campaign,
    "Rattlesnake": lambda p: read_rattlesnake(p, columns=None, point="1"),
    "MAT": lambda p: read_mat_recording(p, columns=MAT, point="1"),
    "universal": lambda p: read_universal(p, columns=None, point="1"),
    "TDMS": lambda p: read_tdms(p, columns=None, point="1"),
    "WAV": lambda p: read_wave(p, columns="force:N", point="1", full_scale=1.0),
    "mesh": read_mesh,
    "matrix": read_matrix,
}


@dataclass(frozen=True, slots=True)
class CostlyFile:
    """A file and who reads it.

    Attributes:
        reader: its name in `READERS`.
        words: what is costly.
        name: of the file.
        make: writes it, at a share of its size.
    """

    reader: str
    words: str
    name: str
    make: Callable[[Path, float], object]


def repeated(
    unit: bytes, size: float, *, head: bytes = b"", tail: bytes = b""
) -> Maker:
    """Return what writes a text over and over."""

    def make(path: Path, scale: float) -> None:
        count = max(2, int(size * scale / len(unit)))
        path.write_bytes(head + unit * count + tail)

    return make


def numbers(
    size: float, *, columns: int, head: str = "", gap: str = "", sep: str = ","
):
    """Return what writes a table of plain numbers, the first an even time."""

    def make(path: Path, scale: float) -> None:
        rows = max(10, int(size * scale / (11 * columns)))
        draw = np.random.default_rng(1)
        with path.open("w") as file:
            for first in range(0, rows, 100_000):
                step = np.arange(first, min(first + 100_000, rows))
                rest = draw.normal(size=(columns - 1, step.size))
                lines = [
                    sep.join((f"{i / 1e4:.4f}", *(f"{v:.7f}" for v in row)))
                    for i, row in zip(step.tolist(), rest.T.tolist(), strict=True)
                ]
                if gap:
                    lines[::1000] = [
                        line[: line.rfind(sep) + 1] + gap for line in lines[::1000]
                    ]
                file.write("\n".join(lines) + "\n")

    return make


def dots(path: Path, scale: float) -> None:
    """Write one key of very many parts."""
    path.write_text("a" + ".a" * int(50_000 * scale) + "=1\n")


def dotted_header(path: Path, scale: float) -> None:
    """Write one table of very many parts."""
    path.write_text("[a" + ".a" * int(50_000 * scale) + "]\n")


def dotted_lines(path: Path, scale: float) -> None:
    """Write many keys of many parts."""
    one = "a" + ".b" * 400
    path.write_text("".join(f"{one}.k{i}=1\n" for i in range(int(1100 * scale))))


def inline_dots(path: Path, scale: float) -> None:
    """Write a key of very many parts inside braces."""
    path.write_text("x = {a" + ".a" * int(50_000 * scale) + " = 1}\n")


def array_tables(path: Path, scale: float) -> None:
    """Write many tables of arrays."""
    path.write_text("[[a.b.c.d]]\n" * int(80_000 * scale))


def session(path: Path, *, shape: tuple[int, ...], dtype: str, chunks=None) -> None:
    """Write what a session reader opens: one recording that unpacks to much."""
    from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
    from jointbench.acquisition.records.session import Session
    from jointbench.acquisition.session_file.store import write_session

    rows = np.zeros((2, 64))
    channels = (
        Channel("force", Quantity.FORCE, "1", unit="N"),
        Channel("a1", Quantity.ACCELERATION, "2", "+z", unit="g"),
    )
    one = Recording("r", rows, 1e3, channels)
    write_session(Session("u", "2025", "j", True, recordings=(one,)), path)
    with h5py.File(path, "a") as file:
        del file["stream/r/samples"]
        file.create_dataset(
            "stream/r/samples",
            shape=shape,
            dtype=dtype,
            chunks=chunks or (1, min(2**20, shape[1])),
            compression="gzip",
            shuffle=True,
        )[...] = 0


def bomb(path: Path, scale: float) -> None:
    """Bytes that become doubles, 62 in memory for one in the file."""
    session(path, shape=(2, int(60e6 * scale)), dtype="i1")
    pad(path, int(120e6 * scale / 62))


def results_json(path: Path, scale: float) -> None:
    """Write a recipe of nothing but empty lists."""
    data = np.frombuffer(b"[" + b"[]," * int(20e6 * scale) + b"[]]", "S1")
    with h5py.File(path, "w") as file:
        file.attrs["schema"] = PROCESSED_SCHEMA
        file.create_group("stages")
        file.create_dataset(
            "recipe/text", data=data[None, :], compression="gzip", chunks=True
        )


def pad(path: Path, size: int) -> None:
    """Add what does not pack."""
    with h5py.File(path, "a") as file:
        file.create_dataset("pad", data=np.random.default_rng(1).bytes(1), dtype="S1")
        values = np.random.default_rng(1).integers(0, 255, max(1, size), np.uint8)
        file.create_dataset("stream/pad", data=values)


def many_chunks(path: Path, scale: float) -> None:
    """Write a session of a chunk for each sample."""
    session(path, shape=(2, int(29_000 * scale)), dtype="i1", chunks=(1, 1))


def many_groups(path: Path, scale: float) -> None:
    """Write nothing but groups and attributes."""
    with h5py.File(path, "w") as file:
        file.attrs["schema"] = "jointbench-session/1"
        for i in range(int(19_000 * scale)):
            group = file.create_group(f"stream/{i}")
            for j in range(20):
                group.attrs[f"a{j}"] = j


def rattlesnake(path: Path, scale: float) -> None:
    """Write a stream of a chunk for each sample."""
    count = int(500_000 * scale)
    with h5py.File(path, "w") as file:
        file.attrs["sample_rate"] = 1e4
        data = file.create_dataset(
            "time_data",
            shape=(1, count),
            maxshape=(1, None),
            chunks=(1, 1),
            dtype="<f8",
        )
        data[...] = 1.0
        table = file.create_group("channels")
        for name, text in (
            ("node_number", "1"),
            ("node_direction", "Z+"),
            ("unit", "N"),
        ):
            kind = h5py.string_dtype()
            table.create_dataset(name, data=np.array([text], dtype=object), dtype=kind)


def campaign(path: Path, scale: float) -> None:
    """Records that hold next to nothing and claim much."""
    with h5py.File(path, "w") as file:
        file.attrs["schema"] = "two-body-campaign/1"
        file.attrs["fs_hz"] = 1e4
        for i in range(64):
            group = file.create_group(f"records/{i:03d}")
            size = int(1e6 * scale)
            for name, shape in (("force", (size,)), ("accel", (2, size))):
                group.create_dataset(
                    name,
                    shape=shape,
                    dtype="i1",
                    chunks=(1, size)[-len(shape) :],
                    compression="gzip",
                )[...] = 1
        file.create_dataset(
            "pad",
            data=np.random.default_rng(1).integers(0, 255, int(4e6 * scale), np.uint8),
        )


def array(path: Path, count: float, dtype: str, rows: int = 3) -> None:
    """Write an array of small numbers."""
    values = np.zeros((rows, int(count / rows)), dtype)
    values[0] = np.arange(values.shape[1]) % 100
    np.save(path, values)


def uff_sets(path: Path, scale: float) -> None:
    """As many data sets as are allowed, next to nothing in each."""
    one = "    -1\n    58\n" + "NONE\n" * 5 + f"{1:5d}{0:10d}{0:5d}{0:10d} {'NONE':10s}"
    one += f"{1:10d}{0:4d} {'NONE':10s}{0:10d}{0:4d}\n"
    one += f"{2:10d}{2:10d}{1:10d}{0:13.5e}{1:13.5e}{0:13.5e}\n"
    one += f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}\n" * 4
    one += f"{1.0:13.5e}{1.0:13.5e}\n    -1\n"
    path.write_text(one * int(10_000 * scale))


def uff_values(path: Path, scale: float) -> None:
    """One long history as text."""
    count = int(10e6 * scale) // 6 * 6
    head = "    -1\n    58\n" + "NONE\n" * 5 + f"{1:5d}{0:10d}{0:5d}{0:10d} {'a':10s}"
    head += f"{1:10d}{0:4d} {'NONE':10s}{0:10d}{0:4d}\n"
    head += f"{2:10d}{count:10d}{1:10d}{0:13.5e}{1e-3:13.5e}{0:13.5e}\n"
    head += f"{17:10d}{0:5d}{0:5d}{0:5d} {'Time':20s} {'s':20s}\n"
    head += f"{13:10d}{0:5d}{0:5d}{0:5d} {'Force':20s} {'N':20s}\n"
    head += f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}\n" * 2
    path.write_text(head + (f"{1.0:13.5e}" * 6 + "\n") * (count // 6) + "    -1\n")


def uff_edges(path: Path, scale: float) -> None:
    """Write nothing but edges of data sets."""
    path.write_bytes(b"    -1\n" * (int(30e6 * scale) // 7 // 2 * 2))


def mat_many(path: Path, scale: float) -> None:
    """Write very many variables."""
    import scipy.io

    scipy.io.savemat(path, {f"v{i}": np.zeros(1) for i in range(int(100_000 * scale))})


def mat_bomb(path: Path, scale: float) -> None:
    """Write zeros, packed."""
    import scipy.io

    rows = np.zeros((1, int(15e6 * scale)))
    scipy.io.savemat(path, {"t": rows, "F": rows, "a1": rows}, do_compression=True)


def mat_cells(path: Path, scale: float) -> None:
    """Write cells, packed."""
    import scipy.io

    cells = np.empty(int(300_000 * scale), dtype=object)
    cells[:] = 1.0
    scipy.io.savemat(path, {"t": cells, "F": cells, "a1": cells}, do_compression=True)


def wave(path: Path, scale: float) -> None:
    """Chunks of no length, as many as the file has room for."""
    chunk = b"junk\0\0\0\0" * int(8e6 * scale)
    kind = b"fmt " + struct.pack("<IHHIIHH", 16, 1, 1, 8000, 8000, 1, 8)
    body = b"WAVE" + kind + chunk + b"data" + struct.pack("<I", 2) + b"\1\2"
    path.write_bytes(b"RIFF" + struct.pack("<I", len(body)) + body)


def wave_long(path: Path, scale: float) -> None:
    """A byte a sample becomes a double."""
    count = int(100e6 * scale) // 2 * 2
    kind = b"fmt " + struct.pack("<IHHIIHH", 16, 1, 1, 8000, 8000, 1, 8)
    body = (
        b"WAVE" + kind + b"data" + struct.pack("<I", count) + b"\x81\x7f" * (count // 2)
    )
    path.write_bytes(b"RIFF" + struct.pack("<I", len(body)) + body)


def tdms_segments(path: Path, scale: float) -> None:
    """Write very many segments."""
    from nptdms import ChannelObject, TdmsWriter

    about = {"unit_string": "N", "wf_increment": 1e-3}
    with TdmsWriter(path) as writer:
        writer.write_segment([ChannelObject("g", "f", np.zeros(1), about)])
    data = path.read_bytes()
    path.write_bytes(data * int(100_000 * scale))


def tdms_channels(path: Path, scale: float) -> None:
    """Write very many channels."""
    from nptdms import ChannelObject, TdmsWriter

    about = {"unit_string": "N", "wf_increment": 1e-3}
    with TdmsWriter(path) as writer:
        objects = [
            ChannelObject("g", f"{i}", np.zeros(1), about)
            for i in range(int(50_000 * scale))
        ]
        writer.write_segment(objects)


def ledger_deep(path: Path, scale: float) -> None:
    """Write lines of nested lists."""
    first = json.dumps({"kind": "run", "schema": "jointbench-ledger/1"})
    path.write_text(first + "\n" + ("[" * 900 + "]" * 900 + "\n") * int(30_000 * scale))


def ledger_many(path: Path, scale: float) -> None:
    """Write very many lines."""
    first = json.dumps({"kind": "run", "schema": "jointbench-ledger/1"})
    path.write_text(first + "\n" + "{}\n" * int(20e6 * scale))


def zipped(path: Path, scale: float) -> None:
    """A container of zeros that unpacks to a thousand times its size."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as whole:
        with whole.open("main.xml", "w", force_zip64=True) as file:
            file.write(b"<a>")
            for _ in range(max(1, int(2000 * scale))):
                file.write(b"<b></b>" * 150_000)
            file.write(b"</a>")


def entities(path: Path, scale: float) -> None:
    """An X3P whose XML laughs a billion times."""
    lines = ['<!DOCTYPE x [<!ENTITY a "ha">']
    for one, other in zip("bcdefghij", "abcdefghi", strict=True):
        lines.append(f'<!ENTITY {one} "' + f"&{other};" * 10 + '">')
    text = "\n".join(lines) + "]>\n<x>&j;</x>"
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as whole:
        whole.writestr("main.xml", text)
    path.write_bytes(data.getvalue())


def mtx_claim(path: Path, scale: float) -> None:
    """Write one value of a vast matrix."""
    count = int(1e9 * scale)
    path.write_text(
        f"%%MatrixMarket matrix coordinate real general\n{count} {count} 1\n1 1 1.0\n"
    )


def mtx_array(path: Path, scale: float) -> None:
    """Claim a vast full matrix."""
    count = int(30_000 * scale)
    path.write_text(f"%%MatrixMarket matrix array real general\n{count} {count}\n1.0\n")


def inp(path: Path, scale: float) -> None:
    """Write very many nodes."""
    with path.open("w") as file:
        file.write("*NODE\n")
        for i in range(1, int(2e6 * scale)):
            file.write(f"{i}, {i}.0, 0.0, 0.0\n")
        file.write("*ELEMENT, TYPE=C3D10\n1, 1,2,3,4,5,6,7,8,9,10\n")


def keyence(path: Path, scale: float) -> None:
    """A Keyence image of single digits."""
    rows = int(6000 * scale)
    head = (
        '"Measurement Data"\n"Horizontal","1024"\n"Vertical","768"\n'
        '"XY Calibration","1000","nm"\n"Output image data","Height"\n"Unit","um"\n'
        '"Height"\n'
    )
    path.write_text(head + ("1," * 5999 + "1\n") * rows)


def gwyddion(path: Path, scale: float) -> None:
    """Write a Gwyddion text of single digits."""
    rows = int(2500 * scale)
    head = "# Channel: Height\n# Width: 10 um\n# Height: 10 um\n# Value units: m\n"
    path.write_text(head + ("1\t" * 9999 + "1\n") * rows)


def surfcom(path: Path, scale: float) -> None:
    """Write a Surfcom trace of single digits."""
    path.write_text("4.0\n0.3\n1\n" + "1\n" * int(30e6 * scale))


FILES = (
    *(
        CostlyFile(reader, words, "m.toml", make)
        for reader in READERS
        if reader.startswith("TOML")
        for words, make in (
            ("one key of 50,000 parts", dots),
            ("one table of 50,000 parts", dotted_header),
            ("1,100 keys of 400 parts", dotted_lines),
            ("inline key of 50,000 parts", inline_dots),
            ("80,000 tables in arrays", array_tables),
            ("brackets inside brackets", repeated(b"[", 9e5, head=b"a = ")),
            ("one number of 900,000 digits", repeated(b"1", 9e5, head=b"a = ")),
        )
        if reader == "TOML: bench model" or make in (dots, dotted_lines)
    ),
    CostlyFile("ledger", "brackets inside brackets", "l.jsonl", ledger_deep),
    CostlyFile("ledger", "20 million lines", "l.jsonl", ledger_many),
    CostlyFile("hits", "240 MB of numbers", "h.csv", numbers(240e6, columns=3)),
    CostlyFile("hits", "100 MB of numbers", "h.csv", numbers(110e6, columns=3)),
    CostlyFile(
        "hits", "100 MB, gaps all over", "h.csv", numbers(110e6, columns=3, gap=" ")
    ),
    CostlyFile(
        "hits",
        "100 MB with words for gaps",
        "h.csv",
        numbers(110e6, columns=3, gap="nan,"),
    ),
    CostlyFile("hits", "60 MB of short lines", "h.csv", repeated(b"1\n", 60e6)),
    CostlyFile("hits", "99 MB of short rows", "h.csv", repeated(b"1,1,1\n", 99e6)),
    CostlyFile("hits", "99 MB in one line", "h.csv", repeated(b"1,", 99e6)),
    CostlyFile("hits", "99 MB of empty lines", "h.csv", repeated(b"\n", 99e6)),
    CostlyFile("hits", "99 MB of comments", "h.csv", repeated(b"#\n", 99e6)),
    CostlyFile(
        "hits",
        "99 MB, one wide letter",
        "h.csv",
        repeated(b"0,1.5,1\n", 99e6, head="\U0001f600\n".encode()),
    ),
    CostlyFile(
        "hits", "99 MB of decimal commas", "h.csv", repeated(b"0,1;1,5;1,25\n", 99e6)
    ),
    CostlyFile(
        "hits", "99 MB of quotes", "h.csv", repeated(b'"0.1","1.5","1"\n', 99e6)
    ),
    CostlyFile(
        "hits",
        "512 columns of gaps",
        "h.csv",
        repeated(b"1," + b"," * 510 + b"\n", 99e6),
    ),
    CostlyFile(
        "hits, units of the file",
        "header of a million brackets",
        "h.csv",
        repeated(b"a [", 1e6, tail=b"\n1,2,3\n2,3,4\n"),
    ),
    CostlyFile(
        "hits",
        "100 million small numbers, .npy",
        "h.npy",
        lambda p, s: array(p, 1e8 * s, "i1"),
    ),
    CostlyFile(
        "hits",
        "60 million doubles, .npy",
        "h.npy",
        lambda p, s: array(p, 6e7 * s, "f8"),
    ),
    CostlyFile("heights alone", "one column", "z.csv", repeated(b"1.25\n", 99e6)),
    CostlyFile(
        "heights x, y, z", "points of no grid", "z.csv", numbers(110e6, columns=3)
    ),
    CostlyFile(
        "heights x, z",
        "100 million small numbers, .npy",
        "z.npy",
        lambda p, s: array(p, 1e8 * s, "i1", 2),
    ),
    CostlyFile("heights", "Keyence image of single digits", "k.csv", keyence),
    CostlyFile("heights", "Gwyddion text of single digits", "g.txt", gwyddion),
    CostlyFile("heights", "Surfcom of single digits", "s.tx1", surfcom),
    CostlyFile(
        "heights",
        "Mahr of single digits",
        "m.txt",
        repeated(b"1\n", 60e6, head=b"RES 0.1\n"),
    ),
    CostlyFile("heights", "X3P that unpacks to 2 GB", "z.x3p", zipped),
    CostlyFile("heights", "XLSX that unpacks to 2 GB", "z.xlsx", zipped),
    CostlyFile("heights", "X3P of a billion entities", "e.x3p", entities),
    CostlyFile(
        "heights",
        "SDF of short lines",
        "s.sdf",
        repeated(b"1\n", 60e6, head=b"aISO-1.0\n"),
    ),
    CostlyFile("session", "bytes that become doubles", "s.h5", bomb),
    CostlyFile("inspect", "bytes that become doubles", "s.h5", bomb),
    CostlyFile("verify", "bytes that become doubles", "s.h5", bomb),
    CostlyFile("session", "as many chunks as are read", "s.h5", many_chunks),
    CostlyFile("inspect", "19,000 groups of 20 attributes", "s.h5", many_groups),
    CostlyFile(
        "results", "19,000 groups of 20 attributes", "r.results.h5", many_groups
    ),
    CostlyFile("results", "a recipe of empty lists", "r.results.h5", results_json),
    CostlyFile("campaign", "bytes that become doubles", "c.h5", campaign),
    CostlyFile("Rattlesnake", "500,000 chunks", "r.nc4", rattlesnake),
    CostlyFile("MAT", "100,000 variables", "m.mat", mat_many),
    CostlyFile("MAT", "zeros, packed", "m.mat", mat_bomb),
    CostlyFile("MAT", "900,000 cells, packed", "m.mat", mat_cells),
    CostlyFile("universal", "10,000 data sets", "u.uff", uff_sets),
    CostlyFile("universal", "10 million values as text", "u.uff", uff_values),
    CostlyFile("universal", "4 million edges", "u.uff", uff_edges),
    CostlyFile("TDMS", "100,000 segments", "t.tdms", tdms_segments),
    CostlyFile("TDMS", "50,000 channels", "t.tdms", tdms_channels),
    CostlyFile("WAV", "8 million chunks", "w.wav", wave),
    CostlyFile("WAV", "100 million samples of a byte", "w.wav", wave_long),
    CostlyFile("matrix", "claims 1e9 rows", "k.mtx", mtx_claim),
    CostlyFile("matrix", "claims a full matrix", "k.mtx", mtx_array),
    CostlyFile("mesh", "2 million nodes, Abaqus", "m.inp", inp),
    CostlyFile(
        "mesh",
        "one line, gmsh",
        "m.msh",
        repeated(b"$Nodes ", 60e6, head=b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"),
    ),
)
