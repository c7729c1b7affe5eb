# SPDX-License-Identifier: MIT
"""Time and values of the areal parameters beside surfalize, in one run.

python -m benchmarks.surface.roughness_speed --side 2048 times all parameters that both
have, after the same S-filter. Surfalize is no dependency: pip install surfalize.
"""

import argparse
import time
from collections.abc import Callable

import numpy as np
import scipy.fft
from surfalize import Surface
from surfalize.filter import GaussianFilter

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Areal, all_valid
from jointbench.signal.roughness.texture_operators import surface_texture
from jointbench.signal.roughness.texture_parameters import texture_parameters
from jointbench.signal.roughness.texture_records import TextureSettings

PITCH, S_INDEX = 1e-6, 5e-6
SHARED = "Sa Sq Sz Sp Sv Ssk Sku Sal Str Std Sdq Sdr Sk Spk Svk Smr1 Smr2".split()
SHARED += "Sxp Vmp Vmc Vvc Vvv".split()
OURS = {"Smr1": "Smrk1", "Smr2": "Smrk2"}
SCALE = {"Ssk": 1, "Sku": 1, "Str": 1, "Sdq": 1, "Sdr": 100, "Smr1": 100, "Smr2": 100}
SCALE |= {"Std": 180 / np.pi}


def rough_map(side: int) -> FloatArray:
    """Return a Gaussian map with a lay, by its spectrum [m]."""
    rng = np.random.default_rng(1)
    rows, columns = np.fft.fftfreq(side)[:, None], np.fft.rfftfreq(side)[None, :]
    shape = np.exp(-((rows * 60) ** 2 + (columns * 25) ** 2))
    spectrum = shape * scipy.fft.rfft2(rng.standard_normal((side, side)))
    heights = scipy.fft.irfft2(spectrum, (side, side))
    return 1e-6 * heights / heights.std()


def ours(heights: FloatArray) -> dict[str, float | None]:
    """Return our parameters; ends and missing points are treated by regression."""
    areal = Areal("map", heights, (PITCH, PITCH), all_valid(heights))
    texture = surface_texture(areal, TextureSettings(S_INDEX, None))
    return texture_parameters(texture).values


def theirs(heights: FloatArray) -> dict[str, float]:
    """Return the parameters of surfalize, which counts in micrometres."""
    surface = Surface(heights * 1e6, PITCH * 1e6, PITCH * 1e6).level()
    smooth = GaussianFilter(S_INDEX * 1e6, "lowpass")(surface).center()
    return {name: float(getattr(smooth, name)()) for name in SHARED}


def timed(action: Callable[[], object], repeats: int) -> float:
    """Return the least processor time of a few runs [s]."""
    times = []
    for _ in range(repeats):
        started = time.process_time()
        action()
        times.append(time.process_time() - started)
    return min(times)


def main() -> None:
    """Print times, then values."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--side", type=int, default=2048)
    parser.add_argument("--repeats", type=int, default=2)
    asked = parser.parse_args()
    heights = rough_map(asked.side)
    mine, other = ours(heights), theirs(heights)
    spent = [timed(lambda f=f: f(heights), asked.repeats) for f in (ours, theirs)]  # type: ignore[misc]
    print("| what | processor time |\n|---|---|")
    print(f"| jointbench, {asked.side} x {asked.side} | {spent[0]:.2f} s |")
    print(f"| surfalize | {spent[1]:.2f} s |")
    print(f"| ratio | {spent[0] / spent[1]:.2f} |\n")
    print("| parameter | jointbench | surfalize | relative difference |")
    print("|---|---|---|---|")
    for name in SHARED:
        one = (mine[OURS.get(name, name)] or np.nan) * SCALE.get(name, 1e6)
        apart = one / other[name] - 1 if other[name] else one
        print(f"| {name} | {one:.6g} | {other[name]:.6g} | {apart:.1e} |")


if __name__ == "__main__":
    main()
