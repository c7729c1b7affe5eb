# SPDX-License-Identifier: MIT
"""Fractal and band-limited parameters of a measured surface."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Surface
from jointbench.station.library.labelled_arrays import dataset
from jointbench.station.library.line_plot import AxisView, Curve, line_plot
from jointbench.station.library.measurements import open_measurement
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.pipeline.surface_options import (
    SurfaceOptions,
    surface_treatment,
)
from jointbench.station.pipeline.surface_stages import (
    SurfaceChain,
    analyse_surface,
    chain_cautions,
    with_band,
    with_remedy,
)
from jointbench.station.screen.band_limited_words import COLUMNS, band_lines, band_rows
from jointbench.station.screen.value_text import with_sd

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FittedSurface(Shown):
    """A surface with its structure function and what it says.

    Attributes:
        chain: surface as treated, structure function, fractal and band-limited fit.
    """

    chain: SurfaceChain

    def to_xarray(self) -> "Dataset":
        """Return the structure function over the lag, with D and G as attributes."""
        structure, fit = self.chain.structure, self.chain.fit
        facts = {
            "surface": self.chain.surface.name,
            "verdict": fit.verdict.value,
            "dimension": fit.dimension,
            "dimension_sd": fit.dimension_sd,
            "roughness_m": fit.roughness,
        }
        words = "mean square height difference"
        return dataset(
            {"structure_function": (("lag",), structure.value, "m2", words)},
            {"lag": (("lag",), structure.lag, "m", "distance along the surface")},
            facts,
        )

    @property
    def view(self) -> ResultView:
        """Verdict, D and the band-limited surface; the structure function drawn."""
        chain, fit = self.chain, self.chain.fit
        dimension = (
            "-"
            if fit.scaling is None
            else with_sd(fit.scaling.dimension, fit.scaling.dimension_sd)
        )
        bands = [row[1:] for row in band_rows("", chain.band)]
        said = [*chain_cautions(chain), fit.reason, *filter(None, [chain.remedy])]
        said += band_lines(chain.band, chain.no_band)
        structure = chain.structure
        plot = line_plot(
            [Curve("", structure.lag, structure.value)],
            AxisView("lag [m]", log=True),
            AxisView("S [m2]", log=True),
        )
        return ResultView(
            f"{chain.surface.name}: {fit.verdict.value}",
            COLUMNS[1:],
            (("D [-]", dimension, "-"), *bands),
            tuple(said),
            (plot,),
        )


def surface(
    source: Surface | str | Path,
    *,
    columns: str | None = None,
    form: int | None = None,
    outliers: float | None = None,
    filter: str | None = None,  # noqa: A002
    direction: float | None = None,
) -> FittedSurface:
    """Fit the parameters of one measured surface.

    Args:
        source: a surface of a measurement, or a file with one surface.
        columns: of plain tables, with units, for example ``"x:um,z:um"``.
        form: degree of the polynomial that is removed first [-].
        outliers: limit beyond which heights are masked [robust standard deviations].
        filter: cut-offs lambda_s and lambda_c, for example ``"2.5 um:0.8 mm"``.
        direction: of the lines of a map [deg].

    Returns:
        Verdict, D and G where there is a scaling range, and the band-limited surface.

    Raises:
        BadData: the file cannot be read, or the surface is too small.
        UsageError: an option does not suit the surface, or the file holds several.
    """
    given = source if isinstance(source, Surface) else _only(source, columns)
    options = SurfaceOptions(surface_treatment(form, outliers, filter, direction))
    chain = with_band(analyse_surface(given, options), options)
    return FittedSurface(with_remedy(chain, given, options))


def _only(path: str | Path, columns: str | None) -> Surface:
    found = open_measurement(path, columns=columns).surfaces
    if len(found) != 1:
        if not found:
            raise UsageError(
                f"'{path}' holds no surface; give a file of heights, or state its "
                "columns, for example columns='x:um,z:um'"
            )
        names = ", ".join(one.name for one in found)
        raise UsageError(
            f"'{path}' holds the surfaces {names}; give one of "
            "jointbench.open(...).surfaces"
        )
    return found[0]
