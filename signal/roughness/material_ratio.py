# SPDX-License-Identifier: MIT
"""Material ratio curve (Abbott curve) and the parameters of its core and volumes."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

_CENTRAL_SHARE = 0.4
"""Material ratio that the central region spans [-]."""
_PEAK_RATIO, _VALLEY_RATIO = 0.10, 0.80
"""Material ratios that bound peak, core and valley volumes [-]."""
_EXTREME_RATIO, _MIDDLE_RATIO = 0.025, 0.5
"""Material ratios of the extreme peak height Sxp [-]."""
_ROUNDING = 1e-12
"""Heights closer than this share of their range are equal [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class MaterialRatio:
    """Heights in descending order; each point has an equal share of the material.

    Attributes:
        heights: [m], shape (n,), descending.
    """

    heights: FloatArray

    def height_at(self, ratio: float) -> float:
        """Return the height that a share of the material reaches [m]."""
        place = ratio * self.heights.size - 0.5
        return float(np.interp(place, np.arange(self.heights.size), self.heights))

    def ratio_at(self, height: float) -> float:
        """Return the share of the material above a height [-]."""
        rising = self.heights[::-1]
        low, high = (int(np.searchsorted(rising, height, s)) for s in ("left", "right"))
        return float(1 - 0.5 * (low + high) / rising.size)

    def area_above(self, ratio: float) -> float:
        """Return the integral of the height from a ratio of 0 to another [m]."""
        place = ratio * self.heights.size
        whole = int(place)
        rest = (place - whole) * self.heights[min(whole, self.heights.size - 1)]
        return float((self.heights[:whole].sum() + rest) / self.heights.size)


def material_ratio(heights: FloatArray) -> MaterialRatio:
    """Return the material ratio curve of measured heights [m], any shape."""
    return MaterialRatio(np.sort(heights, axis=None)[::-1])


def core_parameters(curve: MaterialRatio) -> dict[str, float | None]:
    """Return the parameters of the two-line construction.

    Returns:
        ``k`` core height, ``pk`` reduced peak height, ``vk`` reduced valley depth [m],
        ``mr1`` and ``mr2`` material ratios at the ends of the core [-] (None for
        a plane).

    Source:
        ISO 21920-2:2021, 4.6 and ISO 25178-2:2021, annex B: the equivalent line is the
        least-squares line of the central 40 % whose secant is flattest; the areas
        beyond its ends become triangles of equal area.
    """
    heights = curve.heights
    if heights[0] == heights[-1]:
        return {"k": 0.0, "pk": 0.0, "vk": 0.0, "mr1": None, "mr2": None}
    slope, top = _equivalent_line(heights)
    bottom = top + slope
    # A plateau of equal heights belongs to the core, whatever rounding does.
    rounding = _ROUNDING * float(heights[0] - heights[-1])
    first = curve.ratio_at(top + rounding)
    second = curve.ratio_at(bottom - rounding)
    peaks = curve.area_above(first) - first * top
    whole = float(heights.mean())
    valleys = (1 - second) * bottom - (whole - curve.area_above(second))
    return {
        "k": 0.0 - slope,
        "pk": max(2 * peaks / first, 0.0) if first > 0 else 0.0,
        "vk": max(2 * valleys / (1 - second), 0.0) if second < 1 else 0.0,
        "mr1": first,
        "mr2": second,
    }


def _equivalent_line(heights: FloatArray) -> tuple[float, float]:
    """Return slope [m per unit ratio] and height at the ratio 0 [m]."""
    points = heights.size
    window = max(2, round(_CENTRAL_SHARE * points))
    fall = heights[: points - window + 1] - heights[window - 1 :]
    start = int(np.argmin(fall))
    central = heights[start : start + window]
    place = np.arange(window) - (window - 1) / 2
    per_point = float(place @ central) / float(place @ place)
    middle = start + 0.5 * window
    return per_point * points, float(central.mean()) - per_point * middle


def volume_parameters(curve: MaterialRatio) -> dict[str, float]:
    """Return material and void volumes over the area, and the extreme peak height.

    Returns:
        ``Vmp``, ``Vmc``, ``Vvc``, ``Vvv`` [m^3/m^2] and ``Sxp`` [m].

    Source:
        ISO 25178-2:2021, 4.6, with the ratios 10 % and 80 %, 2.5 % and 50 %.
    """
    high, low = curve.height_at(_PEAK_RATIO), curve.height_at(_VALLEY_RATIO)
    to_high, to_low = curve.area_above(_PEAK_RATIO), curve.area_above(_VALLEY_RATIO)
    peaks = to_high - _PEAK_RATIO * high
    material = to_low - _VALLEY_RATIO * low
    valleys = (1 - _VALLEY_RATIO) * low - (float(curve.heights.mean()) - to_low)
    void = (1 - _PEAK_RATIO) * high - (float(curve.heights.mean()) - to_high)
    return {
        "Vmp": peaks,
        "Vmc": material - peaks,
        "Vvc": void - valleys,
        "Vvv": valleys,
        "Sxp": curve.height_at(_EXTREME_RATIO) - curve.height_at(_MIDDLE_RATIO),
    }
