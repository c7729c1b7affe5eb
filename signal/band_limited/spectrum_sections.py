# SPDX-License-Identifier: MIT
"""Measured and fitted spectra of lines, and of a map in two directions."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, freeze
from jointbench.acquisition.records.surfaces import Areal, Surface
from jointbench.signal.band_limited.band_records import BandLimitedFit
from jointbench.signal.band_limited.known_transfer import known_transfer
from jointbench.signal.band_limited.map_sample import MapSample, map_sample
from jointbench.signal.band_limited.seen_bins import seen_bins
from jointbench.signal.surface.levelling import level
from jointbench.signal.surface.line_spectrum import line_spectrum

_SECTOR = np.pi / 8
"""Half the width of the directions along and across a lay [rad]."""
_RINGS = 1.15
"""Ratio of the wavelengths at the edges of a ring [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class SpectrumSection:
    """A measured spectrum and the fitted one at the same wavelengths.

    Attributes:
        name: of the direction; empty for lines and for maps without a lay.
        wavelength: [m], shape (n,), descending.
        measured: density, of lines [m^3], of maps over both wavenumbers [m^4], (n,).
        count: independent ordinates in each mean [-], (n,).
        fitted: the same density of the fitted surface as the instrument shows it;
            None without a self-affine band, (n,).
    """

    name: str
    wavelength: FloatArray
    measured: FloatArray
    count: FloatArray
    fitted: FloatArray | None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "wavelength", "measured", "count")

    @property
    def residual(self) -> FloatArray | None:
        """Measured over fitted density as a logarithm [-]."""
        if self.fitted is None:
            return None
        ratio: FloatArray = np.log(self.measured / self.fitted)
        return ratio


def spectrum_sections(
    surface: Surface, fit: BandLimitedFit | None
) -> Sequence[SpectrumSection]:
    """Return the spectra of a surface that show its band-limited fit.

    Args:
        surface: as it was fitted.
        fit: of it; None for the measured spectrum alone.
    """
    if fit is not None and fit.mapped and isinstance(surface, Areal):
        sample = map_sample(surface)
        return () if sample is None else _of_map(sample, fit)
    found = line_spectrum(level(surface))
    if found is None:
        return ()
    fitted = None
    if fit is not None and fit.model is not None:
        omega = 2 * np.pi * fit.pitch * found.frequency
        unit = 4 * np.pi * fit.pitch * fit.scale**2
        fitted = unit * fit.model.sampled(omega, known_transfer(surface))
    wavelength = 1 / found.frequency
    return (SpectrumSection("", wavelength, found.density, found.count, fitted),)


def _of_map(sample: MapSample, fit: BandLimitedFit) -> list[SpectrumSection]:
    """Return the sections along a lay and across it, or one over all directions."""
    radius = np.hypot(sample.along, sample.down)
    unit = (sample.scale * sample.pitch) ** 2
    fitted = None
    if fit.map_model is not None:
        fitted = unit * seen_bins(sample).density(fit.map_model)
    parts: list[tuple[str, BoolArray]] = [("", np.ones(radius.size, dtype=np.bool_))]
    if fit.lay is not None:
        turn = np.arctan2(sample.down, sample.along) - fit.lay.angle.value
        apart = np.abs((turn + np.pi / 2) % np.pi - np.pi / 2)
        parts = [
            ("along the lay", apart <= _SECTOR),
            ("across the lay", apart >= np.pi / 2 - _SECTOR),
        ]
    return [_section(name, sample, inside, fitted) for name, inside in parts]


def _section(
    name: str, sample: MapSample, inside: BoolArray, fitted: FloatArray | None
) -> SpectrumSection:
    """Return means over rings of the bins inside a range of directions."""
    radius = np.hypot(sample.along, sample.down)[inside]
    label = np.floor(np.log(radius) / np.log(_RINGS)).astype(np.int64)
    _, ring = np.unique(label, return_inverse=True)
    weight = sample.count[inside]
    count = np.asarray(np.bincount(ring, weight), dtype=np.float64)

    def mean(values: FloatArray) -> FloatArray:
        total: FloatArray = np.bincount(ring, weight * values) / count
        return total

    unit = (sample.scale * sample.pitch) ** 2
    return SpectrumSection(
        name=name,
        wavelength=2 * np.pi * sample.pitch / mean(radius),
        measured=unit * mean(sample.power[inside]),
        count=count,
        fitted=None if fitted is None else mean(fitted[inside]),
    )
