# SPDX-License-Identifier: MIT
"""Three bent profiles of one surface: form, outliers, filter, pooling, spectrum.

Usage: python examples/rough_surface.py
"""

import sys
from dataclasses import replace

import numpy as np
from scipy.integrate import trapezoid

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
    for long in (None, 2e-4):
        surface = treated(profiles[0], replace(steps, short=2e-6, long=long))
        spectrum = line_spectrum(surface)
        if spectrum is not None:
            variance = trapezoid(spectrum.density, spectrum.frequency)
            sys.stdout.write(f"rms of the waves: {1e9 * np.sqrt(variance):.0f} nm\n")


if __name__ == "__main__":
    main()
