# SPDX-License-Identifier: MIT
"""Three bent profiles of one surface: form, outliers, pooling, bands and filters.

Usage: python examples/rough_surface.py
"""

import sys
from dataclasses import replace

import numpy as np
from scipy.integrate import trapezoid

from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.surface.line_spectrum import line_spectrum
from jointbench.signal.surface.pooled_profiles import pool_profiles
from jointbench.signal.surface.surface_treatment import (
    SurfaceTreatment,
    treated,
    treated_structure,
)
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile

POINTS, SPACING = 4000, 0.5e-6  # [-], [m]


def main() -> None:
    """Print what each step gives."""
    bow = 2e-5 * np.linspace(-1, 1, POINTS) ** 2
    profiles = []
    for seed in range(3):
        rough = rough_profile(
            POINTS, spacing=SPACING, dimension=1.5, roughness=1e-10, seed=seed
        )
        heights = rough.heights + bow
        heights[700] += 1e-5
        profiles.append(replace(rough, heights=heights))
    steps = SurfaceTreatment(form=2, outliers=6)
    raw, found = (
        fit_fractal(treated_structure(profiles[0], one)[1])
        for one in (SurfaceTreatment(), steps)
    )
    flat = [treated(profile, steps) for profile in profiles]
    pooled = fit_fractal(pool_profiles(flat))
    rows = {"as measured": raw, "form, outliers": found, "three profiles": pooled}
    for words, fit in rows.items():
        number = "no D" if fit.scaling is None else f"D = {fit.dimension:.3f}"
        sys.stdout.write(f"{words}: {fit.verdict.value}, {number}\n")
    band = fit_band_limited(flat)
    if band.hurst is not None and band.moments is not None:
        slope, hurst = band.moments.slope, band.hurst
        sys.stdout.write(
            f"{band.verdict.value}: H {hurst.low:.2f} to {hurst.high:.2f}, "
            f"rms slope {slope.low:.3f} to {slope.high:.3f}\n"
        )
    for long in (None, 2e-4):
        surface = treated(profiles[0], replace(steps, short=2e-6, long=long))
        spectrum = line_spectrum(surface)
        if spectrum is not None:
            variance = trapezoid(spectrum.density, spectrum.frequency)
            sys.stdout.write(f"rms of the waves: {1e9 * np.sqrt(variance):.0f} nm\n")


if __name__ == "__main__":
    main()
