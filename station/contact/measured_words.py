# SPDX-License-Identifier: MIT
"""Laws of measured surfaces in rows, lines and plain data."""

from collections.abc import Iterator, Sequence

import numpy as np

from jointbench.analysis.contact.spectral.measured_laws import LawCurve
from jointbench.signal.band_limited.band_records import RollOffVerdict
from jointbench.station.contact.measured_prediction import MeasuredPrediction
from jointbench.station.contact.surface_spectrum import LAY
from jointbench.station.screen.band_limited_words import band_json
from jointbench.station.screen.value_text import engineering

COLUMNS = (
    "law",
    "preload [N]",
    "k = K/A [N/m³]",
    "K [N/m]",
    "95 % of K",
    "gap",
    "real area [%]",
    "applies",
)
_PREFERRED = ("persson", "bush_gibson_thomas", "greenwood_williamson", "yovanovich")
REMEDY = (
    "what is outside is below; 'jointbench pressure-map' solves measured maps without "
    "a law of random heights"
)


def law_rows(found: MeasuredPrediction) -> list[tuple[str, ...]]:
    """Return one row for each law and preload."""
    area = found.case.area
    return [
        (
            curve.law,
            f"{load:.6g}",
            f"{curve.stiffness[j]:.3g}",
            f"{curve.stiffness[j] * area:.3g}",
            f"{curve.low[j] * area:.3g}–{curve.high[j] * area:.3g}",
            "-"
            if np.isnan(curve.separation[j])
            else engineering(float(curve.separation[j]), "m"),
            f"{100 * curve.real_area[j]:.3g}",
            "no" if curve.outside[j] else "yes",
        )
        for j, load in enumerate(found.preloads)
        for curve in found.at
    ]


def law_title(found: MeasuredPrediction) -> str:
    """Return the surfaces and the reference area."""
    both = " and ".join(found.names) if len(found.names) > 1 else f"{found.names[0]}, "
    alike = "" if len(found.names) > 1 else "both sides alike"
    return f"Laws of measured surfaces: {both}{alike}; A = {found.case.area:g} m²"


def surface_lines(found: MeasuredPrediction) -> list[str]:
    """Return the numbers of the combined surface that the laws take."""
    case = found.case
    roots = np.sqrt([case.surface.moment(power) for power in (0, 2)])
    (height, slope), ends = roots[:, 0], np.quantile(roots[:, 1:], [0.025, 0.975], 1)
    low, high = (
        engineering(one, "m") for one in (case.surface.shortest, case.surface.longest)
    )
    facts = case.facts
    return [
        f"both surfaces together, waves of {low} to {high}: "
        f"h_rms = {engineering(float(height), 'm')} "
        f"({engineering(float(ends[0, 0]), 'm')} to "
        f"{engineering(float(ends[1, 0]), 'm')}), "
        f"h' = {slope:.3g} ({ends[0, 1]:.3g} to {ends[1, 1]:.3g})",
        f"hills of {engineering(float(case.surface.mean_wave()[0]), 'm')}, "
        f"{case.hills:.3g} in the apparent area; plasticity index "
        f"{case.plasticity_index:.2g}; skewness {facts.skewness:.2g}, excess kurtosis "
        f"{facts.kurtosis:.2g}",
        *_cautions(found),
    ]


def _cautions(found: MeasuredPrediction) -> Iterator[str]:
    if found.profiles:
        yield (
            "a profile does not show a lay: the laws take it as equal in all "
            "directions; measure a map to test it"
        )
    if found.case.lay >= LAY:
        yield (
            f"a lay: slopes along rows and columns differ by a factor of "
            f"{found.case.lay:.2g}; the laws take the mean of both spectra and were "
            "judged on surfaces without a lay"
        )
    open_ended = [
        name
        for name, fit in zip(found.names, found.fits, strict=True)
        if fit.verdict is not RollOffVerdict.SATURATED
    ]
    if open_ended:
        longest = engineering(found.case.surface.longest, "m")
        yield (
            f"{', '.join(open_ended)}: the longest waves were not seen; waves longer "
            f"than {longest} are waviness and in no law here"
        )


def verdict_lines(found: MeasuredPrediction) -> list[str]:
    """Return which law applies, how far apart the laws lie, and why."""
    lines = []
    for j, load in enumerate(found.preloads):
        pressure = engineering(load / found.case.area, "Pa")
        lines += [f"at {load:.6g} N ({pressure}): {one}" for one in _at(found, j)]
    lines += [*_reasons(found), _scale(found)]
    if found.no_fractal is not None:
        lines.append(f"no fractal law: {found.no_fractal}")
    return lines


def applying(found: MeasuredPrediction, place: int) -> list[LawCurve]:
    """Return the laws that apply at a preload, the most general one first."""
    ours = [one for one in found.at if not one.outside[place]]
    names = [*_PREFERRED, *(one.law for one in ours if one.law not in _PREFERRED)]
    return sorted(ours, key=lambda one: names.index(one.law))


def _at(found: MeasuredPrediction, place: int) -> Iterator[str]:
    area, ours = found.case.area, applying(found, place)
    if ours:
        best = ours[0]
        low, high = best.low[place] * area, best.high[place] * area
        also = ", ".join(one.law for one in ours[1:])
        yield (
            f"{best.law} applies, K = {best.stiffness[place] * area:.3g} N/m "
            f"({low:.2g} to {high:.2g})"
            + (
                f"; so do {also}, within a factor {_apart(ours, place):.2f}"
                * bool(also)
            )
        )
    else:
        yield f"no law applies; {REMEDY}"
    least, most = _ends(found.at, place)
    yield (
        f"all laws lie within a factor {_apart(found.at, place):.2f}, from {least.law} "
        f"to {most.law}"
    )


def _ends(curves: Sequence[LawCurve], place: int) -> tuple[LawCurve, LawCurve]:
    # A fractal law has no stiffness where every contact is plastic.
    known = [one for one in curves if one.stiffness[place] > 0]
    return (
        min(known, key=lambda one: one.stiffness[place]),
        max(known, key=lambda one: one.stiffness[place]),
    )


def _apart(curves: Sequence[LawCurve], place: int) -> float:
    least, most = _ends(curves, place)
    return float(most.stiffness[place] / least.stiffness[place])


def _reasons(found: MeasuredPrediction) -> list[str]:
    """Return why laws do not apply, at which preloads."""
    lines = []
    for curve in found.at:
        places: dict[str, list[int]] = {}
        for j, why in enumerate(curve.outside):
            if why:
                places.setdefault("; ".join(why), []).append(j)
        for said, at in places.items():
            whole = len(at) == len(found.preloads)
            loads = ", ".join(f"{found.preloads[j]:.6g} N" for j in at)
            where = "" if whole else f" at {loads}"
            lines.append(f"{curve.law} does not apply{where}: {said}")
    return lines


def _scale(found: MeasuredPrediction) -> str:
    """Return how much the shortest octave of the surface decides."""
    before = {curve.law: curve.stiffness[0] for curve in found.at}
    parts = [
        f"{curve.law} {100 * (curve.stiffness[0] / before[curve.law] - 1):+.0f} %"
        for curve in found.coarser
    ]
    low = engineering(found.case.surface.shortest, "m")
    return f"without the shortest octave, from {low} on: {', '.join(parts)}"


def measured_json(found: MeasuredPrediction) -> dict[str, object]:
    """Return a prediction as plain data; areas and pressures are nominal."""
    case = found.case
    return {
        "surfaces": list(found.names),
        "band_limited": [band_json(fit, None) for fit in found.fits],
        "reference_area_m2": case.area,
        "height_rms_m": case.height,
        "gradient_rms": case.gradient,
        "shortest_m": case.surface.shortest,
        "longest_m": case.surface.longest,
        "mean_wave_m": float(case.surface.mean_wave()[0]),
        "skewness": case.facts.skewness,
        "excess_kurtosis": case.facts.kurtosis,
        "plasticity_index": case.plasticity_index,
        "laws": [
            _point(found, curve, j)
            for j in range(len(found.preloads))
            for curve in found.at
        ],
        "curves": [
            {
                "name": curve.law,
                "pressure_Pa": curve.pressure.tolist(),
                "stiffness_per_area": curve.stiffness.tolist(),
                "low": curve.low.tolist(),
                "high": curve.high.tolist(),
                "applies": [not said for said in curve.outside],
            }
            for curve in found.curve
        ],
        "lines": [*surface_lines(found), *verdict_lines(found)],
    }


def _point(found: MeasuredPrediction, curve: LawCurve, j: int) -> dict[str, object]:
    area = found.case.area
    gap = float(curve.separation[j])
    return {
        "name": curve.law,
        "preload": found.preloads[j],
        "pressure_Pa": float(curve.pressure[j]),
        "stiffness_per_area": float(curve.stiffness[j]),
        "normal_stiffness": float(curve.stiffness[j]) * area,
        "normal_stiffness_interval": [
            float(curve.low[j]) * area,
            float(curve.high[j]) * area,
        ],
        "gap_m": None if np.isnan(gap) else gap,
        "real_area": float(curve.real_area[j]) * area,
        "applies": not curve.outside[j],
        "reasons": list(curve.outside[j]),
    }
