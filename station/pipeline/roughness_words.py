# SPDX-License-Identifier: MIT
"""G of a surface in words: with its interval, or S at its pivot in its place.

G follows from D and S by an exponent of 1/(2 (D - 1)) and a lag far below all that was
measured, so a D that is sure to a hundredth may leave G open over decades.
"""

from collections.abc import Sequence

from jointbench.analysis.contact.surface import ContactSurface
from jointbench.signal.fractal.verdict_records import Scaling
from jointbench.station.screen.value_text import engineering

HEADING = "G (95 %), or S at its pivot"


def roughness_words(scaling: Scaling) -> str:
    """Return G with its interval, or S at the pivot where G is open over a decade."""
    if scaling.roughness_known:
        return f"{engineering(scaling.roughness, 'm')} {_range(*_metres(scaling))}"
    return level_words(scaling.pivot, scaling.pivot_value, scaling.pivot_value_interval)


def level_words(pivot: float, value: float, interval: tuple[float, float]) -> str:
    """Return S at a lag with its interval."""
    ends = (f"{1e12 * end:.3g}" for end in interval)
    place = engineering(pivot, "m")
    return f"S = {1e12 * value:.3g} µm² {_range(*ends)} at {place}"


def contact_surface_words(surface: ContactSurface) -> str:
    """Return D and G of the surface that a contact model takes, as far as known."""
    dimension = f"D = {surface.dimension:.4f} (line)"
    level, interval = surface.level, surface.roughness_interval
    if level is not None and not surface.roughness_known:
        words = level_words(level.pivot, level.value, level.interval)
        return f"{dimension}, {words}; G is open over more than a decade"
    given = f"{dimension}, G = {surface.roughness:.3g} m"
    if interval is None:
        return f"{given} as given"
    return f"{given} {_range(*(f'{end:.2g} m' for end in interval))}"


def roughness_json(scaling: Scaling | None) -> dict[str, object]:
    """Return G, null where it is open over a decade, its interval, and S."""
    if scaling is None:
        names = ("roughness_m", "roughness_interval_m", "roughness_known")
        return dict.fromkeys(names) | {"pivot_value_interval_m2": None}
    return {
        "roughness_m": scaling.roughness if scaling.roughness_known else None,
        "roughness_interval_m": scaling.roughness_interval,
        "roughness_known": scaling.roughness_known,
        "pivot_value_interval_m2": scaling.pivot_value_interval,
    }


def contact_surface_json(surface: ContactSurface | None) -> dict[str, object]:
    """Return the same of the surface that a contact model takes; null without one."""
    if surface is None:
        names = ("dimension", "pivot_m", "pivot_value_m2")
        return roughness_json(None) | dict.fromkeys(names) | {"cautions": []}
    level = surface.level
    return {
        "dimension": surface.dimension,
        "roughness_m": surface.roughness if surface.roughness_known else None,
        "roughness_interval_m": surface.roughness_interval,
        "roughness_known": surface.roughness_known,
        "pivot_m": None if level is None else level.pivot,
        "pivot_value_m2": None if level is None else level.value,
        "pivot_value_interval_m2": None if level is None else level.interval,
        "cautions": list(surface.cautions),
    }


def caution_lines(name: str, said: Sequence[str]) -> tuple[str, ...]:
    """Return one line for each caution about a surface."""
    return tuple(f"{name}: caution: {one}" for one in said)


def _metres(scaling: Scaling) -> tuple[str, str]:
    low, high = scaling.roughness_interval
    return engineering(low, "m"), engineering(high, "m")


def _range(low: str, high: str) -> str:
    return f"({low} to {high})"
