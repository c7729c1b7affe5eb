# SPDX-License-Identifier: MIT
"""What the instrument is known to do to each wavelength."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Surface
from jointbench.signal.surface.applied_filters import long_waves_removed
from jointbench.signal.surface.gaussian_filter import transmission

_SHORTEST = 2.0
"""Shortest wavelength that a grid resolves [samples]."""


@dataclass(frozen=True, slots=True)
class KnownTransfer:
    """Filters that the instrument or a treatment applied, in units of the pitch.

    Attributes:
        short: cut-off lambda_s [samples]; None without.
        long: cut-off lambda_c [samples]; None without.
        tip: radius of the stylus over the pitch [-]; None without. Its effect depends
            on the surface and is a prior, see `TipWidth`.
    """

    short: float | None = None
    long: float | None = None
    tip: float | None = None

    def power(self, omega: FloatArray) -> FloatArray:
        """Return the transmitted share of the power.

        Args:
            omega: wavenumber [rad/sample], not negative, any shape.
        """
        passed = np.ones_like(omega)
        if self.short is not None:
            passed *= transmission(omega, self.short)
        if self.long is not None:
            passed *= 1 - transmission(omega, self.long)
        power: FloatArray = np.square(passed)
        return power

    @property
    def highest(self) -> float:
        """Wavenumber above which the surface lies inside a filter [rad/sample]."""
        return 2 * np.pi / max(_SHORTEST, self.short or 0.0)

    @property
    def lowest(self) -> float:
        """Wavenumber below which it does [rad/sample]; 0 without a filter."""
        return 0.0 if self.long is None else 2 * np.pi / self.long


def known_transfer(surface: Surface) -> KnownTransfer:
    """Return the filters of a surface in units of the pitch along its lines.

    A file may state lambda_c next to a primary profile, which is not filtered by it:
    the cut-off counts where the export is called filtered or a treatment applied it.
    """
    spacing = surface.spacing
    pitch = spacing if isinstance(spacing, float) else spacing[1]
    given = surface.instrument

    def samples(length: float | None) -> float | None:
        return None if length is None else length / pitch

    long = given.cutoff_long if long_waves_removed(surface) else None
    return KnownTransfer(
        samples(given.cutoff_short), samples(long), samples(given.stylus_radius)
    )
