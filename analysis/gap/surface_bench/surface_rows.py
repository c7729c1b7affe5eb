# SPDX-License-Identifier: MIT
"""The rows that a profile gives: long waves, spectrum, marks and shapes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, freeze
from jointbench.acquisition.records.surfaces import Surface
from jointbench.analysis.gap.surface_bench.long_waves import LongWaves, long_waves
from jointbench.analysis.gap.surface_bench.repeated_marks import (
    RepeatedMarks,
    repeated_marks,
)
from jointbench.analysis.gap.surface_bench.shape_rows import (
    ShapeRow,
    ShapeRows,
    shape_rows,
)
from jointbench.analysis.gap.surface_bench.surface_settings import SURFACE
from jointbench.analysis.gap.surface_bench.surface_state import SurfaceState
from jointbench.signal.band_limited.gamma_deviance import mean_deviance
from jointbench.signal.band_limited.line_sample import LineSample, line_sample
from jointbench.signal.surface.complete_lines import WHOLE_TAPER, complete_lines
from jointbench.signal.surface.levelling import level
from jointbench.signal.surface.line_spectrum import (
    BIN_RATIO,
    fade,
    spectrum_of_lines,
    without_line,
)
from jointbench.signal.surface.structure_function import (
    StructureFunction,
    structure_function,
)

FLOOR = 1e-30
_FINE = 4
_LEAST_BINS = 20


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceRows:
    """Measured rows of one surface.

    The rows are bins of long waves, bins of the spectrum, one row of marks, and the
    shape rows that apply.

    Attributes:
        name: of the surface.
        sample: lines, spectrum and instrument facts; in units of pitch and rms height.
        long: long waves, None for maps and lines with gaps.
        form: power of Legendre polynomials in each bin of the spectrum, (n_bins, 2).
        shapes: numbers that no spectrum has.
        used: which shape rows are rows of the data, shape (5,).
        marks: what repeats, or None.
        structure: structure function of the surface, for views and the report.
        degree: of the form that was removed [-].
    """

    name: str
    sample: LineSample
    long: LongWaves | None
    form: FloatArray
    shapes: ShapeRows
    used: BoolArray
    marks: RepeatedMarks | None
    structure: StructureFunction
    degree: int = 1

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "form", "used")

    @property
    def omega(self) -> FloatArray:
        """Wavenumber of each row [rad/sample], NaN of shapes and marks, (n_rows,)."""
        long = self.long.place if self.long is not None else np.zeros(0)
        rest = np.full(self.size - long.size - self.sample.omega.size, np.nan)
        return np.concatenate([long, self.sample.omega, rest])

    @property
    def size(self) -> int:
        """Number of rows."""
        long = 0 if self.long is None else self.long.power.size
        marks = int(self.marks is not None)
        return long + self.sample.omega.size + marks + int(self.used.sum())

    def tolerant(self, tolerance: float) -> "SurfaceRows":
        """Return rows whose spectrum may differ from a model by more than chance.

        Args:
            tolerance: sd of ln density by which each bin may differ [-].
        """

        def fewer(count: FloatArray) -> FloatArray:
            left: FloatArray = count / (1 + count * tolerance**2)
            return left

        long, shapes = self.long, self.shapes
        wide = np.hypot(shapes.sd, SURFACE.shape_tolerance * tolerance)
        wide[ShapeRow.FILLED :] = shapes.sd[ShapeRow.FILLED :]
        return replace(
            self,
            sample=replace(self.sample, count=fewer(self.sample.count)),
            long=None if long is None else replace(long, count=fewer(long.count)),
            shapes=replace(shapes, sd=wide),
        )

    def expected(
        self, state: SurfaceState, rounding: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the expected mean squares of long waves, and density of the bins.

        Args:
            state: surface, instrument and faults.
            rounding: density of the rounding errors in the bins, shape (n_bins,).
        """
        transfer, sample, long = self.sample.transfer, self.sample, np.zeros(0)
        squares = np.square(state.form)
        if self.long is not None:
            seen = state.sampled(self.long.omega, transfer) + _white(state)
            long = self.long.operator @ seen + self.long.form @ squares
        bins = state.sampled(sample.omega, transfer) + rounding
        return long, np.asarray(bins + self.form @ squares)

    def residual(self, state: SurfaceState, rounding: FloatArray) -> FloatArray:
        """Return deviances with their sign, and standardised shapes, (n_rows,).

        Args:
            state: surface, instrument and faults.
            rounding: density of the rounding errors in the bins, shape (n_bins,).
        """
        sample, parts = self.sample, []
        long, bins = self.expected(state, rounding)
        if self.long is not None:
            parts.append(signed_deviance(self.long.power, long, self.long.count))
        parts.append(signed_deviance(sample.power, bins, sample.count))
        if self.marks is not None:
            unit = sample.scale**2
            parts.append(
                signed_deviance(
                    np.array([self.marks.power / unit]),
                    np.array([self.marks.chance / unit + state.marks**2]),
                    np.array([float(self.marks.waves)]),
                )
            )
        expected = self.shapes.expected + np.asarray(state.shapes)
        shapes = (expected - self.shapes.value) / self.shapes.sd
        return np.concatenate([*parts, shapes[self.used]])


def _white(state: SurfaceState) -> float:
    """Return the density of rounding errors at long waves."""
    return state.step**2 / 12 / (2 * np.pi)


def signed_deviance(
    power: FloatArray, expected: FloatArray, count: FloatArray
) -> FloatArray:
    """Return roots of the gamma deviance, positive where too much is expected.

    Each is divided by the root of its mean for the right density, so that the sum of
    squares counts the rows.

    Args:
        power: measured mean of squares, shape (n,).
        expected: of a model, same shape.
        count: independent ordinates of each, same shape.
    """
    ratio = np.maximum(power, FLOOR) / np.maximum(expected, FLOOR)
    deviance = 2 * count * (ratio - 1 - np.log(ratio)) / mean_deviance(count)
    return np.asarray(-np.sign(ratio - 1) * np.sqrt(np.maximum(deviance, 0.0)))


def surface_rows(surfaces: Sequence[Surface], *, degree: int = 1) -> SurfaceRows:
    """Return the rows of a surface, or of several profiles of one surface.

    Args:
        surfaces: one profile or map, or independent profiles of one pitch.
        degree: of the form that was removed [-].

    Raises:
        UsageError: lines shorter than 64 points, or no roughness.
        SurfaceTooSmall: too few measured points.
    """
    first = surfaces[0]
    marks = repeated_marks(first) if len(surfaces) == 1 else None
    used = list(surfaces) if marks is None else [marks.rest]
    sample = line_sample(used, degree=degree)
    if marks is not None:
        sample = _between_marks(sample, marks)
    sample = _clear_of_leakage(sample)
    lines = np.concatenate([_lines(one) for one in used])
    raw = np.concatenate([one.heights[one.valid].ravel() for one in surfaces])
    shapes = shape_rows(lines, raw if len(surfaces) > 1 else _raw(first))
    return SurfaceRows(
        first.name,
        sample,
        None if sample.blocks is None else long_waves(sample.blocks),
        _form_power(sample),
        shapes,
        _applying(sample, shapes, marks),
        marks,
        structure_function(used[0]),
        degree,
    )


def _raw(surface: Surface) -> FloatArray:
    """Return heights in whose neighbours runs can be found."""
    return surface.heights if surface.valid.all() else surface.heights[surface.valid]


def _lines(surface: Surface) -> FloatArray:
    flat = level(surface)
    lines, _ = complete_lines(np.atleast_2d(flat.heights), np.atleast_2d(flat.valid))
    points = lines.shape[1] if lines.size else 0
    return without_line(lines[:64]) if points else lines


def _applying(
    sample: LineSample, shapes: ShapeRows, marks: RepeatedMarks | None
) -> BoolArray:
    """Return which shape rows are rows of the data."""
    used = np.ones(len(ShapeRow), dtype=np.bool_)
    if marks is not None:
        # What is left of sharp edges looks like spikes.
        used[[ShapeRow.BEND_SKEWNESS, ShapeRow.BEND_KURTOSIS]] = False
    used[ShapeRow.FILLED] = shapes.filled > 0
    rounding = (shapes.step / sample.scale) ** 2 / 12 / (2 * np.pi)
    used[ShapeRow.GRID] = rounding > SURFACE.relevant_grid * sample.floor
    return used


def _between_marks(sample: LineSample, marks: RepeatedMarks) -> LineSample:
    """Return the sample with the ordinates of marks left out of its bins."""
    index = sample.omega * sample.points / (2 * np.pi)
    wave = sample.points / marks.wavelength
    places = wave * np.arange(1, marks.waves + 1) % sample.points
    places = np.sort(np.minimum(places, sample.points - places))
    width = np.maximum((BIN_RATIO - 1) * index, 1.0)
    low, high = index - 0.5 * width, index + 0.5 * width
    taken = np.searchsorted(places, high) - np.searchsorted(places, low)
    left = np.clip(1 - taken / width, 0.05, 1.0)
    return replace(sample, power=sample.power / left, count=sample.count * left)


def _clear_of_leakage(sample: LineSample) -> LineSample:
    """Return the sample without bins that the longest waves leak into.

    A blur can leave less there than the window passes of waves of the line's length.
    """
    window = np.zeros(_FINE * sample.points)
    window[: sample.points] = fade(sample.points, WHOLE_TAPER)
    power = np.abs(np.fft.rfft(window)) ** 2 / np.sum(window**2) / (2 * np.pi)
    # Between its zeros: mean over one ordinate.
    smooth = np.convolve(power, np.full(_FINE, 1 / _FINE), mode="same")
    place = sample.omega * window.size / (2 * np.pi) - 1.5 * _FINE
    leaked = np.interp(place, np.arange(smooth.size), smooth)
    clear = leaked < SURFACE.leaked_share * sample.power
    # From the first bin that is not clear on: noise beyond would be no surface.
    clear = np.logical_and.accumulate(clear)
    if np.count_nonzero(clear) < _LEAST_BINS:
        return sample
    return replace(
        sample,
        omega=sample.omega[clear],
        power=sample.power[clear],
        count=sample.count[clear],
    )


def _form_power(sample: LineSample) -> FloatArray:
    """Return the power of polynomials in the bins of the spectrum, (n_bins, 2)."""
    place = np.linspace(-1, 1, sample.points)
    lines = np.polynomial.legendre.legvander(place, 3)[:, 2:].T
    found = [
        spectrum_of_lines(one[None, :], sample.pitch, taper=0.1, related=False)
        for one in lines
    ]
    omega = 2 * np.pi * sample.pitch * found[0].frequency
    unit = 4 * np.pi * sample.pitch
    return np.stack(
        [np.interp(sample.omega, omega, one.density / unit) for one in found], axis=1
    )
