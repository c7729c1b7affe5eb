# SPDX-License-Identifier: MIT
"""Whitened residuals of a lumped model on a campaign."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TypeVar

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.catalogue.catalogue import site_index
from jointbench.analysis.gap.catalogue.probes import PROBES
from jointbench.analysis.gap.model.campaign import TAIL, Campaign
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.bench_protocol import values_of
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import (
    Blocks,
    HitGains,
    Settled,
)
from jointbench.analysis.gap.residuals.joint_settling import (
    changes_joint,
    hit_stiffness,
    joint_at,
    mean_stiffness,
    stiffness_rise,
)
from jointbench.analysis.gap.residuals.noise_models import Noise
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.effect_hooks import HitConditions, LumpedEffect
from jointbench.analysis.gap.response.excitation import Excitation, prepare_excitation
from jointbench.analysis.gap.response.predict_records import (
    respond,
    respond_tapered,
    shaped,
)
from jointbench.analysis.gap.response.search_effort import spend


@dataclass(frozen=True, slots=True, eq=False)
class LumpedResidual:
    """Residuals of a lumped model, whitened by the estimated noise.

    Attributes:
        campaign: the measurement.
        entries: the catalogue of this run.
        excitation: prepared forces.
        time_gate: first sample of the force that counts, and the end.
        noise: expected noise and scatter of the residual.
        basis: directions of force noise and scatter, (n_records, n_kept, n_rows).
        shrink: share of each that is removed, (n_records, n_kept, 1).
        scales: words to values.
        blocks: records as groups.
        short: the same bench with fewer samples, by length.
        settled: expansion of the model about the settling of each hit, or None.
        policy: thresholds for fits of the bench.
        mixing: replaces `shrink` where hits are correlated: the matrix of the
            components of all records that is removed, (n_records * n_kept) square.
        gains: expansion about the gains of hits ahead of a converter that clips, or
            None.
    """

    campaign: Campaign
    entries: tuple[LumpedEffect, ...]
    excitation: Excitation
    time_gate: tuple[int, int]
    noise: Noise
    basis: FloatArray
    shrink: FloatArray
    scales: dict[str, float]
    blocks: Blocks
    short: dict[int, "LumpedResidual"]
    settled: Settled | None
    policy: Policy = field(default=STANDARD, kw_only=True)
    mixing: FloatArray | None = field(default=None, kw_only=True)
    gains: HitGains | None = field(default=None, kw_only=True)

    @property
    def expanded(self) -> bool:
        """Whether the model is expanded about the settling of each hit."""
        return self.settled is not None

    def scale(self, word: str) -> float:
        """Return the scale of a word [SI], also of the form ``a/b^2``."""
        if word not in self.scales:
            top, _, bottom = word.partition("/")
            base, _, power = bottom.partition("^")
            below = self.scales[base] ** int(power or 1)
            self.scales[word] = self.scales[top if top != "1" else "one"] / below
        return self.scales[word]

    def theta(self, base: FloatArray) -> FloatArray:
        """Return base parameters [SI] of log(parameter / nominal)."""
        return np.asarray(self.campaign.model.nominal * np.exp(base))

    def actions(self, terms: Sequence[Term]) -> list[Action]:
        """Return terms with the hooks of their entries."""
        return [
            Action(
                self.entry_of(t),
                t.candidate.site.kind,
                site_index(self.campaign.model, t.candidate.site),
                values_of(self, t),
            )
            for t in terms
        ]

    def entry_of(self, term: Term) -> LumpedEffect:
        """Return the entry of a term's effect, with its hooks.

        A fit asks thousands of times for one or two: they are looked for, without a
        table of all of them each time.

        Raises:
            KeyError: no entry has that name.
        """
        name = term.candidate.effect.name
        for entries in (PROBES, self.entries):
            for entry in entries:
                if entry.effect.name == name:
                    return entry
        raise KeyError(name)

    def response(
        self, base: FloatArray, terms: Sequence[Term], oversampling: int = 8
    ) -> FloatArray:
        """Predict the channels, shape (n_records, n_channels, n_samples)."""
        return self.acted(base, self.actions(terms), oversampling)

    def acted(
        self, base: FloatArray, actions: Sequence[Action], oversampling: int
    ) -> FloatArray:
        """Predict the channels under actions, at the gains of each hit."""
        if self.gains is None:
            return self._respond(base, actions, oversampling)
        ahead = self._ahead(base, actions, oversampling)
        return self._through(ahead, actions, self.gains.factor)

    def _respond(
        self, base: FloatArray, actions: Sequence[Action], oversampling: int
    ) -> FloatArray:
        integrated = any(a.entry.law is not None for a in actions)
        spend(self.campaign.response.size, oversampling if integrated else 0)
        return respond(
            self.campaign.model,
            self.theta(base),
            self.excitation,
            actions,
            oversampling=oversampling,
            measured=self.campaign.response,
        )

    def _ahead(
        self, base: FloatArray, actions: Sequence[Action], oversampling: int
    ) -> FloatArray:
        """Return the response ahead of the converter, without gains."""
        below = [a for a in actions if a.entry.shape is None]
        return self._respond(base, below, oversampling)

    def _through(
        self, ahead: FloatArray, actions: Sequence[Action], gains: FloatArray
    ) -> FloatArray:
        """Return what a converter shows of a response at some gains of each hit."""
        rate = self.excitation.sample_rate
        seen = ahead * gains[:, :, None]
        return shaped(seen, self.campaign.response, actions, rate)

    def expected(
        self, base: FloatArray, terms: Sequence[Term], oversampling: int
    ) -> FloatArray:
        """Return the response whose gains count as scatter, shape of the response.

        Beside the response, gains keep what the samples determine.
        """
        if self.gains is None:
            return self.response(base, terms, oversampling)
        actions = self.actions(terms)
        ahead = self._ahead(base, actions, oversampling)
        factor = self.gains.beside(ahead)
        seen = self._through(ahead, actions, factor)
        seen -= (factor[:, :, None] - 1.0) * self.gains.slope
        return seen

    def tapered(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        tapers: Sequence[FloatArray],
        oversampling: int,
    ) -> list[FloatArray]:
        """Predict the channels with each taper of the nonlinear part."""
        spend(self.campaign.response.size, oversampling)
        return respond_tapered(
            self.campaign.model,
            self.theta(base),
            self.excitation,
            self.actions(terms),
            tapers,
            oversampling=oversampling,
            measured=self.campaign.response,
        )

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return model minus measurement, whitened, shape (n_rows,)."""
        if resolution.window is not None and not self.campaign.continuous:
            return _windowed(self, base, terms, resolution)
        r = self.difference(base, terms, resolution.oversampling)
        return self.residual_of(r)

    def difference(
        self, base: FloatArray, terms: Sequence[Term], oversampling: int
    ) -> FloatArray:
        """Return model minus measurement, shape of the response.

        The settling of each hit counts as scatter: its share remains in the difference.
        The response is computed at the stiffness of each hit, so a law that only
        changes this stiffness enters by the slope.
        """
        if self.settled is None:
            r = self.expected(base, terms, oversampling)
            r -= self.campaign.response
            return r
        model = self.campaign.model
        at, mean = joint_at(model), mean_stiffness(model, base, self.settled)
        moved = base.copy()
        moved[at] = mean
        others = [
            t
            for t, a in zip(terms, self.actions(terms), strict=True)
            if not changes_joint(model, a)
        ]
        hits = hit_stiffness(self.excitation.conditions, self.settled)
        r = settle(self, hits).expected(moved, others, oversampling)
        r -= self.campaign.response
        share = base[at] - mean + np.log1p(self.rise(terms)) - hits
        r += share[:, None, None] * self.settled.slope
        return r

    def rise(self, terms: Sequence[Term]) -> FloatArray:
        """Return the relative change of the joint's stiffness by the terms [-].

        Shape (n_records,), relative to the stiffness without them, above -1.
        """
        return stiffness_rise(
            self.campaign.model, self.excitation.conditions, self.actions(terms)
        )

    def residual_of(self, difference: FloatArray) -> FloatArray:
        """Whiten model minus measurement, shape (n_records, n_channels, n_samples)."""
        r = difference / self.noise.sigma[:, :, None]
        self.mask(r)
        if self.mixing is not None:
            columns = r.reshape(r.shape[0], -1, 1)
            along = self.basis @ columns
            along = (self.mixing @ along.ravel()).reshape(along.shape)
            columns -= self.basis.transpose(0, 2, 1) @ along
            return columns.ravel()
        rows = r.reshape(r.shape[0], -1)
        # Record by record: the basis of one stays in the processor's cache.
        for row, basis, shrink in zip(
            rows, self.basis, self.shrink[..., 0], strict=True
        ):
            row -= (shrink * (basis @ row)) @ basis
        return rows.ravel()

    def mask(self, rows: FloatArray) -> None:
        """Set the samples without weight to 0, in place."""
        rows[..., -TAIL:] = 0.0
        rows[..., : self.campaign.lead] = 0.0


SomeBench = TypeVar("SomeBench", bound=LumpedResidual)


def settle(bench: SomeBench, settling: FloatArray | None) -> SomeBench:
    """Return the bench with its model at a given settling of the joint.

    Args:
        bench: to be changed.
        settling: log of the joint's stiffness in each hit over its mean, shape
            (n_records,); None for no settling.
    """
    conditions = replace(bench.excitation.conditions, settling=settling)
    excitation = replace(bench.excitation, conditions=conditions)
    return replace(bench, excitation=excitation, settled=None, short={})


def _windowed(
    bench: LumpedResidual,
    base: FloatArray,
    terms: Sequence[Term],
    resolution: Resolution,
) -> FloatArray:
    """Return the residual under an exponential window, cut where it has decayed."""
    decay = resolution.window or 1.0
    reach = bench.time_gate[1] + int(
        RESIDUALS.window_reach * decay * bench.campaign.sample_rate
    )
    short = _shortened(bench, scipy.fft.next_fast_len(reach, real=True))
    r = short.expected(base, terms, resolution.oversampling)
    r -= short.campaign.response
    r /= bench.noise.sigma[:, :, None]
    r *= _window(short.excitation, short.time_gate[0], decay)
    return r.ravel()


def _shortened(bench: LumpedResidual, length: int) -> LumpedResidual:
    """Return the bench of the first `length` samples, cached."""
    if length >= bench.campaign.force.shape[1]:
        return bench
    if length not in bench.short:
        campaign = replace(
            bench.campaign,
            force=bench.campaign.force[:, :length],
            response=bench.campaign.response[:, :, :length],
        )
        bench.short[length] = replace(
            bench,
            campaign=campaign,
            excitation=gated_excitation(
                campaign, bench.time_gate, bench.excitation.conditions.settling
            ),
            gains=None if bench.gains is None else bench.gains.cut(length),
            short={},
        )
    return bench.short[length]


@lru_cache(maxsize=8)
def _window(excitation: Excitation, first: int, decay: float) -> FloatArray:
    """Return exp(-t / decay) from the first sample on, 1 before it, read-only."""
    time = (np.arange(excitation.growth.size) - first) / excitation.sample_rate
    values = np.asarray(np.exp(-np.maximum(time, 0.0) / decay))
    values.flags.writeable = False
    return values


def gated_excitation(
    campaign: Campaign, time_gate: tuple[int, int], settling: FloatArray | None = None
) -> Excitation:
    """Transform the forces within the time gate."""
    force = np.zeros_like(campaign.force)
    force[:, time_gate[0] : time_gate[1]] = campaign.force[
        :, time_gate[0] : time_gate[1]
    ]
    span = max(float(np.ptp(campaign.order)), 1.0)
    conditions = HitConditions(
        campaign.preload / campaign.preload_reference,
        (campaign.order - campaign.order.min()) / span,
        settling,
    )
    return prepare_excitation(force, campaign.hit, campaign.sample_rate, conditions)
