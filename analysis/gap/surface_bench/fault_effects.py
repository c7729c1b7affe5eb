# SPDX-License-Identifier: MIT
"""Faults of a measurement: outliers and points that were filled in."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.model.effect_parameter import (
    Parameter,
    Reported,
    Transform,
)
from jointbench.analysis.gap.surface_bench.process_effects import free_shape
from jointbench.analysis.gap.surface_bench.shape_rows import ShapeRow
from jointbench.analysis.gap.surface_bench.surface_effect import (
    INSTRUMENT_SITE,
    Act,
    SurfaceEffect,
)
from jointbench.analysis.gap.surface_bench.surface_rows import SurfaceRows
from jointbench.analysis.gap.surface_bench.surface_state import SurfaceState
from jointbench.signal.band_limited.line_sample import LineSample

_FOURTH = 18.0
"""Fourth cumulant of second differences of one spike of size 1: 1 + 16 + 1 [-]."""
_THIRD = -6.0
"""Third one: 1 - 8 + 1 [-]."""


def _spikes(rows: SurfaceRows) -> Act:
    """Return what spikes add: white power, kurtosis, and skewness if of one sign."""
    variance = rows.shapes.bend

    def act(
        values: FloatArray, state: SurfaceState, sample: LineSample
    ) -> SurfaceState:
        share, size, sign, skewness = (float(v) for v in values)
        state = replace(state, noise=state.noise + share * (size / sample.scale) ** 2)
        fourth = _FOURTH * share * size**4 / variance**2
        third = _THIRD * sign * share * size**3 / variance**1.5
        state = state.shifted(ShapeRow.BEND_KURTOSIS, float(np.log1p(fourth)))
        state = state.shifted(ShapeRow.SKEWNESS, skewness)
        return state.shifted(ShapeRow.BEND_SKEWNESS, float(np.arcsinh(third)))

    return act


def _fills(rows: SurfaceRows) -> Act:
    """Return what filled points add."""
    points = rows.sample.points * rows.sample.lines

    def act(
        values: FloatArray, state: SurfaceState, sample: LineSample
    ) -> SurfaceState:
        share, white, bend, kurtosis, skewness = (float(v) for v in values)
        added = white / sample.scale**2
        state = replace(state, noise=state.noise + added)
        filled = float(np.log1p(max(share, 0.0) * points))
        state = state.shifted(ShapeRow.FILLED, filled)
        state = state.shifted(ShapeRow.SKEWNESS, skewness)
        state = state.shifted(ShapeRow.BEND_SKEWNESS, bend)
        return state.shifted(ShapeRow.BEND_KURTOSIS, kurtosis)

    return act


def fault_effects(rows: SurfaceRows) -> list[SurfaceEffect]:
    """Return the faults that the rows can show."""
    found = [SurfaceEffect(_outliers(), _spikes(rows), INSTRUMENT_SITE)]
    if rows.used[ShapeRow.FILLED]:
        found.append(SurfaceEffect(_filled(), _fills(rows), INSTRUMENT_SITE))
    return found


def _outliers() -> Effect:
    return Effect(
        "outliers",
        "fault",
        (
            Parameter(
                "share",
                "-",
                lower=1e-5,
                upper=0.05,
                starts=(0.001, 0.005),
                transform=Transform.LOG,
            ),
            Parameter(
                "size",
                "m",
                "bend",
                2.5,
                100.0,
                starts=(3.0, 6.0),
                transform=Transform.LOG,
            ),
            Parameter("one_sign", "-", lower=-1.5, upper=1.5, starts=(0.0,)),
            free_shape("skewness"),
        ),
        source="spikes at single points: white power, fourth cumulants of second "
        "differences",
        separates={
            "noise": "mask them: --outliers 6",
            "tip": "mask them: --outliers 6",
        },
        report=lambda values: (
            Reported("share", "-", float(values[0])),
            Reported("size", "m", float(values[1])),
        ),
    )


def _filled() -> Effect:
    return Effect(
        "missing_points",
        "fault",
        (
            Parameter("share", "-", "filled", 0.0, 3.0, off=0.0, far=(1.0,)),
            Parameter("white", "m^2", "floor", -1.0, 20.0, starts=(0.0,)),
            free_shape("bend_skewness"),
            # Dropouts far off the line: at most ln of the number of points.
            free_shape("bend_kurtosis", -1.0, 12.0),
            free_shape("skewness"),
        ),
        source="straight runs and repeated heights, which no rough surface has",
        separates={"outliers": "export missing points as empty cells"},
        report=lambda values: (Reported("share", "-", float(values[0])),),
        generalises=("outliers",),
    )
