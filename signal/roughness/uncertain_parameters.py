# SPDX-License-Identifier: MIT
"""Records of texture parameters with their uncertainties."""

from dataclasses import dataclass

import numpy as np

from jointbench.signal.roughness.texture_records import Texture

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
