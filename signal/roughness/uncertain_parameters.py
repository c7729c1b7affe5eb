# SPDX-License-Identifier: MIT
"""Records of texture parameters with their uncertainties."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.roughness.texture_records import Texture

_LARGEST_ERROR = 0.5
"""Largest standard uncertainty of a scale [-]."""
Values = dict[str, float | None]
"""Parameters by name, None where not defined."""


@dataclass(frozen=True, slots=True)
class InstrumentErrors:
    """Relative standard uncertainties of the instrument's scales.

    Attributes:
        height: of the height scale [-].
        pitch: of the lateral scale [-].
        noise: standard deviation of white noise of a height [m]; None to take that of
            the heights.
    """

    height: float = 0.0
    pitch: float = 0.0
    noise: float | None = None


NO_ERRORS = InstrumentErrors()
"""Scales without error, noise from the heights."""


@dataclass(frozen=True, slots=True)
class TextureValue:
    """One parameter with its uncertainty.

    Attributes:
        name: ``"Ra"``.
        value: as the standard defines it, SI unit; None where it is not defined.
        bias: part of the value that noise adds, as far as it can be estimated.
        parts: standard uncertainties by cause: ``noise``, ``filter``, ``height``,
            ``pitch`` and, of several measurements, ``repeats``.
        factor: half width of the 95 % interval over the combined uncertainty [-].
    """

    name: str
    value: float | None
    bias: float = 0.0
    parts: tuple[tuple[str, float], ...] = ()
    factor: float = 1.96

    @property
    def uncertainty(self) -> float:
        """Combined standard uncertainty."""
        return float(np.sqrt(sum(part**2 for _, part in self.parts)))

    @property
    def interval(self) -> tuple[float, float] | None:
        """95 % interval of the value without noise."""
        if self.value is None:
            return None
        middle, half = self.value - self.bias, self.factor * self.uncertainty
        return middle - half, middle + half


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredTexture:
    """Texture of one surface with its parameters.

    Attributes:
        surface: name.
        texture: scale-limited heights.
        values: parameters with uncertainties, in the order of the computation.
        noise: standard deviation of noise of a height that was assumed [m]; None where
            it is not known.
    """

    surface: str
    texture: Texture
    values: tuple[TextureValue, ...]
    noise: float | None

    def named(self, name: str) -> TextureValue:
        """Return the parameter of a name."""
        return next(one for one in self.values if one.name == name)


def instrument_errors(text: str | None) -> InstrumentErrors:
    """Return the errors as typed: ``"1 %:0.5 %"``, of heights and of the pitch.

    Raises:
        UsageError: not two parts, or no small positive shares.
    """
    if text is None:
        return NO_ERRORS
    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 2 or not any(parts):
        raise UsageError(
            f"scale errors are {text!r}; give the standard uncertainty of the height "
            "scale and of the pitch, for example '1 %:0.5 %', '1 %:' or ':0.5 %'"
        )
    height, pitch = (_share(part) if part else 0.0 for part in parts)
    return InstrumentErrors(height, pitch)


def _share(text: str) -> float:
    plain = text.removesuffix("%")
    try:
        value = float(plain) / (100 if plain != text else 1)
    except ValueError:
        value = -1.0
    if not 0 <= value < _LARGEST_ERROR:
        raise UsageError(
            f"scale errors have {text!r}; a share is a number from 0 to "
            f"{_LARGEST_ERROR:g}, or a percentage as '1 %'"
        )
    return value
