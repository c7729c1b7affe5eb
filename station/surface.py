# SPDX-License-Identifier: MIT
"""``jointbench surface``: structure function and fractal parameters of surfaces."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.height_facts import cautions
from jointbench.acquisition.records import Step
from jointbench.acquisition.surfaces import Surface
from jointbench.signal.fractal import fit_fractal
from jointbench.signal.structure_function import StructureFunction
from jointbench.signal.surface_treatment import treated_structure
from jointbench.signal.surface_verdict import FractalFit
from jointbench.station.inputs import read_surfaces
from jointbench.station.output import (
    console,
    engineering,
    table,
    with_sd,
    working,
    write_json,
)
from jointbench.station.outputs import check_outputs
from jointbench.station.roughness_words import (
    HEADING,
    caution_lines,
    roughness_json,
    roughness_words,
)
from jointbench.station.surface_options import (
    NOTHING_BESIDE,
    PLAIN,
    Beside,
    SurfaceOptions,
    beside_the_fit,
    pooled_beside,
    pooled_structure,
    require_suited,
)


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceChain:
    """A surface, its structure function and what it says."""

    surface: Surface
    structure: StructureFunction
    fit: FractalFit
    beside: Beside = NOTHING_BESIDE


@dataclass(frozen=True, slots=True, eq=False)
class Pooled:
    """Several profiles as one structure function, and what it says."""

    structure: StructureFunction
    fit: FractalFit
    beside: Beside


def analyse_surface(surface: Surface, options: SurfaceOptions = PLAIN) -> SurfaceChain:
    """Take a surface to its fractal parameters, or to the reason why it has none.

    Raises:
        UsageError: an option does not suit the surface.
        SurfaceTooSmall: too few measured points.
    """
    flat, structure = treated_structure(surface, options.treatment)
    beside = beside_the_fit(flat, structure, options)
    return SurfaceChain(flat, structure, fit_fractal(structure), beside)


def run_surface(
    files: Sequence[Path],
    *,
    columns: str | None,
    json_target: str | None,
    options: SurfaceOptions = PLAIN,
) -> tuple[SurfaceChain, ...]:
    """Fit every surface in `files` and show the verdicts.

    Raises:
        UsageError: an option does not suit a surface.
        BadData: a file cannot be read, or a surface is too small.
    """
    check_outputs(files, [json_target])
    read = read_surfaces(files, columns=columns)
    given = [surface for _, surface in read]
    require_suited(given, options)
    chains = []
    results: list[dict[str, object]] = []
    for path, surface in read:
        with working(f"fitting {surface.name}"):
            chain = analyse_surface(surface, options)
        chains.append(chain)
        results.append({"file": str(path)} | surface_json(chain))
    pooled = _pooled(given, chains) if options.pool else None
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
    """Print verdict, D, G and the reason of each surface, and what else was asked."""
    screen = console(json_target)
    rows = [(chain.surface.name, *_numbers(chain.fit)) for chain in chains]
    if pooled is not None:
        rows.append((pooled.structure.name, *_numbers(pooled.fit)))
    columns = ("surface", "verdict", "D [-]", HEADING, "fit band")
    screen.print(table("Surfaces (D ± one standard deviation)", columns, rows))
    for chain in chains:
        for said in chain_cautions(chain):
            screen.print(f"  {said}", markup=False)
        screen.print(f"  {chain.surface.name}: {chain.fit.reason}", markup=False)
        screen.print(f"  {chain.surface.name}: {_origin(chain)}", markup=False)
        for line in chain.beside.lines:
            screen.print(f"  {chain.surface.name}: {line}", markup=False)
    if pooled is not None:
        for line in (pooled.fit.reason, *pooled.beside.lines):
            screen.print(f"  {pooled.structure.name}: {line}", markup=False)


def _pooled(given: Sequence[Surface], chains: Sequence[SurfaceChain]) -> Pooled:
    """Fit all profiles as one."""
    with working("fitting all profiles as one"):
        structure = pooled_structure(given, [chain.surface for chain in chains])
        fit = fit_fractal(structure)
    dimensions = [chain.fit.dimension for chain in chains]
    return Pooled(structure, fit, pooled_beside(structure, dimensions))


def _pooled_json(pooled: Pooled, chains: Sequence[SurfaceChain]) -> dict[str, object]:
    """Return what is told of all profiles as one."""
    said = dict.fromkeys(s for c in chains for s in cautions(c.surface.provenance))
    return {
        **_fit_json(pooled.structure.name, pooled.fit, tuple(said)),
        "profiles": [chain.surface.name for chain in chains],
        **dict(pooled.beside.keys),
    }


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


def chain_cautions(chain: SurfaceChain) -> tuple[str, ...]:
    """Return what to keep in mind about the heights, one line each."""
    return caution_lines(chain.surface.name, cautions(chain.surface.provenance))


def _origin(chain: SurfaceChain) -> str:
    """Say in one line what the file was taken for."""
    known = [s for s in chain.surface.provenance if s.name == "recognise"]
    if not known:
        return "made in memory"
    detail = dict(known[0].detail)
    return f"read as {detail.get('format', 'a table')} ({_why(known[0])})"


def _why(recognised: Step) -> str:
    detail = dict(recognised.detail)
    return str(detail.get("reason", "no reason kept"))


def surface_json(chain: SurfaceChain) -> dict[str, object]:
    """Return what the contract promises of ``surface``, and more."""
    said = cautions(chain.surface.provenance)
    return {
        **_fit_json(chain.surface.name, chain.fit, said),
        **dict(chain.beside.keys),
    }


def _fit_json(name: str, fit: FractalFit, said: Sequence[str]) -> dict[str, object]:
    return {
        "surface": name,
        "verdict": fit.verdict.value,
        "reason": fit.reason,
        "cautions": list(said),
        "dimension": fit.dimension,
        "dimension_sd": fit.dimension_sd,
        **roughness_json(fit.scaling),
        "fit_band_m": fit.fit_band,
        "instrument": fit.instrument,
        "instrument_parameters": [
            {"name": p.name, "value_m": p.value, "sd_m": p.sd}
            for p in fit.instrument_parameters
        ],
        "chi2_per_dof": fit.chi2_per_dof,
        "pivot_m": fit.pivot,
        "pivot_value_m2": fit.pivot_value,
        "local_slope": {
            "lag_m": fit.local_slope.lag.tolist(),
            "slope": fit.local_slope.slope.tolist(),
            "sd": fit.local_slope.sd.tolist(),
        },
        "provenance": [{"step": s.name, **dict(s.detail)} for s in fit.provenance],
    }
