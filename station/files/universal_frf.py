# SPDX-License-Identifier: MIT
"""FRFs and mode shapes as universal files, data sets 58 and 55, SI units.

Source:
    Structural Dynamics Research Laboratory, University of Cincinnati, Universal File
    Formats, data sets 55 (data at nodes) and 58 (function at nodal degree of freedom).
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.file_access.quoting import visible
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.station.files.output_paths import write_text

_EDGE = "    -1"
_WIDTH = 80
_FRF = 4
_COMPLEX_DOUBLE, _REAL_DOUBLE = 6, 4
_GENERAL, _COHERENCE = 0, 6
_NOISE = {
    "coherence": _COHERENCE,
    "variance": _GENERAL,
    "innovation_noise": _GENERAL,
    "force_noise": _GENERAL,
}
"""Attributes of an FRF that state its noise, and their function types."""
_ROW = 80
_UNEVEN, _EVEN = 0, 1
_FREQUENCY = 18
_FORCE = 13
# Data set 55: structural, complex mode, 3 translations, displacement, complex.
_STRUCTURAL, _COMPLEX_MODE, _TRANSLATIONS, _DISPLACEMENT, _COMPLEX = 1, 3, 2, 8, 5
# Specific data types of the response: displacement, velocity, acceleration.
_RESPONSE = {
    FrfKind.RECEPTANCE: (8, "Displacement", "m"),
    FrfKind.MOBILITY: (11, "Velocity", "m/s"),
    FrfKind.ACCELERANCE: (12, "Acceleration", "m/s^2"),
}


class Modes(Protocol):
    """What data set 55 takes of modes."""

    @property
    def natural_frequency(self) -> FloatArray:
        """[Hz], shape (n_modes,)."""

    @property
    def poles(self) -> ComplexArray:
        """[rad/s], shape (n_modes,)."""

    @property
    def shapes(self) -> ComplexArray:
        """Shape (n_modes, n_outputs)."""


def write_universal_frf(path: Path, frf: Frf) -> None:
    """Write every FRF as a data set of its own; nodes are numbered from 1.

    Coherence, variance and innovation noise follow each FRF as data sets of their own,
    and the identification lines have what the six digits of the header round off, so
    that `jointbench modal` finds the same modes in the file.

    Args:
        path: file to write.
        frf: any kind. The labels go into the identification lines; directions are not
            known here and are written as scalar.
    """
    write_text(path, "\n".join(_frf_lines(frf)) + "\n")


def write_universal(path: Path, frf: Frf, model: Modes) -> None:
    """Write FRFs (58) and mode shapes (55) into one universal file.

    Args:
        path: file to write.
        frf: as for `write_universal_frf`.
        model: modes of the same outputs; node n is output n, as in the FRFs. Of the
            three translations only the third is used, for want of directions.
    """
    lines = list(_frf_lines(frf))
    for number in range(model.natural_frequency.size):
        lines += _shape_set(model, number)
    write_text(path, "\n".join(lines) + "\n")


def _shape_set(model: Modes, number: int) -> Iterator[str]:
    """Yield a complex mode: pole and Modal A as data set 55 defines them."""
    pole = model.poles[number]
    yield from (_EDGE, "    55")
    frequency = f"{model.natural_frequency[number]:.6g} Hz"
    for text in (f"mode {number + 1}, {frequency}", "jointbench", "", "", "NONE"):
        yield printable(text)
    fields = (_STRUCTURAL, _COMPLEX_MODE, _TRANSLATIONS, _DISPLACEMENT, _COMPLEX, 3)
    yield "".join(f"{value:10d}" for value in fields)
    yield "".join(f"{value:10d}" for value in (2, 6, 1, number + 1))
    # Modal A of a shape phi and participation L is 1 where residue = phi L / A.
    reals = (pole.real, pole.imag, 1.0, 0.0, 0.0, 0.0)
    yield "".join(f"{value:13.5e}" for value in reals)
    for node, value in enumerate(model.shapes[number], 1):
        yield f"{node:10d}"
        parts = (0.0, 0.0, 0.0, 0.0, value.real, value.imag)
        yield "".join(f"{part:13.5e}" for part in parts)
    yield _EDGE


def _frf_lines(frf: Frf) -> Iterator[str]:
    """Yield every FRF, and after each what states its noise."""
    code, word, unit = _RESPONSE[frf.kind]
    kind = frf.kind.value
    for pair in np.ndindex(frf.response.shape[:2]):
        axes = (axis_line(code, word, unit), axis_line(_FORCE, "Force", "N"))
        yield from _data_set(frf, pair, _FRF, kind, axes, frf.response[pair])
        for name, function in _NOISE.items():
            values = getattr(frf, name)
            if values is not None:
                square = "NONE" if function == _COHERENCE else f"({unit}/N)^2"
                axes = (axis_line(0, name, square), axis_line(0, "NONE", "NONE"))
                title = f"{name} of {kind}"
                yield from _data_set(frf, pair, function, title, axes, values[pair])


def _data_set(
    frf: Frf,
    pair: tuple[int, ...],
    function: int,
    title: str,
    axes: tuple[str, str],
    values: ComplexArray | FloatArray,
) -> Iterator[str]:
    """Yield a data set 58 on the lines of an FRF; `axes` describe its ordinate."""
    row, column = pair
    output, point = frf.outputs[row], frf.inputs[column]
    force = f"force={float(frf.force_width)!r}" if frf.force_width else ""
    yield from (_EDGE, "    58")
    for text in (f"{title} {output} / {point}", "jointbench", force, *_exact(frf)):
        yield printable(text)
    yield (
        f"{function:5d}{0:10d}{0:5d}{0:10d} {'NONE':10s}{row + 1:10d}{0:4d}"
        f" {'NONE':10s}{column + 1:10d}{0:4d}"
    )
    axis, step = frf.frequency, _step(frf.frequency)
    kind = _COMPLEX_DOUBLE if np.iscomplexobj(values) else _REAL_DOUBLE
    spacing = _UNEVEN if step is None else _EVEN
    begin = 0.0 if step is None else axis[0]
    yield (
        f"{kind:10d}{axis.size:10d}{spacing:10d}"
        f"{begin:13.5e}{step or 0.0:13.5e}{0.0:13.5e}"
    )
    yield axis_line(_FREQUENCY, "Frequency", "Hz")
    yield from axes
    yield axis_line(0, "NONE", "NONE")
    yield from _value_lines(axis, step, values)
    yield _EDGE


def _value_lines(
    axis: FloatArray, step: float | None, values: ComplexArray | FloatArray
) -> Iterator[str]:
    """Yield the numbers: two complex or four real ones a line; uneven lines with x."""
    if np.iscomplexobj(values):
        cells = [f"{value.real:20.11e}{value.imag:20.11e}" for value in values]
    else:
        cells = [f"{value:20.11e}" for value in values]
    width = _ROW // len(cells[0]) if cells else 1
    if step is None:
        yield from (f"{f:13.5e}{v}" for f, v in zip(axis, cells, strict=True))
    else:
        yield from ("".join(cells[i : i + width]) for i in range(0, len(cells), width))


def _exact(frf: Frf) -> tuple[str, str]:
    """Return two identification lines with what the header rounds off or lacks."""
    step, band = _step(frf.frequency), frf.usable_band
    lines = [] if step is None else [("begin", frf.frequency[0]), ("step", step)]
    rest = [("decay", frf.added_decay_rate)]
    rest += [] if band is None else [("from", band[0]), ("to", band[1])]
    first, second = (
        " ".join(f"{name}={float(value)!r}" for name, value in numbers)
        for numbers in (lines, rest)
    )
    return f"{first} averages={frf.averages}".strip(), second


def _step(axis: FloatArray) -> float | None:
    """Return the step of an even axis, None for an uneven one."""
    if axis.size < 2:
        return None
    step = float(axis[-1] - axis[0]) / (axis.size - 1)
    even = np.allclose(np.diff(axis), step, rtol=1e-6, atol=0.0)
    return step if even else None


def axis_line(code: int, name: str, unit: str) -> str:
    """Return a record of data set 58 that describes an axis."""
    return f"{code:10d}{0:5d}{0:5d}{0:5d} {name:20s} {unit:20s}"


def printable(text: str) -> str:
    """Return one line of 80 plain characters at the most, whatever a file's texts."""
    line = visible(" ".join(text.split()))
    return line.encode("ascii", "replace").decode("ascii")[:_WIDTH] or "NONE"
