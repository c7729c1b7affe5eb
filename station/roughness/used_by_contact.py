# SPDX-License-Identifier: MIT
"""Which descriptions of a surface contact laws take: D, G, H, moments, parameters."""

from jointbench.signal.band_limited.band_records import BandLimitedFit, Interval95
from jointbench.signal.fractal.verdict_records import FractalFit
from jointbench.station.roughness.texture_request import TextureAnswer
from jointbench.station.screen.value_text import engineering, with_sd

TITLE = "what contact laws take of a surface"
COLUMNS = ("quantity", "value", "taken by")
_FRACTAL = "fractal contact laws (mb_2d, ke_3d_modified ...)"
_SPECTRAL = "laws by spectral moments"
_NONE = "no law: it depends on the L-filter"


def contact_rows(
    fit: FractalFit, band: BandLimitedFit | None, answer: TextureAnswer
) -> list[tuple[str, str, str]]:
    """Return quantities next to each other, and which laws take them.

    Args:
        fit: D and G of the surface.
        band: the band-limited surface; None where none was fitted.
        answer: standard parameters.
    """
    scaling = fit.scaling
    dimension = roughness = "-"
    if scaling is not None:
        dimension = with_sd(scaling.dimension, scaling.dimension_sd)
        if scaling.roughness_known:
            roughness = engineering(scaling.roughness, "m")
        else:
            roughness = "open over a decade"
    rows = [("D [-]", dimension, _FRACTAL), ("G", roughness, _FRACTAL)]
    moments = None if band is None else band.moments
    rows.append(("H [-]", _number(None if band is None else band.hurst), _SPECTRAL))
    if moments is not None:
        height = engineering(moments.height.value, "m")
        rows.append(("rms height in the band", height, _SPECTRAL))
        rows.append(("rms slope in the band [-]", _number(moments.slope), _SPECTRAL))
    if answer.measured is not None:
        letter = "R" if answer.measured.texture.heights.ndim == 1 else "S"
        for name, unit in ((f"{letter}q", "m"), (f"{letter}dq", "")):
            value = answer.measured.named(name).value
            shown = "-" if value is None else engineering(value, unit).strip()
            rows.append((name if unit else f"{name} [-]", shown, _NONE))
    return rows


def _number(interval: Interval95 | None) -> str:
    return "-" if interval is None else f"{interval.value:.4g}"
