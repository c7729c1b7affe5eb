# SPDX-License-Identifier: MIT
"""Interface of a bench: residuals of a base model plus effects."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.model.policy import Policy
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Blocks, Fit
from jointbench.analysis.gap.residuals.noise_models import Noise
from jointbench.analysis.gap.residuals.slopes import SlopeArray
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect


class Scaled(Protocol):
    """Converter of the scale words of a catalogue to sizes of one measurement."""

    def scale(self, word: str) -> float:
        """Return the bench's scale of that word [SI]."""
        ...


class Bench(Scaled, Protocol):
    """A measurement with its model, as the engine uses them."""

    @property
    def base_names(self) -> tuple[str, ...]:
        """Names of the base parameters."""
        ...

    @property
    def base_sd(self) -> FloatArray:
        """Prior standard deviation of log(parameter / nominal), shape (n_base,)."""
        ...

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """The catalogue at every site it applies to."""
        ...

    @property
    def probes(self) -> tuple[Candidate, ...]:
        """Shapes that are tested in addition to the catalogue, but never named."""
        ...

    @property
    def blocks(self) -> Blocks:
        """Groups of rows: one for each record."""
        ...

    @property
    def policy(self) -> Policy:
        """Thresholds for its fits."""
        ...

    @property
    def expanded(self) -> bool:
        """Whether the model is expanded about one fit, a disadvantage for others."""
        ...

    @property
    def stiffness_sd(self) -> FloatArray:
        """Prior sd of the joint's log stiffness in each hit, shape (n_hits,).

        Empty for a bench without hits or without a joint that settles.
        """
        ...

    def at_stiffness(self, settling: FloatArray) -> "Bench":
        """Return the bench at a given stiffness of each hit, scatter not whitened.

        Args:
            settling: log of the joint's stiffness in each hit over that of the base,
                shape (n_hits,).
        """
        ...

    def phases(self, candidate: Candidate) -> int:
        """Return the number of free phases that an effect fits; 0 for most effects."""
        ...

    def hints(self, fit: Fit, candidate: Candidate) -> list[FloatArray]:
        """Return starts derived from a fit's residual, in addition to the grid."""
        ...

    def refine(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        *,
        without: Sequence[int] = (),
    ) -> "Bench":
        """Return the bench with its noise estimated at a solution.

        Args:
            base: of the solution, shape (n_base,).
            terms: of the solution.
            without: groups of rows that are held out of the estimate.
        """
        ...

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return model minus measurement over sigma, shape (n_rows,).

        Args:
            base: log(parameter / nominal), shape (n_base,).
            terms: effects.
            resolution: window and step.
        """
        ...


@runtime_checkable
class SlopedBench(Protocol):
    """A bench that computes slopes by its base in closed form, and limits its base."""

    @property
    def base_limits(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper bounds of the base coordinates, shape (n_base,) each."""
        ...

    def slopes(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> SlopeArray:
        """Return d residual / d base, shape (n_rows, n_base).

        A bench may add columns by the coordinates of the effects, all of them; NaN in
        those that it does not know.
        """
        ...


@runtime_checkable
class WhitensTogether(Protocol):
    """A bench that whitens several residuals in less time than one after the other."""

    def residuals(
        self,
        base: FloatArray,
        every: Sequence[Sequence[Term]],
        resolution: Resolution,
    ) -> FloatArray:
        """Return the residual with each of several sets of effects, (n_sets, n_rows).

        Args:
            base: coordinates, shape (n_base,).
            every: sets of effects.
            resolution: window and step.
        """
        ...


class NoisyBench(Bench, Protocol):
    """A bench that states the expected noise of its residual."""

    @property
    def noise(self) -> Noise:
        """Expected noise of the residual."""
        ...


class MeasuredBench(NoisyBench, Protocol):
    """A bench with the records that it compares, for views and for model error."""

    @property
    def campaign(self) -> Campaign:
        """Forces, responses, levels and points."""
        ...

    @property
    def entries(self) -> tuple[LumpedEffect, ...]:
        """The catalogue of this run."""
        ...

    def difference(
        self, base: FloatArray, terms: Sequence[Term], oversampling: int
    ) -> FloatArray:
        """Return model minus measurement, shape of the response."""
        ...

    def mask(self, values: FloatArray) -> None:
        """Set samples without weight to 0, in place."""
        ...


def values_of(bench: Scaled, term: Term) -> FloatArray:
    """Return the values [SI] of a term's parameters, shape (n_parameters,)."""
    parameters = term.candidate.effect.parameters
    return np.array(
        [
            p.decode(float(u)) * bench.scale(p.scale)
            for p, u in zip(parameters, term.coordinates, strict=True)
        ]
    )
