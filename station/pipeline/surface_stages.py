# SPDX-License-Identifier: MIT
"""``jointbench surface``: structure function and fractal parameters of surfaces."""

from dataclasses import dataclass, replace

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.formats.heights.height_facts import cautions
from jointbench.acquisition.records.surfaces import Surface
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.band_limited.band_records import BandLimitedFit
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.fractal.verdict_records import FractalFit, SurfaceVerdict
from jointbench.signal.surface.form_removal import mask_outliers
from jointbench.signal.surface.structure_function import StructureFunction
from jointbench.signal.surface.surface_treatment import (
    outside_filters,
    treated_structure,
)
from jointbench.station.pipeline.roughness_words import (
    caution_lines,
)
from jointbench.station.pipeline.surface_options import (
    NOTHING_BESIDE,
    PLAIN,
    Beside,
    SurfaceOptions,
    beside_the_fit,
)
from jointbench.station.pipeline.surface_remedies import remedy
from jointbench.station.roughness.texture_request import (
    TextureAnswer,
    texture_answer,
)
from jointbench.station.screen.band_limited_words import qualified


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceChain:
    """A surface, its structure function and what it says.

    Attributes:
        surface: treated as asked.
        structure: its structure function.
        fit: D and G, or the reason for none.
        beside: what options ask in addition.
        remedy: what would give the surface a scaling range; None where it has one, or
            where none was looked for.
        band: the band-limited surface; None where none was fitted.
        no_band: why none was fitted.
        texture: standard parameters; None where they are not asked for.
    """

    surface: Surface
    structure: StructureFunction
    fit: FractalFit
    beside: Beside = NOTHING_BESIDE
    remedy: str | None = None
    band: BandLimitedFit | None = None
    no_band: str | None = None
    texture: TextureAnswer | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Pooled:
    """Several profiles as one structure function, and what it says."""

    structure: StructureFunction
    fit: FractalFit
    beside: Beside
    band: BandLimitedFit


def analyse_surface(surface: Surface, options: SurfaceOptions = PLAIN) -> SurfaceChain:
    """Take a surface to its fractal parameters, or to the reason why it has none.

    Raises:
        UsageError: an option does not suit the surface.
        SurfaceTooSmall: too few measured points.
    """
    flat, structure = treated_structure(surface, options.treatment)
    beside = beside_the_fit(flat, structure, options)
    fit = fit_fractal(outside_filters(structure, flat))
    return SurfaceChain(flat, structure, fit, beside)


def with_remedy(
    chain: SurfaceChain, given: Surface, asked: SurfaceOptions
) -> SurfaceChain:
    """Return a chain that names what would help a surface without a scaling range."""
    return replace(chain, remedy=remedy(given, chain.fit, asked.treatment))


def with_texture(
    chain: SurfaceChain, given: Surface, asked: SurfaceOptions
) -> SurfaceChain:
    """Return a chain with the standard parameters of the surface as measured."""
    if asked.texture is None:
        return chain
    outliers = asked.treatment.outliers
    heights = given if outliers is None else mask_outliers(given, limit=outliers)
    return replace(chain, texture=texture_answer(heights, asked.texture))


def with_band(chain: SurfaceChain, asked: SurfaceOptions) -> SurfaceChain:
    """Return a chain with its band-limited surface, and a verdict that heeds it."""
    if asked.treatment.direction is not None:
        said = "it runs along the rows of a map; leave out --direction"
        return replace(chain, no_band=said)
    try:
        band = fit_band_limited([chain.surface], degree=asked.treatment.form or 1)
    except (BadData, UsageError) as error:
        return replace(chain, no_band=str(error))
    verdict, reason = qualified(chain.fit, band)
    fit = replace(chain.fit, verdict=SurfaceVerdict(verdict), reason=reason)
    return replace(chain, band=band, fit=fit)


def chain_cautions(chain: SurfaceChain) -> tuple[str, ...]:
    """Return what to keep in mind about the heights, one line each."""
    return caution_lines(chain.surface.name, cautions(chain.surface.provenance))
