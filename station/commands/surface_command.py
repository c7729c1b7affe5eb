# SPDX-License-Identifier: MIT
"""``jointbench surface``: structure function and fractal parameters of surfaces."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from jointbench.acquisition.formats.heights.height_facts import cautions
from jointbench.acquisition.records.provenance import Step
from jointbench.acquisition.records.surfaces import Surface
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.fractal.verdict_records import FractalFit
from jointbench.signal.surface.surface_treatment import SurfaceTreatment
from jointbench.station.files.input_files import read_surfaces
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.files.structure_map_file import write_structure_map
from jointbench.station.pipeline.pooled_surface import pooled_beside, pooled_structure
from jointbench.station.pipeline.roughness_words import (
    HEADING,
    roughness_words,
)
from jointbench.station.pipeline.surface_json import fit_json, surface_json
from jointbench.station.pipeline.surface_options import (
    PLAIN,
    SurfaceOptions,
    require_suited,
)
from jointbench.station.pipeline.surface_stages import (
    Pooled,
    SurfaceChain,
    analyse_surface,
    chain_cautions,
    with_band,
    with_remedy,
    with_texture,
)
from jointbench.station.roughness.texture_screen import measured_of, show_textures
from jointbench.station.roughness.texture_words import pooled_json
from jointbench.station.screen.band_limited_words import (
    COLUMNS,
    TITLE,
    band_json,
    band_lines,
    band_row,
)
from jointbench.station.screen.terminal import console, table, working, write_json
from jointbench.station.screen.value_text import engineering, with_sd


def run_surface(
    files: Sequence[Path],
    *,
    columns: str | None,
    json_target: str | None,
    options: SurfaceOptions = PLAIN,
) -> tuple[SurfaceChain, ...]:
    """Fit every surface in `files` and show the verdicts.

    Raises:
        UsageError: an option does not apply to a surface.
        BadData: a file cannot be read, or a surface is too small.
    """
    check_outputs(files, [json_target, options.structure_map])
    read = read_surfaces(files, columns=columns)
    given = [surface for _, surface in read]
    require_suited(given, options)
    chains = []
    results: list[dict[str, object]] = []
    for path, surface in read:
        with working(f"fitting {surface.name}"):
            fitted = with_band(analyse_surface(surface, options), options)
            chain = with_remedy(fitted, surface, options)
            chain = with_texture(chain, surface, options)
        if options.structure_map is not None:
            write_structure_map(chain.surface, options.structure_map)
        chains.append(chain)
        results.append({"file": str(path)} | surface_json(chain))
    pooled = _pooled(given, chains, options.treatment) if options.pool else None
    show_surfaces(chains, json_target, pooled)
    found: dict[str, object] = {"files": results}
    if pooled is not None:
        found["pooled"] = _pooled_json(pooled, chains)
    write_json(json_target, found)
    return tuple(chains)


def show_surfaces(
    chains: Sequence[SurfaceChain],
    json_target: str | None,
    pooled: Pooled | None = None,
) -> None:
    """Print verdict, D, G and reason of each surface, and optional results."""
    screen = console(json_target)
    rows = [(chain.surface.name, *_numbers(chain.fit)) for chain in chains]
    if pooled is not None:
        rows.append((pooled.structure.name, *_numbers(pooled.fit)))
    columns = ("surface", "verdict", "D [-]", HEADING, "fit band")
    screen.print(table("Surfaces (D ± one standard deviation)", columns, rows))
    for chain in chains:
        for caution in chain_cautions(chain):
            screen.print(f"  {caution}", markup=False)
        screen.print(f"  {chain.surface.name}: {chain.fit.reason}", markup=False)
        if chain.remedy is not None:
            screen.print(f"  {chain.surface.name}: {chain.remedy}", markup=False)
        screen.print(f"  {chain.surface.name}: {_origin(chain)}", markup=False)
        for line in chain.beside.lines:
            screen.print(f"  {chain.surface.name}: {line}", markup=False)
    _show_bands(screen, chains, pooled)
    show_textures(screen, chains, pool=pooled is not None)
    if pooled is not None:
        for line in (pooled.fit.reason, *pooled.beside.lines):
            screen.print(f"  {pooled.structure.name}: {line}", markup=False)


def _show_bands(
    screen: Console, chains: Sequence[SurfaceChain], pooled: Pooled | None
) -> None:
    """Print the band-limited surface of each chain, and of all profiles as one."""
    found = [(c.surface.name, c.band, c.no_band) for c in chains]
    if pooled is not None:
        found.append((pooled.structure.name, pooled.band, None))
    rows = [band_row(name, band) for name, band, _ in found]
    screen.print(table(TITLE, COLUMNS, rows))
    for name, band, reason in found:
        for line in band_lines(band, reason):
            screen.print(f"  {name}: {line}", markup=False)


def _pooled(
    given: Sequence[Surface],
    chains: Sequence[SurfaceChain],
    treatment: SurfaceTreatment,
) -> Pooled:
    """Fit all profiles together."""
    with working("fitting the pooled profiles"):
        structure = pooled_structure(given, [chain.surface for chain in chains])
        fit = fit_fractal(structure)
        band = fit_band_limited(
            [chain.surface for chain in chains], degree=treatment.form or 1
        )
    dimensions = [chain.fit.dimension for chain in chains]
    return Pooled(structure, fit, pooled_beside(structure, dimensions), band)


def _pooled_json(pooled: Pooled, chains: Sequence[SurfaceChain]) -> dict[str, object]:
    """Return the result of the pooled profiles as JSON."""
    notes = dict.fromkeys(s for c in chains for s in cautions(c.surface.provenance))
    return {
        **fit_json(pooled.structure.name, pooled.fit, tuple(notes)),
        "profiles": [chain.surface.name for chain in chains],
        "band_limited": band_json(pooled.band, None),
        **dict(pooled.beside.keys),
        **_pooled_texture(chains),
    }


def _pooled_texture(chains: Sequence[SurfaceChain]) -> dict[str, object]:
    """Return the mean standard parameters of profiles that have them."""
    several = measured_of(chains)
    return {"texture": pooled_json(several)} if len(several) > 1 else {}


def _numbers(fit: FractalFit) -> tuple[str, str, str, str]:
    if fit.scaling is None or fit.fit_band is None:
        return fit.verdict.value, "-", "-", "-"
    low, high = (engineering(end, "m") for end in fit.fit_band)
    return (
        fit.verdict.value,
        with_sd(fit.scaling.dimension, fit.scaling.dimension_sd),
        roughness_words(fit.scaling),
        f"{low} to {high}",
    )


def _origin(chain: SurfaceChain) -> str:
    """Return the format in which a file was read, and why."""
    known = [s for s in chain.surface.provenance if s.name == "recognise"]
    if not known:
        return "not read from a file"
    detail = dict(known[0].detail)
    return f"read as {detail.get('format', 'a table')} ({_why(known[0])})"


def _why(recognised: Step) -> str:
    detail = dict(recognised.detail)
    return str(detail.get("reason", "reason unknown"))
