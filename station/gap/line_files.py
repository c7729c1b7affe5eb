# SPDX-License-Identifier: MIT
"""Read periodic records that are published as complex lines, and FRFs, as one period.

A table holds the frequency [Hz], then real and imaginary part of each channel. A line
is the complex amplitude X of X exp(i w t), whose real part is the signal. An FRF holds
the responses over the force; one period of a multisine of the stated force stands for
it, which is exact for a linear structure alone.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    SamplingError,
    UsageError,
)
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.formats.columns import Column, only_roles, parse_columns
from jointbench.acquisition.formats.tables import load_table
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.station.gap.frf_levels import read_frf_lines

_ROLES = tuple(quantity.value for quantity in Quantity)
_OFF_LINE = 1e-3
"""Of the spacing: how far a frequency may be from a multiple of it."""


@dataclass(frozen=True, slots=True)
class LineRequest:
    """How complex lines become samples.

    Attributes:
        channels: of the table, after the frequency, as typed after ``lines =``.
        rate: of the samples [Hz].
        force: rms of the force of an FRF [N]; None for lines with their own force.
        frf_columns: what a file of FRFs holds, where it does not say.
    """

    channels: str
    rate: float
    force: float | None = None
    frf_columns: str | None = None


def read_lines(path: Path, request: LineRequest) -> Recording:
    """Return one period of the record that a table of complex lines describes.

    Args:
        path: delimited text or a .npy file of real numbers; an FRF may be in any
            file that `modal` reads.
        request: its channels and the rate.

    Raises:
        BadData: the table cannot be read, or a line is missing or not finite.
        FormatError: it has another number of columns.
        SamplingError: the rate does not fit the lines.
        UsageError: an FRF has more than one force.
    """
    columns = parse_columns(request.channels)
    only_roles(columns, _ROLES, "a table of complex lines")
    forces = [c for c in columns if c.role == Quantity.FORCE]
    if request.force is not None and len(forces) != 1:
        raise UsageError(
            f"lines = {request.channels!r} names {len(forces)} forces; an FRF is over "
            "one of them: give its column alone"
        )
    held = [c for c in columns if request.force is None or c not in forces]
    if request.force is not None:
        frfs = read_frf_lines(path, request.frf_columns, held)
        if frfs is not None:
            found = dict(zip(held, frfs[1], strict=True))
            return _sampled(path, request, columns, frfs[0], found)
    frequency, values = _table(path, held)
    return _sampled(path, request, columns, frequency, values)


def _table(
    path: Path, held: Sequence[Column]
) -> tuple[FloatArray, dict[Column, ComplexArray]]:
    """Return frequency and complex lines of a table, in SI units."""
    wanted = 1 + 2 * len(held)
    values = load_table(path, columns=wanted).values
    if values.shape[0] != wanted:
        raise FormatError(
            f"{named(path)} has {values.shape[0]} columns and {wanted} are wanted: the "
            "frequency, then real and imaginary part of each of "
            f"{', '.join(c.label or c.role for c in held)}"
        )
    if not np.all(np.isfinite(values)):
        raise BadData(f"{named(path)} holds lines without a value; leave them out")
    return values[0], {
        column: column.factor * (values[2 * k + 1] + 1j * values[2 * k + 2])
        for k, column in enumerate(held)
    }


def _sampled(
    path: Path,
    request: LineRequest,
    columns: Sequence[Column],
    frequency: FloatArray,
    read: Mapping[Column, ComplexArray],
) -> Recording:
    """Return one period of complex lines; those of an FRF times a flat force."""
    lines, period = _line_numbers(path, frequency, request.rate)
    if request.force is not None:
        force = _flat_force(lines.size, request.force)
        read = {c: read[c] * force if c in read else force for c in columns}
    rows = [_samples(read[column], lines, period) for column in columns]
    return Recording(
        path.stem,
        np.stack(rows),
        request.rate,
        tuple(_channel(column) for column in columns),
    )


def _channel(column: Column) -> Channel:
    return Channel(
        name=column.label or column.role,
        quantity=Quantity(column.role),
        point=column.point,
        unit=column.unit,
    )


def _line_numbers(
    path: Path, frequency: FloatArray, rate: float
) -> tuple[FloatArray, int]:
    """Return the multiple of the spacing of each line, and the samples of a period."""
    if frequency.size < 2 or frequency[0] <= 0 or np.any(np.diff(frequency) <= 0):
        raise BadData(
            f"{named(path)}: the frequencies must be positive and ascend, two or more; "
            "leave out the line at 0 Hz and sort the others"
        )
    spacing = float(np.diff(frequency).min())
    # The mean over all lines is more exact than one printed difference.
    spacing = float(frequency[-1] / np.round(frequency[-1] / spacing))
    lines = np.round(frequency / spacing)
    if np.abs(frequency / spacing - lines).max() > _OFF_LINE:
        raise SamplingError(
            f"{named(path)}: the lines are no multiples of {spacing:g} Hz, so that the "
            "record has no period; give the lines of one period"
        )
    period = round(rate / spacing)
    if abs(rate / spacing - period) > _OFF_LINE * period or period <= 2 * lines[-1]:
        raise SamplingError(
            f"rate = {rate:g} Hz does not fit {named(path)}: it must be a multiple of "
            f"{spacing:g} Hz and more than {2 * frequency[-1]:g} Hz"
        )
    return lines, period


def _flat_force(count: int, rms: float) -> ComplexArray:
    """Return a force of equal lines whose peak is low.

    Source:
        Schroeder 1970, IEEE Trans. Inf. Theory 16, 85, eq. (12).
    """
    k = np.arange(count)
    return np.asarray(rms * np.sqrt(2.0 / count) * np.exp(-1j * np.pi * k * k / count))


def _samples(values: ComplexArray, lines: FloatArray, period: int) -> FloatArray:
    spectrum = np.zeros(period // 2 + 1, dtype=complex)
    spectrum[lines.astype(int)] = values
    return np.asarray(0.5 * period * np.fft.irfft(spectrum, period))
