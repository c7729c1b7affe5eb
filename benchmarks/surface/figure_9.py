# SPDX-License-Identifier: MIT
"""Redraw Fig. 9 of the 2023 paper, and find the meaning of "smoother with D" in it.

python -m benchmarks.surface.figure_9 writes docs/surface-figure-9.png (left to right
D = 2.1, 2.4, 2.6, 2.8; above the two ridges of the paper, below twenty) and prints a
table. Every map is drawn from its own lowest to its own highest point.
"""

import struct
import sys
import zlib
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Areal
from jointbench.signal.surface.structure_map import isotropy

# Generators and second methods that the tests use as well.
sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))

from weierstrass_surfaces import weierstrass_map

PICTURE = Path(__file__).parents[2] / "docs" / "surface-figure-9.png"
LENGTH, ROUGHNESS, SIDE, GAP = 0.89, 1.36e-7, 128, 4  # [m], [m], [-], [-]
DIMENSIONS, RIDGES = (2.1, 2.4, 2.6, 2.8), (2, 20)


def made(dimension: float, ridges: int) -> Areal:
    """Return one map of the figure."""
    return weierstrass_map(
        SIDE,
        SIDE,
        spacing=LENGTH / SIDE,
        areal_dimension=dimension,
        roughness=ROUGHNESS,
        ridges=ridges,
        seed=9,
    )


def grey(heights: FloatArray) -> np.ndarray:
    """Return heights as shades, the lowest black."""
    low, high = heights.min(), heights.max()
    return np.rint(255 * (heights - low) / (high - low)).astype(np.uint8)


def write_png(path: Path, shades: np.ndarray) -> None:
    """Write a grey picture.

    Source:
        ISO/IEC 15948 (PNG), sections 5 and 11.
    """
    rows, columns = shades.shape
    lines = b"".join(b"\x00" + row.tobytes() for row in shades)
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)),
        (b"IDAT", zlib.compress(lines, 9)),
        (b"IEND", b""),
    )
    body = b"".join(
        struct.pack(">I", len(data))
        + kind
        + data
        + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + body)


def main() -> None:
    """Draw and print."""
    high, wide = len(RIDGES), len(DIMENSIONS)
    canvas = np.full(((SIDE + GAP) * high - GAP, (SIDE + GAP) * wide - GAP), 255)
    print(
        "| D | ridges | rms height | rms slope between neighbours over rms height of "
        "the map | S, diagonals over axes |\n" + "|---" * 5 + "|"
    )
    for j, ridges in enumerate(RIDGES):
        for i, dimension in enumerate(DIMENSIONS):
            areal = made(dimension, ridges)
            top, left = j * (SIDE + GAP), i * (SIDE + GAP)
            canvas[top : top + SIDE, left : left + SIDE] = grey(areal.heights)
            rms = float(areal.heights.std())
            steps = float(np.diff(areal.heights, axis=1).std())
            ratio = isotropy(areal).ratio
            lay = (ratio[1] + ratio[3]) / (ratio[0] + ratio[2])
            print(
                f"| {dimension} | {ridges} | {rms:.2e} m | {steps / rms:.3f} "
                f"| {lay:.2f} |"
            )
    write_png(PICTURE, canvas.astype(np.uint8))


if __name__ == "__main__":
    main()
