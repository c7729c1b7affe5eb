"""Texts that cost their reader time: tables, TOML, ledgers, meshes, heights."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

Maker = Callable[[Path, float], None]


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
    """Return a writer of a table of valid numbers, the first an even time."""

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


def ledger_deep(path: Path, scale: float) -> None:
    """Write lines of nested lists."""
    first = json.dumps({"kind": "run", "schema": "jointbench-ledger/1"})
    path.write_text(first + "\n" + ("[" * 900 + "]" * 900 + "\n") * int(30_000 * scale))


def ledger_many(path: Path, scale: float) -> None:
    """Write very many lines."""
    first = json.dumps({"kind": "run", "schema": "jointbench-ledger/1"})
    path.write_text(first + "\n" + "{}\n" * int(20e6 * scale))


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
