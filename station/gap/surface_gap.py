# SPDX-License-Identifier: MIT
"""A measured surface as a source of `gap`: what self-affinity lacks to explain it."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from jointbench.acquisition.basics.errors import UnitError, UsageError
from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.records.surfaces import Surface
from jointbench.analysis.gap.law_diagnosis.surface_diagnosis import (
    SurfaceDiagnosis,
    diagnose_surface,
)
from jointbench.signal.surface.complete_lines import missing_words


def examine_surface(
    paths: Sequence[Path],
    *,
    without: frozenset[str],
    progress: Callable[[str], None],
) -> tuple[SurfaceDiagnosis, tuple[str, ...]]:
    """Read and diagnose a surface.

    Args:
        paths: one profile or map, or profiles of one surface at different places.
        without: names of effects to leave out of the catalogue.
        progress: receives one line per step.

    Returns:
        The diagnosis, and what sums it up, a line each.

    Raises:
        BadData: a file cannot be read, or its heights do not suffice.
        UsageError: several maps, or `without` holds an unknown name.
    """
    progress("reading the heights")
    surfaces = [_read(path) for path in paths]
    done = diagnose_surface(surfaces, without=without, progress=progress)
    return done, (*_summary(done), *_missing(surfaces))


def _read(path: Path) -> Surface:
    if not path.exists():
        raise UsageError(f"'{path}' does not exist")
    try:
        return read_surface(path)
    except UnitError as error:
        raise UsageError(
            f"{str(error).split(';')[0]}; for a surface write units above the columns, "
            "for example x:mm,z:um; hits go into a session by 'jointbench import'"
        ) from error


def _missing(surfaces: Sequence[Surface]) -> Iterator[str]:
    for surface in surfaces:
        words = missing_words(surface)
        if words:
            yield f"{surface.name}: {words}"


def _summary(done: SurfaceDiagnosis) -> tuple[str, ...]:
    hurst = done.found.base[0]
    law = f"H = {hurst.value:.3f} ± {hurst.sd:.3f} of the self-affine base"
    return (f"summary: {done.summary.value}; {law}",)
