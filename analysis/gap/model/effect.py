# SPDX-License-Identifier: MIT
"""Effects: name, site, parameters and rivals.

An effect is data plus pure functions; the functions that implement its physics belong
to a bench (see `effect_hooks`), so the engine does not depend on them.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.model.effect_parameter import Parameter, Reported

EFFECTS_GROUP = "jointbench.effects"
"""Entry points by which other packages add effects."""
PROBE_FAMILY = "probe"
"""Family of shapes that are tested but never named."""


@dataclass(frozen=True, slots=True)
class Site:
    """Where an effect acts: ``link:joint``, ``body:m2``, ``channel:a1``."""

    kind: str
    name: str

    def __str__(self) -> str:
        """Return the site word."""
        return f"{self.kind}:{self.name}"


@dataclass(frozen=True, slots=True)
class Family:
    """What the effects of a family have in common.

    Attributes:
        model_error: share of the base's excess chi2 that a correct law may leave [-].
        integrated: True if effects of links are integrated in time, so that slopes are
            differenced at a coarser step.
    """

    model_error: float
    integrated: bool = False


FAMILIES: Mapping[str, Family] = {
    "friction": Family(1e-6, integrated=True),
    "stiffness": Family(1e-7, integrated=True),
    # A stop closes between two steps; a smooth law is as accurate as its integration.
    "contact": Family(1e-6, integrated=True),
    # Linear damping has the share of its family.
    "damping": Family(1e-6, integrated=True),
    # Scatter moves samples across the limit of a clipped channel: no slope shows it.
    "converter": Family(5e-6),
}
EXACT = 1e-9
"""Model error of all other effects: linear or at a channel, they are as exact as the
base, and a larger share would hide a second effect next to a large first one."""


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
        separates: name of a rival to the experiment that distinguishes the two.
        report: converts fitted values to reported parameters; None if they agree.
        by_prior: True if the base can absorb the effect entirely, so that only the
            priors of the base reveal it (an added mass, a gain).
        refit_nominal: True if a fit must also start from the nominal base.
        has_sliders: True for friction laws made of sliders that stick and slip.
        starts_at_peaks: True if the second parameter is a frequency at which the
            residual without the effect has a peak: fits also start at those peaks.
        own_phases: True if the effect fits a phase in each record and channel; each
            phase is charged in the comparison with other effects.
        follows_order: True if the effect depends on the order of the hits, which a
            campaign may confound with their level.
        model_error: share of the base's excess chi2 that a correct law may leave [-];
            None for the share of its family.
        generalises: names of effects that are special cases of this one, or that it
            imitates within noise: a fit in which one of them explains as much is
            preferred, and is no rival.
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
    generalises: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check the model error and the frequency of an effect that starts at peaks."""
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

    @property
    def error_share(self) -> float:
        """Share of the base's excess chi2 that a correct law may leave [-]."""
        if self.model_error is not None:
            return self.model_error
        family = FAMILIES.get(self.family)
        return EXACT if family is None else family.model_error

    @property
    def integrated(self) -> bool:
        """Whether effects of its family are integrated in time at a link."""
        return self.family in FAMILIES and FAMILIES[self.family].integrated

    def reported(self, values: FloatArray) -> tuple[Reported, ...]:
        """Return the reported parameters of fitted `values`, shape (n_parameters,)."""
        if self.report is not None:
            return self.report(values)
        return tuple(
            Reported(p.name, p.unit, float(v))
            for p, v in zip(self.parameters, values, strict=True)
        )


@dataclass(frozen=True, slots=True)
class Candidate:
    """An effect at a site, which the engine fits and ranks."""

    effect: Effect
    site: Site

    @property
    def label(self) -> str:
        """Name and site in one word, for progress lines and tables."""
        return f"{self.effect.name}@{self.site}"


def may_join(candidate: Candidate, fitted: Sequence[Candidate]) -> bool:
    """Return whether a candidate may be fitted together with others.

    The same candidate is not fitted twice. Two slider laws across one link are mostly
    one law with more sliders, which few measurements can separate.

    Args:
        candidate: to be added.
        fitted: candidates already in the fit.
    """
    if candidate in fitted:
        return False
    return not (
        candidate.effect.has_sliders
        and any(c.effect.has_sliders and c.site == candidate.site for c in fitted)
    )


def labels_of(candidates: Iterable[Candidate]) -> frozenset[str]:
    """Return the labels of a set of candidates, which identify the set."""
    return frozenset(c.label for c in candidates)


def words_of(candidates: Iterable[Candidate]) -> str:
    """Return a set of candidates as text, sorted by label."""
    return " + ".join(sorted(labels_of(candidates)))


@dataclass(frozen=True, slots=True, eq=False)
class Term:
    """A candidate in a fit: its coordinates, shape (n_parameters,)."""

    candidate: Candidate
    coordinates: FloatArray
