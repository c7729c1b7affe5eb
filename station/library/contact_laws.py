# SPDX-License-Identifier: MIT
"""Stiffness and damping of a rough joint by a contact law."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.contact.spectral.measured_laws import MeasuredLaw
from jointbench.station.contact.measured_prediction import MeasuredPrediction
from jointbench.station.contact.measured_words import surface_lines, verdict_lines
from jointbench.station.files.input_files import read_surfaces
from jointbench.station.joints.measured_faces import predict_faces
from jointbench.station.library.labelled_arrays import dataset
from jointbench.station.library.line_plot import AxisView, Curve, line_plot
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.pipeline.contact_options import ContactOptions
from jointbench.station.pipeline.contact_prediction import (
    ContactPoint,
    predict_request,
    surface_of,
)
from jointbench.station.pipeline.contact_request import parse_request

if TYPE_CHECKING:
    from xarray import Dataset


_WITH_UNIT = ("roughness", "roughness_sd", "yield_strength", "mass", "frequency")
_MEASURED = frozenset(MeasuredLaw)


@dataclass(frozen=True, slots=True)
class _Row:
    """One law at one preload; NaN for what the law does not predict, SI units."""

    law: str
    preload: float
    stiffness: float
    low: float
    high: float
    tangential: float
    damping: float
    real_area: float
    verdict: str


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PredictedContact(Shown):
    """Predictions of one or several contact laws at one or several preloads.

    Attributes:
        points: each fractal law at each preload; none where none applies.
        measured: the laws of measured surfaces; None without `surface` and
            `nominal_area`.
    """

    points: tuple[ContactPoint, ...]
    measured: MeasuredPrediction | None = None

    def to_xarray(self) -> "Dataset":
        """Return stiffness, its interval and real area, one point each."""
        per, rows = ("point",), self._rows()
        return dataset(
            {
                "normal_stiffness": (
                    per,
                    [one.stiffness for one in rows],
                    "N m-1",
                    "normal stiffness",
                ),
                "normal_stiffness_interval": (
                    ("point", "end"),
                    [(one.low, one.high) for one in rows],
                    "N m-1",
                    "95 % interval of the normal stiffness",
                ),
                "tangential_stiffness": (
                    per,
                    [one.tangential for one in rows],
                    "N m-1",
                    "tangential stiffness",
                ),
                "damping": (
                    per,
                    [one.damping for one in rows],
                    "N s m-1",
                    "damping coefficient",
                ),
                "real_area": (per, [one.real_area for one in rows], "m2", "real area"),
            },
            {
                "preload": (per, [one.preload for one in rows], "N", "preload"),
                "law": (per, [one.law for one in rows], "", "contact law"),
                "verdict": (per, [one.verdict for one in rows], "", "verdict"),
                "end": (("end",), ["low", "high"], "", "end of the interval"),
            },
            {},
        )

    def _rows(self) -> tuple[_Row, ...]:
        """Return the laws of measured surfaces after the fractal ones."""
        found = [_fractal_row(one) for one in self.points]
        return (*found, *(_measured_rows(self.measured) if self.measured else ()))

    @property
    def view(self) -> ResultView:
        """One row a law and preload, with verdict; stiffness over preload drawn."""
        found = self._rows()
        rows = [
            (
                one.law,
                f"{one.preload:.4g} N",
                f"{one.stiffness:.4g}",
                f"{one.low:.3g} to {one.high:.3g}",
                "-" if math.isnan(one.tangential) else f"{one.tangential:.4g}",
                one.verdict,
            )
            for one in found
        ]
        said = dict.fromkeys(r for one in self.points for r in one.state.reasons)
        if self.measured is not None:
            lines = (*surface_lines(self.measured), *verdict_lines(self.measured))
            said |= dict.fromkeys(lines)
        laws = dict.fromkeys(one.law for one in found)
        curves = [self._curve(law) for law in laws]
        plot = line_plot(
            curves,
            AxisView("preload [N]", log=True),
            AxisView("normal stiffness [N/m]", log=True),
        )
        columns = (
            "law",
            "preload",
            "k_n [N/m]",
            "95 %",
            "k_t [N/m]",
            "verdict",
        )
        several = len(found) > len(laws)
        plots = (plot,) if several else ()
        return ResultView("Predicted joint", columns, tuple(rows), tuple(said), plots)

    def _curve(self, law: str) -> Curve:
        own = [one for one in self._rows() if one.law == law]
        return Curve(law, [one.preload for one in own], [one.stiffness for one in own])


def _fractal_row(one: ContactPoint) -> _Row:
    state, interval = one.state, one.interval
    return _Row(
        law=state.model,
        preload=state.preload,
        stiffness=state.normal_stiffness,
        low=interval.lower,
        high=interval.upper,
        tangential=state.tangential_stiffness,
        damping=math.nan if state.damping is None else state.damping,
        real_area=state.real_area,
        verdict=state.verdict.value,
    )


def _measured_rows(found: MeasuredPrediction) -> Iterator[_Row]:
    """Yield the laws of spectra; the fractal ones among them are points already."""
    area = found.case.area
    for k, preload in enumerate(found.preloads):
        for curve in (one for one in found.at if one.law in _MEASURED):
            yield _Row(
                law=curve.law,
                preload=preload,
                stiffness=float(curve.stiffness[k]) * area,
                low=float(curve.low[k]) * area,
                high=float(curve.high[k]) * area,
                tangential=math.nan,
                damping=math.nan,
                real_area=float(curve.real_area[k]) * area,
                verdict="does not apply" if curve.outside[k] else "applies",
            )


def contact(
    *,
    modulus: str,
    hardness: str,
    surface: str | Path | Sequence[str | Path] = (),
    load: Sequence[str] | str = (),
    torque: Sequence[str] | str = (),
    **options: Any,
) -> PredictedContact:
    """Predict stiffness and damping of a joint between rough surfaces.

    Args:
        modulus: effective modulus with unit, ``"29.3 GPa"``.
        hardness: with unit or scale, ``"1.5 GPa"`` or ``"231 HB"``.
        surface: files of one or two measured surfaces; with `nominal_area` they get
            the laws of their spectra too. Else give `dimension` and `roughness`.
        load: preloads with unit, ``["1 kN", "25 kN"]``.
        torque: bolt torques with unit; then `bolt_diameter` too.
        **options: those of ``jointbench contact`` by name, with ``_`` for ``-``.

    Returns:
        Each requested law at each preload, with intervals and verdicts.

    Raises:
        UsageError: an option is unknown, or options exclude each other.
        BadData: a number outside the range of a law, or without its unit.
    """
    known = {one.name for one in fields(ContactOptions)}
    if wrong := ", ".join(sorted(set(options) - known)):
        raise UsageError(
            f"contact has no option {wrong}; 'jointbench contact --help' lists them"
        )
    named = [surface] if isinstance(surface, str | Path) else surface
    files = [Path(one) for one in named]
    given = ContactOptions(
        modulus=_quantity("modulus", modulus),
        hardness=_quantity("hardness", hardness),
        surface=files or None,
        load=_quantities("load", load),
        torque=_quantities("torque", torque),
        **options,
    )
    for name in _WITH_UNIT:
        if (value := getattr(given, name)) is not None:
            _quantity(name, value)
    request = parse_request(given)
    if files and given.dimension is None and given.roughness is None:
        read = read_surfaces(given.surface or [], columns=given.columns)
        faces = predict_faces([one for _, one in read], request)
        fractal = faces.surface
        points = () if fractal is None else predict_request(request, fractal)
        return PredictedContact(points, faces.measured)
    rough = surface_of(
        given.dimension,
        given.roughness,
        files,
        given.columns,
        dimension_sd=given.dimension_sd,
        roughness_sd=given.roughness_sd,
    )
    return PredictedContact(predict_request(request, rough))


def _quantities(name: str, given: Sequence[str] | str) -> list[str] | None:
    listed = [given] if isinstance(given, str | float | int) else list(given)
    return [_quantity(name, one) for one in listed] or None


def _quantity(name: str, given: object) -> str:
    if not isinstance(given, str):
        raise UsageError(
            f"{name} is {given!r}; write it as text with its unit, e.g. '25 kN'"
        )
    return given
