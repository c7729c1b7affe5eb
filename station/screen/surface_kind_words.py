# SPDX-License-Identifier: MIT
"""Marks, bends, crossing directions and two processes of a surface, in words."""

import numpy as np

from jointbench.signal.band_limited.surface_kinds import SurfaceKinds
from jointbench.station.screen.value_text import engineering


def kind_lines(kinds: SurfaceKinds | None) -> tuple[str, ...]:
    """Return what is found on a surface beside a self-affine band, one line each."""
    if kinds is None:
        return ()
    said = []
    if kinds.marks is not None:
        where = f" along the {kinds.marks.along}" if kinds.marks.along else ""
        said.append(
            f"periodic marks every {engineering(kinds.marks.wavelength, 'm')}{where}, "
            f"{100 * kinds.marks.share:.0f} % of the variance: turned, milled or ground"
        )
    if kinds.directions:
        angles = " and ".join(f"{np.degrees(one):.0f}" for one in kinds.directions)
        said.append(f"two directions, {angles} degrees from the rows: honed")
    if kinds.bend is not None:
        bend = kinds.bend
        said.append(
            f"two power laws: H {bend.hurst_short:.2f} at waves shorter than "
            f"{engineering(bend.wavelength, 'm')}, {bend.hurst_long:.2f} at longer ones"
        )
    if kinds.two_processes:
        said.append(
            f"heights of two processes (skewness {kinds.skewness:.2f}): "
            f"{'plateaus over valleys' if kinds.skewness < 0 else 'peaks over a floor'}"
        )
    return tuple(said)


def kinds_json(kinds: SurfaceKinds | None) -> dict[str, object] | None:
    """Return the same as plain data."""
    if kinds is None:
        return None
    marks, bend = kinds.marks, kinds.bend
    return {
        "periodic_marks": None
        if marks is None
        else {
            "wavelength_m": marks.wavelength,
            "variance_share": marks.share,
            "along": marks.along or None,
        },
        "bend": None
        if bend is None
        else {
            "wavelength_m": bend.wavelength,
            "hurst_short": bend.hurst_short,
            "hurst_long": bend.hurst_long,
        },
        "directions_deg": np.degrees(kinds.directions).tolist(),
        "skewness": kinds.skewness,
        "two_processes": kinds.two_processes,
    }
