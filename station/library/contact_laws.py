# SPDX-License-Identifier: MIT
"""Stiffness and damping of a rough joint by a contact law."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
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


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PredictedContact(Shown):
    """Predictions of one or several contact laws at one or several preloads.

    Attributes:
        points: each law at each preload.
    """

    points: tuple[ContactPoint, ...]

    def to_xarray(self) -> "Dataset":
        """Return stiffness, its interval and real area, one point each."""
        per, states = ("point",), [one.state for one in self.points]
        bounds = [(one.interval.lower, one.interval.upper) for one in self.points]
        damping = [np.nan if s.damping is None else s.damping for s in states]
        return dataset(
            {
                "normal_stiffness": (
                    per,
                    [s.normal_stiffness for s in states],
                    "N m-1",
                    "normal stiffness",
                ),
                "normal_stiffness_interval": (
                    ("point", "end"),
                    bounds,
                    "N m-1",
                    "95 % interval of the normal stiffness",
                ),
                "tangential_stiffness": (
                    per,
                    [s.tangential_stiffness for s in states],
                    "N m-1",
                    "tangential stiffness",
                ),
                "damping": (per, damping, "N s m-1", "damping coefficient"),
                "real_area": (per, [s.real_area for s in states], "m2", "real area"),
            },
            {
                "preload": (per, [s.preload for s in states], "N", "preload"),
                "law": (per, [s.model for s in states], "", "contact law"),
                "end": (("end",), ["low", "high"], "", "end of the interval"),
            },
            {},
        )

    @property
    def view(self) -> ResultView:
        """One row a law and preload, with verdict; stiffness over preload drawn."""
        rows = [
            (
                one.state.model,
                f"{one.state.preload:.4g} N",
                f"{one.state.normal_stiffness:.4g}",
                f"{one.interval.lower:.3g} to {one.interval.upper:.3g}",
                f"{one.state.tangential_stiffness:.4g}",
                one.state.verdict.value,
            )
            for one in self.points
        ]
        said = dict.fromkeys(r for one in self.points for r in one.state.reasons)
        laws = dict.fromkeys(one.state.model for one in self.points)
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
        several = len(self.points) > len(laws)
        plots = (plot,) if several else ()
        return ResultView("Predicted joint", columns, tuple(rows), tuple(said), plots)

    def _curve(self, law: str) -> Curve:
        own = [one.state for one in self.points if one.state.model == law]
        return Curve(law, [s.preload for s in own], [s.normal_stiffness for s in own])


def contact(
    *,
    modulus: str,
    hardness: str,
    surface: Sequence[str | Path] = (),
    load: Sequence[str] | str = (),
    torque: Sequence[str] | str = (),
    **options: Any,
) -> PredictedContact:
    """Predict stiffness and damping of a joint between rough surfaces.

    Args:
        modulus: effective modulus with unit, ``"29.3 GPa"``.
        hardness: with unit or scale, ``"1.5 GPa"`` or ``"231 HB"``.
        surface: files of one or two measured surfaces; else give `dimension` and
            `roughness`.
        load: preloads with unit, ``["1 kN", "25 kN"]``.
        torque: bolt torques with unit; then `bolt_diameter` too.
        **options: those of ``jointbench contact`` by name, with ``_`` for ``-``.

    Returns:
        Each requested law at each preload, with intervals and verdicts.

    Raises:
        UsageError: an option is unknown, or options exclude each other.
        BadData: a number outside the range of a law, or without its unit.
    """
    try:
        given = ContactOptions(
            modulus=modulus,
            hardness=hardness,
            surface=[Path(one) for one in surface] or None,
            load=[load] if isinstance(load, str) else list(load) or None,
            torque=[torque] if isinstance(torque, str) else list(torque) or None,
            **options,
        )
    except TypeError:
        known = {one.name for one in fields(ContactOptions)}
        wrong = ", ".join(sorted(set(options) - known))
        raise UsageError(
            f"contact has no option {wrong}; 'jointbench contact --help' lists them"
        ) from None
    rough = surface_of(
        given.dimension,
        given.roughness,
        given.surface or [],
        given.columns,
        dimension_sd=given.dimension_sd,
        roughness_sd=given.roughness_sd,
    )
    return PredictedContact(predict_request(parse_request(given), rough))
