# SPDX-License-Identifier: MIT
"""The band-limited surface in words and as plain data."""

import numpy as np

from jointbench.signal.band_limited.band_records import (
    BandLimitedFit,
    Interval95,
    RollOffVerdict,
    RoughnessMoments,
    SurfaceLay,
)
from jointbench.signal.fractal.verdict_records import FractalFit, SurfaceVerdict
from jointbench.station.screen.value_text import engineering

COLUMNS = ("surface", "quantity", "value", "95 %")
TEXT_COLUMNS = frozenset({0, 1})
"""Columns of the table that are text."""
_FAR = 3.0
"""Distance of a short cut from that of the stated stylus that is reported [sd]."""
TITLE = "Band-limited surfaces (95 % intervals)"


def band_rows(name: str, fit: BandLimitedFit | None) -> list[tuple[str, ...]]:
    """Return the rows of a surface in the table of band-limited surfaces."""
    if fit is None:
        return [(name, "-", "-", "-")]
    rows = _shape_rows(fit)
    if fit.moments is not None:
        moments = fit.moments
        rows.append(("rms height", *_metres(moments.height)))
        rows.append(("rms slope [-]", *_plain(moments.slope)))
        curvature = moments.curvature.times(1e-6)
        rows.append(("rms curvature [1/µm]", *_plain(curvature)))
    return [(name if k == 0 else "", *row) for k, row in enumerate(rows)]


def _shape_rows(fit: BandLimitedFit) -> list[tuple[str, str, str]]:
    """Return H and roll-off, or those along a lay and across it."""
    lay = fit.lay
    if lay is None:
        rows = [] if fit.hurst is None else [("H [-]", *_plain(fit.hurst))]
        return [*rows, *_roll_off_rows(fit)]
    rows = [
        ("direction of the lay [deg]", *_degrees(lay.angle)),
        ("wavelength along / across [-]", *_plain(lay.ratio)),
        ("H along the lay [-]", *_plain(lay.hurst_along)),
        ("H across the lay [-]", *_plain(lay.hurst_across)),
    ]
    if lay.roll_off_along is None or lay.roll_off_across is None:
        return [*rows, *_roll_off_rows(fit)]
    rows.append(("roll-off along the lay", *_metres(lay.roll_off_along)))
    rows.append(("roll-off across the lay", *_metres(lay.roll_off_across)))
    return rows


def _roll_off_rows(fit: BandLimitedFit) -> list[tuple[str, str, str]]:
    if fit.roll_off is not None:
        return [("roll-off", *_metres(fit.roll_off))]
    if fit.roll_off_beyond is None:
        return []
    ends = f"beyond {engineering(fit.roll_off_beyond, 'm')}"
    likeliest = fit.roll_off_likeliest
    if fit.verdict is not RollOffVerdict.UNDECIDED or likeliest is None:
        return [("roll-off", "-", ends)]
    return [("roll-off, not decided", engineering(likeliest, "m"), ends)]


def band_lines(fit: BandLimitedFit | None, reason: str | None) -> tuple[str, ...]:
    """Return what holds of the longest waves, and between which wavelengths."""
    if fit is None:
        return (f"no band-limited fit: {reason}",)
    said = [f"longest waves: {fit.verdict.value}; {fit.reason}"]
    if fit.lay is not None:
        said.append(lay_words(fit.lay))
    if fit.moments is None:
        said.append("no wavelength shows the surface: filters and noise hide it")
    else:
        ends = (fit.moments.shortest, fit.moments.longest)
        low, high = (engineering(end, "m") for end in ends)
        said.append(f"height, slope and curvature of waves of {low} to {high}")
    if fit.tip_deviation is not None:
        said.append(_tip_words(fit.tip_deviation))
    elif fit.short_cut is not None and fit.short_cut.low > 0:
        said.append(
            f"waves are cut by half at {_with_ends(fit.short_cut)}, beyond what is "
            "stated of the instrument: by the surface or by a blur that is not stated"
        )
    return tuple(said)


def lay_words(lay: SurfaceLay) -> str:
    """Return the direction of a lay and how much longer waves are along it."""
    angle, _ = _degrees(lay.angle)
    ratio, ends = _plain(lay.ratio)
    return (
        f"lay at {angle} degrees from the rows: waves along it are {ratio} times "
        f"({ends}) as long as across it"
    )


def _tip_words(deviation: float) -> str:
    if abs(deviation) <= _FAR:
        return "the short cut is that of the stated stylus"
    word = "wider" if deviation > 0 else "narrower"
    return (
        f"the short cut is {word} than that of the stated stylus, by "
        f"{abs(deviation):.1f} standard deviations: is the radius right, is it worn?"
    )


def band_json(fit: BandLimitedFit | None, reason: str | None) -> dict[str, object]:
    """Return the fit as plain data; ``verdict`` and ``reason`` are always there."""
    if fit is None:
        return {"verdict": None, "reason": reason}
    return {
        "verdict": fit.verdict.value,
        "reason": fit.reason,
        "hurst": _ends(fit.hurst),
        "roll_off_m": _ends(fit.roll_off),
        "roll_off_beyond_m": fit.roll_off_beyond,
        "roll_off_likeliest_m": fit.roll_off_likeliest,
        "height_rms_m": _ends(fit.height),
        "short_cut_m": _ends(fit.short_cut),
        "tip_deviation": fit.tip_deviation,
        "noise_m": fit.noise,
        "tolerance": fit.tolerance,
        "fitted": "map" if fit.mapped else "lines",
        "lay": None if fit.lay is None else _lay(fit.lay),
        "moments": None if fit.moments is None else _moments(fit.moments),
    }


def qualified(fit: FractalFit, band: BandLimitedFit | None) -> tuple[str, str]:
    """Return verdict and reason of a fractal fit in the light of the longest waves.

    A surface that rolls off is fractal within a band, and where the trace is too short
    to decide, "fractal" has that qualification.
    """
    verdict, reason = fit.verdict, fit.reason
    if band is None or verdict is not SurfaceVerdict.FRACTAL:
        return verdict.value, reason
    if band.verdict is RollOffVerdict.SATURATED and band.roll_off is not None:
        low, high = (
            engineering(end, "m") for end in (band.roll_off.low, band.roll_off.high)
        )
        said = f"the spectrum is level beyond a wavelength of {low} to {high}"
        return SurfaceVerdict.BAND.value, f"{reason}; {said}"
    if band.verdict is RollOffVerdict.UNDECIDED and band.roll_off_beyond is not None:
        beyond = engineering(band.roll_off_beyond, "m")
        said = f"fractal, or saturated beyond {beyond}: too short to decide"
        return verdict.value, f"{reason}; {said}"
    return verdict.value, reason


def _metres(part: Interval95) -> tuple[str, str]:
    value, low, high = (
        engineering(one, "m") for one in (part.value, part.low, part.high)
    )
    return value, f"{low} to {high}"


def _plain(part: Interval95) -> tuple[str, str]:
    return f"{part.value:.3g}", f"{part.low:.3g} to {part.high:.3g}"


def _with_ends(part: Interval95) -> str:
    value, ends = _metres(part)
    return f"{value} ({ends})"


def _degrees(part: Interval95) -> tuple[str, str]:
    value, low, high = (np.degrees(one) for one in (part.value, part.low, part.high))
    return f"{value:.1f}", f"{low:.1f} to {high:.1f}"


def _ends(part: Interval95 | None) -> dict[str, float] | None:
    if part is None:
        return None
    return {"value": part.value, "low": part.low, "high": part.high}


def _lay(lay: SurfaceLay) -> dict[str, object]:
    return {
        "angle_deg": _ends(lay.angle.times(180 / np.pi)),
        "ratio": _ends(lay.ratio),
        "hurst_along": _ends(lay.hurst_along),
        "hurst_across": _ends(lay.hurst_across),
        "roll_off_along_m": _ends(lay.roll_off_along),
        "roll_off_across_m": _ends(lay.roll_off_across),
    }


def _moments(moments: RoughnessMoments) -> dict[str, object]:
    return {
        "shortest_m": moments.shortest,
        "longest_m": moments.longest,
        "height_rms_m": _ends(moments.height),
        "slope_rms": _ends(moments.slope),
        "curvature_rms_per_m": _ends(moments.curvature),
        "modelled": moments.modelled,
    }
