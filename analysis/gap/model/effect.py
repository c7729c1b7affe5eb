# SPDX-License-Identifier: MIT
"""What an effect is to the engine: a name, a site, parameters and its rivals.

An effect is data plus pure functions; the functions that carry its physics belong to
a bench (see `effect_hooks`), so the engine never sees any.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.model.effect_parameter import Parameter, Reported

EFFECTS_GROUP = "jointbench.effects"
"""Entry points by which other packages add effects."""
PROBE_FAMILY = "probe"
"""Family of what is tested of a fit but never named."""


@dataclass(frozen=True, slots=True)
class Site:
    """Where an effect sits: ``link:joint``, ``body:m2``, ``channel:a1``."""

    kind: str
    name: str

    def __str__(self) -> str:
        """Return the site word."""
        return f"{self.kind}:{self.name}"


_Report = Callable[[FloatArray], tuple[Reported, ...]]


@dataclass(frozen=True, slots=True)
class Effect:
    """One entry of a catalogue.

    Attributes:
        name: snake case, for example ``"cubic_stiffness"``.
        family: stiffness, friction, contact, mass, damping, mode, sensor,
            converter or preload.
        parameters: amplitude first, then shape.
        source: paper and equation.
        separates: rival name to the experiment that tells the two apart.
        report: from fitted values to what the user reads; None where they agree.
        by_prior: True where the base can take the effect in whole, so that only the
            priors of the base see it (an added mass, a gain).
        refit_nominal: True where the fit must start from the nominal base as well.
        has_sliders: True for friction laws made of sliders that stick and slip.
        starts_at_peaks: True where the second parameter is a frequency at which a
            residual without the effect peaks: fits start at those peaks as well.
        own_phases: True where the effect finds a phase for itself in each record and
            channel; each is a free number that its comparison with others pays for.
        follows_order: True where the effect goes with the order of the hits, which a
            campaign may confuse with their level.
        model_error: share of the base's excess chi2 that a right law may leave [-];
            None for that of the family.
    """

    name: str
    family: str
    parameters: tuple[Parameter, ...]
    source: str
    separates: Mapping[str, str] = field(default_factory=dict)
    report: _Report | None = None
    by_prior: bool = False
    refit_nominal: bool = False
    has_sliders: bool = False
    starts_at_peaks: bool = False
    own_phases: bool = False
    follows_order: bool = False
    model_error: float | None = None

    def __post_init__(self) -> None:
        """Check that what starts at peaks has a frequency, and that shares are some."""
        if self.model_error is not None and not 0.0 <= self.model_error < 1.0:
            raise UsageError(
                f"effect {self.name!r} has a model_error of {self.model_error:g}; it "
                "is a share: give 0 or more and less than 1, or leave it out"
            )
        if self.starts_at_peaks and len(self.parameters) < 2:
            raise UsageError(
                f"effect {self.name!r} starts at peaks but has "
                f"{len(self.parameters)} parameter; the second one must be its "
                "frequency: add it, or leave out starts_at_peaks"
            )

    def reported(self, values: FloatArray) -> tuple[Reported, ...]:
        """Return what the user reads of fitted `values`, shape (n_parameters,)."""
        if self.report is not None:
            return self.report(values)
        return tuple(
            Reported(p.name, p.unit, float(v))
            for p, v in zip(self.parameters, values, strict=True)
        )


@dataclass(frozen=True, slots=True)
class Candidate:
    """An effect at a site: what the engine tries, ranks and names."""

    effect: Effect
    site: Site

    @property
    def label(self) -> str:
        """Name and site in one word, for progress lines and tables."""
        return f"{self.effect.name}@{self.site}"


def may_join(candidate: Candidate, fitted: Sequence[Candidate]) -> bool:
    """Tell whether a candidate is worth a race beside what is fitted.

    Not twice the same; and two laws of sliders across one link are mostly one law of
    more sliders, which few measurements split.

    Args:
        candidate: what would be added.
        fitted: what is there.
    """
    if candidate in fitted:
        return False
    return not (
        candidate.effect.has_sliders
        and any(c.effect.has_sliders and c.site == candidate.site for c in fitted)
    )


def labels_of(candidates: Iterable[Candidate]) -> frozenset[str]:
    """Return the labels of a set of candidates, which tell it from all others."""
    return frozenset(c.label for c in candidates)


def words_of(candidates: Iterable[Candidate]) -> str:
    """Return a set of candidates in words, in an order of their own."""
    return " + ".join(sorted(labels_of(candidates)))


@dataclass(frozen=True, slots=True, eq=False)
class Term:
    """A candidate switched on: its fitted coordinates, shape (n_parameters,)."""

    candidate: Candidate
    coordinates: FloatArray
