# SPDX-License-Identifier: MIT
"""Maps of values as small pictures inside the report."""

import base64
import struct
import zlib

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

VIRIDIS = (
    *("#440154", "#482878", "#3e4989", "#31688e", "#26828e"),
    *("#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"),
)
"""Colours from the smallest to the largest value; even steps for every eye."""
_LEVELS = 96
_BLACK_FROM = 0.1791
"""Luminance at which black and white are equally legible, 4.6:1."""


def map_address(values: FloatArray, low: float, high: float) -> str:
    """Return a map as the address of a picture that is part of the report.

    Args:
        values: row by row from the top, shape (n_rows, n_columns); NaN is clear.
        low: value of the first colour.
        high: value of the last colour.
    """
    share = (values - low) / max(high - low, 1e-300)
    known = np.isfinite(share)
    level = np.where(known, np.clip(np.nan_to_num(share), 0, 1) * (_LEVELS - 1), 0)
    index = np.where(known, np.rint(level).astype(int) + 1, 0).astype(np.uint8)
    encoded = base64.b64encode(_png(index)).decode("ascii")
    return f"data:image/png;base64,{encoded}"


def map_colour(share: float) -> tuple[int, int, int]:
    """Return the colour of a share of the range, 0 to 1."""
    place = min(max(share, 0.0), 1.0) * (len(VIRIDIS) - 1)
    at = min(int(place), len(VIRIDIS) - 2)
    low, high = (_rgb(VIRIDIS[k]) for k in (at, at + 1))
    rest = place - at
    red, green, blue = (
        round(a + rest * (b - a)) for a, b in zip(low, high, strict=True)
    )
    return red, green, blue


def legible_on(share: float) -> str:
    """Return the colour of a number that is written on a share of the range."""
    linear = [_linear(one / 255) for one in map_colour(share)]
    light = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    return "#ffffff" if light < _BLACK_FROM else "#000000"


def _linear(value: float) -> float:
    """Return the linear part of a colour in sRGB (IEC 61966-2-1)."""
    return float(
        value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
    )


def _rgb(text: str) -> tuple[int, int, int]:
    red, green, blue = (int(text[k : k + 2], 16) for k in (1, 3, 5))
    return red, green, blue


def _png(index: np.ndarray[tuple[int, ...], np.dtype[np.uint8]]) -> bytes:
    """Return an indexed picture whose colour 0 is transparent."""
    rows, columns = index.shape
    head = struct.pack(">IIBBBBB", columns, rows, 8, 3, 0, 0, 0)
    colours = b"\x00\x00\x00" + b"".join(
        bytes(map_colour(k / (_LEVELS - 1))) for k in range(_LEVELS)
    )
    lines = np.concatenate([np.zeros((rows, 1), np.uint8), index], axis=1)
    packed = zlib.compress(lines.tobytes(), 9)
    parts = ((b"IHDR", head), (b"PLTE", colours), (b"tRNS", b"\x00"))
    chunks = b"".join(_chunk(*one) for one in (*parts, (b"IDAT", packed)))
    return b"\x89PNG\r\n\x1a\n" + chunks + _chunk(b"IEND", b"")


def _chunk(kind: bytes, content: bytes) -> bytes:
    check = struct.pack(">I", zlib.crc32(kind + content))
    return struct.pack(">I", len(content)) + kind + content + check
