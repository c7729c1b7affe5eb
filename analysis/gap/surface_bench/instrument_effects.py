# SPDX-License-Identifier: MIT
"""Effects of the instrument: tip, blur, noise and steps of its converter."""

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
from jointbench.analysis.gap.surface_bench.surface_settings import SURFACE
from jointbench.analysis.gap.surface_bench.surface_state import SurfaceState
from jointbench.signal.band_limited.line_sample import LineSample
from jointbench.signal.band_limited.tip_width import SHARE, contact_length

_TWICE = "trace the same line twice: noise does not repeat"
_FINER_TIP = "measure with a finer tip, or optically"


def _blurs(values: FloatArray, state: SurfaceState, sample: LineSample) -> SurfaceState:
    blur = max(float(values[0]), 0.0) / sample.pitch**2
    return replace(state, process=replace(state.process, blur=blur))


def _traces(
    values: FloatArray, state: SurfaceState, sample: LineSample
) -> SurfaceState:
    """Let a round tip roll over the surface."""
    radius, bend, kurtosis = (float(v) for v in values)
    tip = replace(sample.transfer, tip=radius / sample.pitch)
    length = contact_length(state.process, replace(sample, transfer=tip))
    state = replace(state, tip=(SHARE * length) ** 2)
    state = state.shifted(ShapeRow.BEND_SKEWNESS, bend)
    return state.shifted(ShapeRow.BEND_KURTOSIS, kurtosis)


def _adds_noise(
    values: FloatArray, state: SurfaceState, sample: LineSample
) -> SurfaceState:
    added = max(float(values[0]), 0.0) / sample.scale**2
    return replace(state, noise=state.noise + added)


def _rounds(rows: SurfaceRows) -> Act:
    """Return what a converter adds: steps, their noise, and bends of one step."""
    kurtosis = float(np.log1p(rows.shapes.rounded))

    def act(
        values: FloatArray, state: SurfaceState, sample: LineSample
    ) -> SurfaceState:
        state = replace(state, step=float(values[0]) / sample.scale)
        state = state.shifted(ShapeRow.BEND_KURTOSIS, kurtosis)
        return state.shifted(ShapeRow.GRID, 1.0)

    return act


def instrument_effects(rows: SurfaceRows) -> list[SurfaceEffect]:
    """Return the effects of the instrument that the rows can show."""
    pairs: list[tuple[Effect, Act]] = [
        (_tip(), _traces),
        (_blur(), _blurs),
        (_noise(), _adds_noise),
    ]
    if rows.used[ShapeRow.GRID]:
        pairs.append((_steps(), _rounds(rows)))
    return [SurfaceEffect(effect, act, INSTRUMENT_SITE) for effect, act in pairs]


def _tip() -> Effect:
    return Effect(
        "tip",
        "instrument",
        (
            Parameter(
                "radius",
                "m",
                "tip",
                0.02,
                200.0,
                starts=(0.3, 1.0, 3.0, 10.0),
                transform=Transform.LOG,
            ),
            free_shape("bend_skewness", 0.5, 4.0),
            free_shape("bend_kurtosis", 0.4, 6.0),
        ),
        source="path of a ball: Church and Takacs 1991, Opt. Eng. 30, 1669; width by "
        "signal/band_limited/tip_width.py",
        separates={"blur": _FINER_TIP, "outliers": _FINER_TIP},
        report=lambda values: (Reported("radius", "m", float(values[0])),),
        model_error=SURFACE.tip_error,
    )


def _blur() -> Effect:
    return Effect(
        "blur",
        "instrument",
        (
            Parameter(
                "sigma2", "m^2", "pitch^2", 0.0, 1e4, off=0.0, far=(0.5, 4.0, 20.0)
            ),
        ),
        source="Gaussian point spread, or a short cut of the surface: power "
        "exp(-(sigma q)^2)",
        separates={"tip": _FINER_TIP, "second_process": "measure with a finer pitch"},
        report=lambda values: (
            Reported("sigma", "m", float(np.sqrt(max(values[0], 0.0)))),
        ),
    )


def _noise() -> Effect:
    return Effect(
        "noise",
        "instrument",
        (Parameter("variance", "m^2", "floor", 0.0, 10.0, off=0.0, far=(0.3, 0.9)),),
        source="heights with independent errors: a level spectrum at short waves",
        separates={"quantisation": "a finer step", "second_process": _TWICE},
        report=lambda values: (
            Reported("sd", "m", float(np.sqrt(max(values[0], 0.0)))),
        ),
        generalises=("quantisation",),
    )


def _steps() -> Effect:
    return Effect(
        "quantisation",
        "instrument",
        (
            Parameter(
                "step",
                "m",
                "step",
                0.9,
                1.1,
                starts=(1.0,),
                transform=Transform.LOG,
                prior=(1.0, 0.01),
            ),
        ),
        source="rounding to a step: Widrow and Kollar 2008, Quantization Noise, ch. 9",
        separates={"noise": "a finer range of heights: the step shrinks, noise stays"},
    )
