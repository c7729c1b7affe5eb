# SPDX-License-Identifier: MIT
"""Effects of the surface itself: roll-off, second process, plateau, marks, form."""

from dataclasses import replace

import numpy as np
from scipy.special import ndtr

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.model.effect_parameter import (
    Parameter,
    Reported,
    Transform,
)
from jointbench.analysis.gap.surface_bench.cut_surface import cut_surface
from jointbench.analysis.gap.surface_bench.shape_rows import ShapeRow
from jointbench.analysis.gap.surface_bench.surface_effect import SurfaceEffect
from jointbench.analysis.gap.surface_bench.surface_rows import SurfaceRows
from jointbench.analysis.gap.surface_bench.surface_settings import SURFACE
from jointbench.analysis.gap.surface_bench.surface_state import (
    Crossover,
    SurfaceState,
)
from jointbench.signal.band_limited.line_sample import LineSample
from jointbench.signal.band_limited.matern_spectrum import BandLimited

LONGER = "measure a profile three times as long"


def free_shape(row: str, lower: float = -6.0, upper: float = 6.0) -> Parameter:
    """Return a parameter that moves one shape row."""
    middle = (0.5 * (max(lower, -2.0) + min(upper, 2.0)),) if lower > 0 else (0.0,)
    return Parameter(row, "-", lower=lower, upper=upper, starts=middle)


def wavelength(
    name: str, low: float, high: float, starts: tuple[float, ...]
) -> Parameter:
    """Return a wavelength in parts of the length of a line."""
    return Parameter(
        name, "m", "length", low, high, starts=starts, transform=Transform.LOG
    )


def _rolls_off(
    values: FloatArray, state: SurfaceState, sample: LineSample
) -> SurfaceState:
    process = replace(state.process, roll_off=float(values[0]) / sample.pitch)
    return replace(state, process=process)


def _crosses(
    values: FloatArray, state: SurfaceState, sample: LineSample
) -> SurfaceState:
    change, place = (float(v) for v in values)
    wavenumber = 2 * np.pi * sample.pitch / place
    return replace(
        state, crossover=Crossover(wavenumber, change, SURFACE.crossover_sharpness)
    )


def _cut(values: FloatArray, state: SurfaceState, sample: LineSample) -> SurfaceState:
    """Leave the valleys of one process and the finish of another between them."""
    roll_off, short, level, finish, fine, bend, kurtosis = map(float, values)
    process = replace(state.process, roll_off=roll_off / sample.pitch)
    corner = fine / sample.pitch
    # Of H = 1/2 and a variance: variance * corner / (4 pi^2) at the corner.
    height = finish / sample.scale**2 * corner / (4 * np.pi**2)
    added = BandLimited(height, 2 * np.pi / corner, SURFACE.finish_hurst, corner)
    valleys = replace(process, blur=(short / sample.pitch) ** 2)
    cut = cut_surface(valleys, added, level)
    state = replace(state, process=process, cut=cut)
    state = state.shifted(ShapeRow.SKEWNESS, float(np.arcsinh(cut.skewness)))
    state = state.shifted(ShapeRow.BEND_SKEWNESS, bend)
    return state.shifted(ShapeRow.BEND_KURTOSIS, kurtosis)


def _repeats(
    values: FloatArray, state: SurfaceState, sample: LineSample
) -> SurfaceState:
    return replace(
        state,
        marks=float(values[0]) / sample.scale,
        wavelength=float(values[1]) / sample.pitch,
    )


def _bows(values: FloatArray, state: SurfaceState, sample: LineSample) -> SurfaceState:
    size = values / sample.scale
    return replace(state, form=(float(size[0]), float(size[1])))


def process_effects(rows: SurfaceRows) -> list[SurfaceEffect]:
    """Return the effects of the surface itself that the rows can show."""
    least = 6.0 / rows.sample.points
    found = [
        SurfaceEffect(_rolloff(least), _rolls_off),
        SurfaceEffect(_second(least), _crosses),
        SurfaceEffect(_plateau(least), _cut),
    ]
    if rows.marks is not None:
        found.append(SurfaceEffect(_marks(), _repeats))
    if rows.degree < 2 and rows.long is not None:
        found.append(SurfaceEffect(_form(), _bows))
    return found


def _rolloff(least: float) -> Effect:
    return Effect(
        "rolloff",
        "process",
        (wavelength("wavelength", least, 0.7, (0.01, 0.05, 0.2, 0.4)),),
        source="level spectrum at long waves: Persson, Albohr, Tartaglino, Volokitin "
        "and Tosatti 2005, J. Phys.: Condens. Matter 17, R1",
        separates={"form": LONGER, "second_process": LONGER},
    )


def _second(least: float) -> Effect:
    return Effect(
        "second_process",
        "process",
        (
            Parameter(
                "change_of_H",
                "-",
                lower=-1.2,
                upper=1.2,
                off=0.0,
                far=(-0.4, 0.4),
            ),
            wavelength("crossover", least, 0.3, (0.003, 0.01, 0.04, 0.15)),
        ),
        source="two power laws of one spectrum: Majumdar and Tien 1990, Wear 136, 313",
        separates={
            "rolloff": LONGER,
            "noise": "trace the same line twice: noise does not repeat",
            "blur": "measure with a finer pitch and another instrument",
            "tip": "measure with a finer tip",
        },
        generalises=("rolloff", "noise", "blur", "tip", "quantisation"),
    )


def _plateau(least: float) -> Effect:
    return Effect(
        "plateau",
        "process",
        (
            wavelength("rolloff", least, 0.3, (0.01, 0.03)),
            wavelength("short_cut", 0.003 * least, 0.03, (0.00002, 0.0006)),
            Parameter("level", "-", lower=-2.5, upper=2.5, starts=(-0.4,)),
            Parameter(
                "finish",
                "m^2",
                "variance",
                1e-9,
                1.0,
                starts=(0.0003, 0.02),
                transform=Transform.LOG,
            ),
            wavelength("finish_rolloff", least / 6.0, 0.3, (0.002, 0.02)),
            free_shape("bend_skewness", -1.5, 1.5),
            free_shape("bend_kurtosis", -1.0, 3.0),
        ),
        source="the lower of two processes: ISO 21920-2:2021, annex on stratified "
        "surfaces",
        separates={"second_process": "a second place: skewness of the heights"},
        report=lambda values: (
            Reported("rolloff", "m", float(values[0])),
            Reported("plateau_share", "-", float(ndtr(-values[2]))),
            Reported("finish_rms", "m", float(np.sqrt(max(values[3], 0.0)))),
            Reported("finish_rolloff", "m", float(values[4])),
        ),
        refit_nominal=True,
        generalises=("rolloff", "second_process"),
    )


def _marks() -> Effect:
    return Effect(
        "tool_marks",
        "process",
        (
            Parameter("rms", "m", "mark", 0.0, 3.0, off=0.0, far=(0.5,)),
            Parameter(
                "wavelength",
                "m",
                "period",
                0.9,
                1.1,
                starts=(1.0,),
                transform=Transform.LOG,
                prior=(1.0, 0.001),
            ),
        ),
        source="feed marks: harmonics of one wavelength; Whitehouse 1994, Handbook of "
        "Surface Metrology, ch. 2",
        separates={"second_process": "measure along the marks, not across them"},
        model_error=SURFACE.marks_error,
    )


def _form() -> Effect:
    return Effect(
        "form",
        "process",
        (
            Parameter("bow", "m", "rms", 0.0, 30.0, off=0.0, far=(0.3, 1.0)),
            Parameter("third", "m", "rms", -10.0, 10.0, starts=(0.0,)),
        ),
        source="polynomial of degree 2 and 3 along the line; ISO 21920-2, nominal form",
        separates={"rolloff": LONGER, "second_process": LONGER},
    )
