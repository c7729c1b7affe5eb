# SPDX-License-Identifier: MIT
"""The catalogue of the surface bench, and the shapes that are never named."""

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.model.effect import PROBE_FAMILY, Effect
from jointbench.analysis.gap.model.effect_parameter import Parameter
from jointbench.analysis.gap.surface_bench.fault_effects import fault_effects
from jointbench.analysis.gap.surface_bench.instrument_effects import (
    instrument_effects,
)
from jointbench.analysis.gap.surface_bench.process_effects import process_effects
from jointbench.analysis.gap.surface_bench.surface_effect import (
    SurfaceEffect,
    unchanged,
)
from jointbench.analysis.gap.surface_bench.surface_rows import SurfaceRows
from jointbench.analysis.gap.surface_bench.surface_views import wave_labels

SURFACE_NAMES = (
    "rolloff",
    "second_process",
    "plateau",
    "tool_marks",
    "form",
    "lay",
    "tip",
    "blur",
    "noise",
    "quantisation",
    "outliers",
    "missing_points",
)


def surface_catalogue(
    rows: SurfaceRows, without: frozenset[str] = frozenset()
) -> tuple[SurfaceEffect, ...]:
    """Return the effects that a surface can show.

    Args:
        rows: measured; an effect whose rows are missing is left out.
        without: names of effects to leave out.

    Raises:
        UsageError: `without` holds an unknown name.
    """
    unknown = sorted(without - set(SURFACE_NAMES))
    if unknown:
        raise UsageError(
            f"no effect {unknown[0]!r} in the catalogue of surfaces; there are: "
            + ", ".join(SURFACE_NAMES)
        )
    found = [*process_effects(rows), *instrument_effects(rows), *fault_effects(rows)]
    return tuple(e for e in found if e.effect.name not in without)


def surface_probes(rows: SurfaceRows) -> tuple[SurfaceEffect, ...]:
    """Return a bump of the spectrum at each range of wavelengths.

    Args:
        rows: measured.
    """
    labels = np.array(wave_labels(rows))
    count = np.zeros(rows.size)
    long = np.zeros(0) if rows.long is None else rows.long.count
    both = np.concatenate([long, rows.sample.count])
    count[: both.size] = np.sqrt(both)
    waves = labels[: both.size]
    found = []
    for word in dict.fromkeys(waves.tolist()):
        size = np.where(labels == word, count, 0.0)
        if np.count_nonzero(size) > 1:
            found.append(_probe(f"bump at {word}", size))
    return tuple(found)


def _probe(name: str, shape: np.ndarray) -> SurfaceEffect:
    return SurfaceEffect(
        Effect(
            name.replace(" ", "_"),
            PROBE_FAMILY,
            (Parameter("size", "-", lower=-5.0, upper=5.0, off=0.0),),
            source="shape of a residual",
        ),
        unchanged,
        shape=shape,
    )
