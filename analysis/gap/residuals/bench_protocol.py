# SPDX-License-Identifier: MIT
"""What the engine asks of a bench: residuals of a base model plus effects."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.model.policy import Policy
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Blocks, Fit


class Scaled(Protocol):
    """What turns the words of a catalogue's scales into sizes of one measurement."""

    def scale(self, word: str) -> float:
        """Return the bench's scale of that word [SI]."""
        ...


class Bench(Scaled, Protocol):
    """A measurement with its model: everything the engine knows of either."""

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
        """Shapes that are tested of a fit beside the catalogue, but never named."""
        ...

    @property
    def blocks(self) -> Blocks:
        """The groups that are held out one at a time."""
        ...

    @property
    def policy(self) -> Policy:
        """Thresholds that its fits are judged by."""
        ...

    @property
    def expanded(self) -> bool:
        """Whether the model is expanded about a fit, so that others fit less well."""
        ...

    def phases(self, candidate: Candidate) -> int:
        """Return how many free phases an effect fits by itself; 0 for most."""
        ...

    def hints(self, fit: Fit, candidate: Candidate) -> list[FloatArray]:
        """Return starts that a fit's own residual suggests, besides the grid's."""
        ...

    def refine(
        self, base: FloatArray, terms: Sequence[Term], *, diverged: bool = False
    ) -> "Bench":
        """Return the bench with its noise estimated at a solution.

        Args:
            base: of the solution, shape (n_base,).
            terms: of the solution.
            diverged: take the scatter of the hits for what it seems even where the
                solution is far off, because it may be far off on its account.
        """
        ...

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return model minus measurement over sigma, shape (n_rows,).

        Args:
            base: log(parameter / nominal), shape (n_base,).
            terms: the effects switched on.
            resolution: window and step.
        """
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
