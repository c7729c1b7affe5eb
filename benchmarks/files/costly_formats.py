"""Files of other programs that cost time: universal, MAT, WAV, TDMS, archives."""

import io
import struct
import zipfile
from pathlib import Path

import numpy as np


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
