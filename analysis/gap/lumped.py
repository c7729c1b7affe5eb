# SPDX-License-Identifier: MIT
"""The bench of lumped dynamics: a campaign and its model, as the engine sees them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.fft

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.gap.assembly import Action
from jointbench.analysis.gap.bench import Blocks, Stage, values_of
from jointbench.analysis.gap.campaign import TAIL, Campaign
from jointbench.analysis.gap.catalogue import site_index
from jointbench.analysis.gap.effects import Candidate, Term
from jointbench.analysis.gap.effort import spend
from jointbench.analysis.gap.fit import Fit
from jointbench.analysis.gap.forward import Excitation, prepare_excitation, respond
from jointbench.analysis.gap.lumped_noise import Settled, refine_noise, settle
from jointbench.analysis.gap.noise import Noise
from jointbench.analysis.gap.physics import Conditions, LumpedEffect
from jointbench.analysis.gap.probes import PROBES
from jointbench.analysis.gap.records import View
from jointbench.analysis.gap.views import residual_peaks, slice_views

PEAKED = ("hum", "hidden_mode")
"""Effects whose second parameter is a frequency at which the residual peaks."""
LEAST_RISE = -0.999
"""Smallest share that laws may add to a stiffness: less would be none at all."""
WINDOW_REACH = 3.5
"""Decay times after which a windowed record is cut."""


@dataclass(frozen=True, slots=True, eq=False)
class LumpedBench:
    """Residuals of a lumped model, whitened by what the noise is known to be.

    Attributes:
        campaign: the measurement.
        entries: the catalogue of this run.
        candidates: it, at every site.
        probes: shapes that are tested of a fit beside it, at every site.
        excitation: forces made ready.
        gate: first and last sample of the force that count.
        noise: what is to be expected of a residual.
        basis: directions of force noise and scatter, (n_records, n_kept, n_rows).
        shrink: how much of each is taken out, (n_records, n_kept, 1).
        scales: words to values.
        blocks: records as groups.
        short: the same bench with fewer samples, by length.
        settled: where the model is expanded about the settling of each hit, or None.
    """

    campaign: Campaign
    entries: tuple[LumpedEffect, ...]
    candidates: tuple[Candidate, ...]
    probes: tuple[Candidate, ...]
    excitation: Excitation
    gate: tuple[int, int]
    noise: Noise
    basis: FloatArray
    shrink: FloatArray
    scales: dict[str, float]
    blocks: Blocks
    short: dict[int, "LumpedBench"]
    settled: "Settled | None"

    @property
    def base_names(self) -> tuple[str, ...]:
        """Names of the base parameters."""
        return self.campaign.model.base_names

    @property
    def base_sd(self) -> FloatArray:
        """Prior sd of log(parameter / nominal), shape (n_base,)."""
        return self.campaign.model.spread

    @property
    def expanded(self) -> bool:
        """Whether the model is expanded about the settling of each hit."""
        return self.settled is not None

    def scale(self, word: str) -> float:
        """Return the scale of a word [SI]; ``a/b^2`` is understood."""
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
        entries = {e.effect.name: e for e in (*self.entries, *PROBES)}
        return [
            Action(
                entries[t.candidate.effect.name],
                t.candidate.site.kind,
                site_index(self.campaign.model, t.candidate.site),
                values_of(self, t),
            )
            for t in terms
        ]

    def response(
        self, base: FloatArray, terms: Sequence[Term], oversampling: int = 8
    ) -> FloatArray:
        """Predict the channels, shape (n_records, n_channels, n_samples)."""
        actions = self.actions(terms)
        marched = any(a.entry.law is not None for a in actions)
        spend(self.campaign.response.size, oversampling if marched else 0)
        return respond(
            self.campaign.model,
            self.theta(base),
            self.excitation,
            actions,
            oversampling=oversampling,
            measured=self.campaign.response,
        )

    def residual(
        self, base: FloatArray, terms: Sequence[Term], stage: Stage
    ) -> FloatArray:
        """Return model minus measurement, whitened, shape (n_rows,)."""
        if stage.window is not None and not self.campaign.continuous:
            return self._windowed(base, terms, stage)
        r = self.misfit(base, terms, stage.oversampling)
        return self.residual_of(r)

    def misfit(
        self, base: FloatArray, terms: Sequence[Term], oversampling: int
    ) -> FloatArray:
        """Return model minus measurement, shape of the response.

        The settling of each hit counts as scatter: its share is left in the misfit.
        The response is taken at the stiffness of each hit, so that a law which does
        nothing but change it from hit to hit enters by the slope alone.
        """
        if self.settled is None:
            r = self.response(base, terms, oversampling)
            r -= self.campaign.response
            return r
        mean = self.mean_stiffness(base, self.settled)
        moved = base.copy()
        moved[self.joint_at] = mean
        others = [
            t
            for t, a in zip(terms, self.actions(terms), strict=True)
            if not self._rises(a)
        ]
        hits = self.hit_stiffness(self.settled)
        r = settle(self, hits).response(moved, others, oversampling)
        r -= self.campaign.response
        share = base[self.joint_at] - mean + np.log1p(self.rise(terms)) - hits
        r += share[:, None, None] * self.settled.slope
        return r

    def hit_stiffness(self, settled: Settled) -> FloatArray:
        """Return the log of each hit's stiffness over the mean, shape (n_records,)."""
        settling = self.excitation.conditions.settling
        left = 1.0 if settling is None else np.exp(settling)
        return np.asarray(np.log(left + settled.rise))

    def rise(self, terms: Sequence[Term]) -> FloatArray:
        """Return what terms add to the joint's stiffness in each record [-].

        Shape (n_records,); as a share of the stiffness without them, above -1.
        """
        total = np.zeros(len(self.campaign.hit))
        for action in self.actions(terms):
            if self._rises(action) and action.entry.rise is not None:
                conditions = self.excitation.conditions
                total += action.entry.rise(conditions, action.values)
        return np.maximum(total, LEAST_RISE)

    def _rises(self, action: Action) -> bool:
        """Tell whether an action is a mere change of the first joint's stiffness."""
        joint = self.joint_at - len(self.campaign.model.bodies)
        return action.entry.rise is not None and action.index == joint

    def mean_stiffness(self, base: FloatArray, settled: Settled) -> float:
        """Return the log of the joint's stiffness that the settling was added to.

        It goes with the scale of all other masses and stiffnesses: one scale for all
        changes no frequency, and so must not bend either. Their median is that scale;
        a mean would move when a single mass hands its share to an added one.
        """
        model = self.campaign.model
        count = len(model.bodies) + len(model.links)
        others = np.arange(count) != self.joint_at
        scale = np.median((base - settled.anchor)[:count][others])
        return float(settled.anchor[self.joint_at] + scale)

    @property
    def joint_at(self) -> int:
        """Place of the first joint's stiffness among the base coordinates."""
        links = self.campaign.model.links
        first = next((i for i, link in enumerate(links) if link.joint), 0)
        return len(self.campaign.model.bodies) + first

    def residual_of(self, misfit: FloatArray) -> FloatArray:
        """Whiten model minus measurement, shape (n_records, n_channels, n_samples)."""
        r = misfit / self.noise.sigma[:, :, None]
        self.mask(r)
        rows = r.reshape(r.shape[0], -1, 1)
        rows -= self.basis.transpose(0, 2, 1) @ (self.shrink * (self.basis @ rows))
        return rows.ravel()

    def mask(self, rows: FloatArray) -> None:
        """Set to 0, in place, the samples that carry no weight."""
        rows[..., -TAIL:] = 0.0
        rows[..., : self.campaign.lead] = 0.0

    def _windowed(
        self, base: FloatArray, terms: Sequence[Term], stage: Stage
    ) -> FloatArray:
        """Return the residual under an exponential window, cut where it has decayed."""
        decay = stage.window or 1.0
        reach = self.gate[1] + int(WINDOW_REACH * decay * self.campaign.sample_rate)
        short = self.shortened(scipy.fft.next_fast_len(reach, real=True))
        r = short.response(base, terms, stage.oversampling)
        r -= short.campaign.response
        r /= self.noise.sigma[:, :, None]
        r *= _window(short, decay)
        return r.ravel()

    def shortened(self, length: int) -> "LumpedBench":
        """Return the bench of the first `length` samples, made once and kept."""
        if length >= self.campaign.force.shape[1]:
            return self
        if length not in self.short:
            campaign = replace(
                self.campaign,
                force=self.campaign.force[:, :length],
                response=self.campaign.response[:, :, :length],
            )
            self.short[length] = replace(
                self,
                campaign=campaign,
                excitation=gated_excitation(
                    campaign, self.gate, self.excitation.conditions.settling
                ),
                short={},
            )
        return self.short[length]

    def refine(
        self, base: FloatArray, terms: Sequence[Term], *, astray: bool = False
    ) -> "LumpedBench":
        """Return the bench with its noise estimated at a solution."""
        return refine_noise(self, base, terms, astray=astray)

    def views(self, fit: Fit) -> tuple[View, ...]:
        """Return where the misfit of a fit sits."""
        records, channels, samples = self.campaign.response.shape
        residual = fit.residual.reshape(records, channels, samples)
        return slice_views(
            residual[:, :, self.campaign.lead : -TAIL],
            self.blocks,
            [c.name for c in self.campaign.model.channels],
            self.campaign.sample_rate,
        )

    def hints(self, fit: Fit, candidate: Candidate) -> list[FloatArray]:
        """Return starts at the peaks of a fit's residual: lines of a hum, modes."""
        name = candidate.effect.name
        if name not in PEAKED:
            return []
        records, channels, samples = self.campaign.response.shape
        residual = fit.residual.reshape(records, channels, samples)
        rows = [c.name for c in self.campaign.model.channels]
        if candidate.site.kind == "channel" and candidate.site.name in rows:
            at = rows.index(candidate.site.name)
            residual = residual[:, at : at + 1]
        peaks = residual_peaks(residual, self.campaign.sample_rate)
        parameters = candidate.effect.parameters
        scale = self.scale(parameters[1].scale)
        rest = [p.encode(p.starts[0]) for p in parameters[2:]]
        low, high = parameters[1].lower, parameters[1].upper
        return [
            np.array([0.0, parameters[1].encode(f / scale), *rest])
            for f in peaks
            if low < f / scale < high
        ]

    def phases(self, candidate: Candidate) -> int:
        """Return how many phases an effect finds for itself (hum), else 0."""
        if candidate.effect.name != "hum":
            return 0
        records, channels = self.noise.sigma.shape
        return int(records) * (int(channels) if candidate.site.name == "all" else 1)


def _window(bench: LumpedBench, decay: float) -> FloatArray:
    n = bench.excitation.growth.size
    time = (np.arange(n) - bench.gate[0]) / bench.campaign.sample_rate
    return np.asarray(np.exp(-np.maximum(time, 0.0) / decay))


def gated_excitation(
    campaign: Campaign, gate: tuple[int, int], settling: FloatArray | None = None
) -> Excitation:
    """Cut the hits out of the forces and transform them."""
    force = np.zeros_like(campaign.force)
    force[:, gate[0] : gate[1]] = campaign.force[:, gate[0] : gate[1]]
    span = max(float(np.ptp(campaign.order)), 1.0)
    conditions = Conditions(
        campaign.preload / campaign.preload_reference,
        (campaign.order - campaign.order.min()) / span,
        settling,
    )
    return prepare_excitation(force, campaign.hit, campaign.sample_rate, conditions)
