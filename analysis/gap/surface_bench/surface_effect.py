# SPDX-License-Identifier: MIT
"""One effect of the surface bench: a change of the surface or of its instrument."""

from collections.abc import Callable
from dataclasses import dataclass

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Effect, Site
from jointbench.analysis.gap.surface_bench.surface_state import SurfaceState
from jointbench.signal.band_limited.line_sample import LineSample

SURFACE_SITE = Site("surface", "heights")
INSTRUMENT_SITE = Site("instrument", "profilometer")
Act = Callable[[FloatArray, SurfaceState, LineSample], SurfaceState]


def unchanged(
    values: FloatArray, state: SurfaceState, sample: LineSample
) -> SurfaceState:
    """Return the state as it is: of a shape that no physics explains."""
    return state


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceEffect:
    """An entry of the catalogue of the surface bench.

    Attributes:
        effect: name, parameters, source and rivals.
        act: its physics, from values [SI], state and sample to the state with it.
        site: where it is reported.
        shape: of a probe: what one unit adds to the residual, shape (n_rows,).
    """

    effect: Effect
    act: Act
    site: Site = SURFACE_SITE
    shape: FloatArray | None = None
