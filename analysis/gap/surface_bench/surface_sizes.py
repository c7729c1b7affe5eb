# SPDX-License-Identifier: MIT
"""Sizes of one surface by which the parameters of the catalogue are scaled."""

import numpy as np

from jointbench.analysis.gap.surface_bench.surface_rows import SurfaceRows

_TIP_LAG = 3.0


def surface_scales(rows: SurfaceRows) -> dict[str, float]:
    """Return the value of each scale word of the catalogue [SI].

    Args:
        rows: of the surface.
    """
    sample = rows.sample
    noise = 2 * np.pi * sample.floor
    lag = rows.structure.lag
    structure = np.interp(_TIP_LAG * sample.pitch, lag, rows.structure.value)
    radius = (_TIP_LAG * sample.pitch) ** 2 / np.sqrt(max(float(structure), 1e-300))
    bend = np.sqrt(rows.shapes.bend)
    return {
        "one": 1.0,
        "length": sample.length,
        "pitch^2": sample.pitch**2,
        "variance": sample.scale**2,
        "floor": noise * sample.scale**2,
        "step": rows.shapes.step or 1.0,
        "tip": float(radius),
        "rms": sample.scale,
        "bend": float(bend),
        "mark": 1.0 if rows.marks is None else float(np.sqrt(rows.marks.power)),
        "period": 1.0 if rows.marks is None else rows.marks.wavelength * sample.pitch,
        "filled": max(rows.shapes.filled, 1) / (sample.points * sample.lines),
    }
