# SPDX-License-Identifier: MIT
"""Roughness of a plateau-honed profile: linear and robust filter, and what noise adds.

`python examples/roughness.py` prints Ra, Rz and the core parameters with intervals.
"""

import sys

import numpy as np
from scipy.ndimage import gaussian_filter1d

from jointbench.acquisition.records.surfaces import Profile, all_valid
from jointbench.signal.roughness.setting_classes import setting_class
from jointbench.signal.roughness.texture_records import TextureSettings
from jointbench.signal.roughness.texture_uncertainty import measured_texture
from jointbench.signal.roughness.uncertain_parameters import InstrumentErrors

PITCH, POINTS = 0.5e-6, 10_000


def honed_profile(seed: int) -> Profile:
    """Return fine roughness of 0.1 um with grooves of 2 um, and noise of 5 nm."""
    rng = np.random.default_rng(seed)
    heights = gaussian_filter1d(rng.normal(size=POINTS), 10)
    heights *= 0.1e-6 / heights.std()
    place = np.arange(POINTS)
    for middle in rng.uniform(0, POINTS, 40):
        heights -= 2e-6 * np.exp(-(((place - middle) / 30) ** 2))
    heights += 5e-9 * rng.normal(size=POINTS)
    return Profile("honed", heights, PITCH, all_valid(heights))


def main() -> None:
    """Print the parameters by both filters."""
    profile, chosen = honed_profile(1), setting_class("Sc3")
    errors = InstrumentErrors(height=0.01, pitch=0.005)
    lines = []
    for robust in (False, True):
        settings = TextureSettings(chosen.short, chosen.long, robust=robust)
        found = measured_texture(profile, settings, errors)
        lines.append("robust L-filter" if robust else "linear L-filter")
        for name in ("Ra", "Rz", "Rk", "Rpk", "Rvk"):
            one = found.named(name)
            low, high = one.interval or (np.nan, np.nan)
            middle = 1e6 * (one.value or np.nan)
            ends = f"{1e6 * low:.3f} to {1e6 * high:.3f}"
            lines.append(f"  {name:3} {middle:.3f} µm (95 %: {ends})")
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
