# SPDX-License-Identifier: MIT
"""The surface bench: spectrum, long waves and shapes of a measured surface.

It has the interface of every bench, so that directed tests, descent, scores and rivals
are those of the one engine. The base is self-affine at all wavelengths, seen by the
instrument as its file states it; each row is the signed root of a deviance, so that the
cost is Whittle's likelihood.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.bench_protocol import values_of
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Blocks, Fit
from jointbench.analysis.gap.residuals.noise_models import Noise
from jointbench.analysis.gap.residuals.scatter_record import no_scatter
from jointbench.analysis.gap.surface_bench.shape_rows import ShapeRow
from jointbench.analysis.gap.surface_bench.surface_catalogue import (
    surface_catalogue,
    surface_probes,
)
from jointbench.analysis.gap.surface_bench.surface_effect import SurfaceEffect
from jointbench.analysis.gap.surface_bench.surface_rows import SurfaceRows
from jointbench.analysis.gap.surface_bench.surface_settings import SURFACE
from jointbench.analysis.gap.surface_bench.surface_sizes import surface_scales
from jointbench.analysis.gap.surface_bench.surface_state import (
    ENDLESS,
    RoundingNoise,
    SurfaceState,
    rounding_noise,
)
from jointbench.analysis.gap.surface_bench.surface_views import wave_labels
from jointbench.signal.band_limited.matern_spectrum import BandLimited

BASE_NAMES = ("level", "hurst")


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceBench:
    """A measured surface with a self-affine base, as the engine uses it.

    Attributes:
        rows: measured.
        entries: effects and probes by name and site word.
        candidates: the catalogue.
        probes: further shapes for directed tests.
        level: ln of the density at the pivot before any fit.
        pivot: [rad/sample].
        rounding: integral for rounding errors.
        blocks: groups of rows: by wavelength.
        scales: words to values.
        keep: rows that count, shape (n_rows,).
        policy: thresholds for its fits.
    """

    rows: SurfaceRows
    entries: dict[str, SurfaceEffect]
    candidates: tuple[Candidate, ...]
    probes: tuple[Candidate, ...]
    level: float
    pivot: float
    rounding: RoundingNoise
    blocks: Blocks
    scales: dict[str, float]
    keep: BoolArray
    policy: Policy = STANDARD

    @property
    def base_names(self) -> tuple[str, ...]:
        """Names of the base parameters."""
        return BASE_NAMES

    @property
    def base_sd(self) -> FloatArray:
        """Prior standard deviation of the coordinates, shape (2,)."""
        return np.array([SURFACE.level_sd, SURFACE.hurst_sd])

    @property
    def base_limits(self) -> tuple[FloatArray, FloatArray]:
        """Bounds of ln level over nominal and of H over nominal, shape (2,) each."""
        low = np.array([-30.0, 0.03 - SURFACE.hurst])
        return low, np.array([30.0, 1.1 - SURFACE.hurst])

    @property
    def noise(self) -> Noise:
        """Noise of the rows, which are standardised."""
        return Noise(np.ones((1, 1)), 0.0, no_scatter((), 1))

    @property
    def expanded(self) -> bool:
        """The model is never expanded about single values."""
        return False

    @property
    def stiffness_sd(self) -> FloatArray:
        """Empty: there are no hits."""
        return np.zeros(0)

    def at_stiffness(self, settling: FloatArray) -> "SurfaceBench":
        """Return the bench unchanged."""
        return self

    def phases(self, candidate: Candidate) -> int:
        """No effect fits a phase."""
        return 0

    def hints(self, fit: Fit, candidate: Candidate) -> list[FloatArray]:
        """No effect starts at peaks of the residual."""
        return []

    def scale(self, word: str) -> float:
        """Return the scale of a word [SI]."""
        return self.scales[word]

    def refine(
        self, base: FloatArray, terms: Sequence[Term], *, without: Sequence[int] = ()
    ) -> "SurfaceBench":
        """Return the bench unchanged: its noise is that of the likelihood."""
        return self

    def chosen(self, keep: BoolArray) -> "SurfaceBench":
        """Return the bench with some of its rows, shape (n_rows,)."""
        return replace(
            self, keep=keep, blocks=replace(self.blocks, dof=int(keep.sum()))
        )

    def state(self, base: FloatArray, terms: Sequence[Term]) -> SurfaceState:
        """Return the surface of a base with effects."""
        sample = self.rows.sample
        process = BandLimited(
            level=float(np.exp(np.clip(self.level + base[0], -300, 300))),
            pivot=self.pivot,
            hurst=float(SURFACE.hurst + base[1]),
            roll_off=ENDLESS,
        )
        state = SurfaceState(process, shapes=(0.0,) * len(ShapeRow))
        for term in terms:
            entry = self.entries[term.candidate.label]
            state = entry.act(values_of(self, term), state, sample)
        return state

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return the residual; the resolution does not matter here, (n_rows,)."""
        state = self.state(base, terms)
        found = self.rows.residual(state, self.rounded(state))
        shape = np.zeros(found.size)
        for term in terms:
            entry = self.entries[term.candidate.label]
            if entry.shape is not None:
                shape = shape + values_of(self, term)[0] * entry.shape
        return np.where(self.keep, found + shape, 0.0)

    def rounded(self, state: SurfaceState) -> FloatArray:
        """Return the density of rounding errors in the bins, shape (n_bins,)."""
        sample, integral = self.rows.sample, self.rounding
        if state.step <= 0:
            return np.zeros(sample.omega.size)
        density = state.sampled(integral.omega, sample.transfer)
        return integral.density(sample.omega, density, state.step)

    def slopes(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return d residual / d base, shape (n_rows, 2)."""
        at = self.residual(base, terms, resolution)
        found = np.empty((at.size, base.size))
        for k in range(base.size):
            moved = base.copy()
            moved[k] += SURFACE.slope_step
            found[:, k] = (self.residual(moved, terms, resolution) - at) / (
                SURFACE.slope_step
            )
        return found


def make_surface_bench(
    rows: SurfaceRows,
    *,
    without: frozenset[str] = frozenset(),
    policy: Policy = STANDARD,
) -> SurfaceBench:
    """Prepare the rows of a surface for the engine.

    Args:
        rows: measured.
        without: names of effects to leave out of the catalogue.
        policy: thresholds for its fits.

    Raises:
        UsageError: `without` holds an unknown name.
    """
    catalogue, probes = surface_catalogue(rows, without), surface_probes(rows)
    both = (*catalogue, *probes)
    effects = [Candidate(e.effect, e.site) for e in both]
    sample = rows.sample
    pivot = float(
        np.sqrt(min(np.pi, sample.transfer.highest) * 2 * np.pi / sample.points)
    )
    near = np.interp(np.log(pivot), np.log(sample.omega), np.log(sample.power))
    labels = wave_labels(rows)
    words = tuple(dict.fromkeys(labels))
    return SurfaceBench(
        rows=rows,
        entries=dict(zip((c.label for c in effects), both, strict=True)),
        candidates=tuple(effects[: len(catalogue)]),
        probes=tuple(effects[len(catalogue) :]),
        level=float(near),
        pivot=pivot,
        rounding=rounding_noise(SURFACE.longest_rounded),
        blocks=Blocks(
            np.array([words.index(one) for one in labels]),
            tuple({"wavelength": one} for one in words),
            rows.size,
            (1, 1, rows.size),
        ),
        scales=surface_scales(rows),
        keep=np.ones(rows.size, dtype=np.bool_),
        policy=policy,
    )
