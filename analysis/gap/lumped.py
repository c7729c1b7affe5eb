# SPDX-License-Identifier: MIT
"""The bench of lumped dynamics: a campaign and its model, as the engine sees them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.fft

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.gap.assembly import Action
from jointbench.analysis.gap.bench import Blocks, Stage, values_of
from jointbench.analysis.gap.campaign import Campaign
from jointbench.analysis.gap.catalogue import site_index
from jointbench.analysis.gap.effects import Candidate, Term
from jointbench.analysis.gap.fit import Fit
from jointbench.analysis.gap.forward import Excitation, prepare_excitation, respond
from jointbench.analysis.gap.noise import (
    FORCE_SHAPES,
    Noise,
    channel_sigma,
    gain_scatter,
    regress,
    repeat_groups,
    whitening_basis,
    without_trend,
)
from jointbench.analysis.gap.physics import Conditions, LumpedEffect
from jointbench.analysis.gap.records import View
from jointbench.analysis.gap.views import residual_peaks, slice_views

PEAKED = ("hum", "hidden_mode")
"""Effects whose second parameter is a frequency at which the residual peaks."""
SETTLING_SEEN = 1e-5
LOST = 0.3
"""Misfit over response above which a fit says nothing about the settling."""
SETTLING_REACH = 3.0
"""Scatter sd beyond which a settling is no scatter but a missing effect."""
SCATTER_STEP = 1e-6
"""Difference step of the ways to scatter: at 1e-4 the late record has already bent a
hundredth away from its slope, and a trend hides in that hundredth."""
TAIL = 64
"""Last samples without weight: a channel's filter acts on a cut record there."""
WINDOW_REACH = 5.0
"""Decay times after which a windowed record is cut."""


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """An expansion of the model about the joint's stiffness as it was in each hit.

    The data know that stiffness far better than its mean, so the mean must move
    without it: the response is taken at the stiffness of each hit, and mean and
    scatter about it enter by the slope. A record of a hundred radians bends within
    the scatter; what does not bend cannot leave the base stuck.

    Attributes:
        anchor: log(stiffness / nominal) to which the settling was added.
        slope: change of the response with it, shape of the response.
    """

    anchor: float
    slope: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class LumpedBench:
    """Residuals of a lumped model, whitened by what the noise is known to be.

    Attributes:
        campaign: the measurement.
        entries: the catalogue of this run.
        candidates: it, at every site.
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

    def scale(self, word: str) -> float:
        """Return the scale of a word [SI]; ``a/b^2`` and products are understood."""
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
        entries = {entry.effect.name: entry for entry in self.entries}
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
        return respond(
            self.campaign.model,
            self.theta(base),
            self.excitation,
            self.actions(terms),
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
        """
        settling = self.excitation.conditions.settling
        if self.settled is None or settling is None:
            r = self.response(base, terms, oversampling)
            r -= self.campaign.response
            return r
        moved = base.copy()
        moved[self.joint_at] = self.settled.anchor
        r = self.response(moved, terms, oversampling)
        r -= self.campaign.response
        share = base[self.joint_at] - self.settled.anchor - settling
        r += share[:, None, None] * self.settled.slope
        return r

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

    def refine(self, base: FloatArray, terms: Sequence[Term]) -> "LumpedBench":
        """Return the bench with its noise estimated at a solution."""
        at = self._centred(base)
        model = at.response(base, terms)
        residual = model - self.campaign.response
        self.mask(residual)
        sigma = at.channel_noise(model, residual)
        columns = _force_columns(self, base, sigma)
        ways = _scatter_ways(at, base, terms, model, sigma)
        noise = replace(self.noise, sigma=sigma)
        none = tuple(0.0 for _ in range(ways.shape[1]))
        bare = _with_noise(at, replace(noise, scatter=none), columns, ways)
        coefficients, variances = regress(
            (residual / sigma[:, :, None]).reshape(len(sigma), -1),
            ways,
            bare.basis,
            bare.shrink,
        )
        known = at.excitation.conditions.settling
        if known is not None:
            coefficients[:, 1] -= known
        scatter, groups = at.scatter_of(coefficients, variances)
        noise = replace(noise, scatter=scatter, scatter_known=groups)
        refined = _with_noise(at, noise, columns, ways)
        lost = np.linalg.norm(residual) > LOST * np.linalg.norm(model)
        if len(scatter) < 2 or scatter[1] < SETTLING_SEEN or lost:
            return _settle(refined, None)
        share = scatter[1] ** 2 / (scatter[1] ** 2 + variances[:, 1])
        reach = SETTLING_REACH * scatter[1]
        settling = np.clip(-coefficients[:, 1] * share, -reach, reach)
        return refined.expanded(settling, base, terms, columns)

    def _centred(self, base: FloatArray) -> "LumpedBench":
        """Return the bench with each hit's stiffness kept, about the base's mean."""
        settling = self.excitation.conditions.settling
        if self.settled is None or settling is None:
            return self
        return _settle(self, settling + self.settled.anchor - base[self.joint_at])

    def channel_noise(self, model: FloatArray, residual: FloatArray) -> FloatArray:
        """Return the noise of each record and channel, (n_records, n_channels)."""
        peak = np.abs(model).max(axis=2)
        sigma = channel_sigma(residual[:, :, self.campaign.lead : -TAIL], peak)
        if self.campaign.repeatability is not None:
            sigma = np.hypot(sigma, self.campaign.repeatability * peak)
        return sigma

    def scatter_of(
        self, coefficients: FloatArray, variances: FloatArray
    ) -> tuple[tuple[float, ...], bool]:
        """Return the scatter along each way, and whether repeats bound it."""
        campaign = self.campaign
        groups = repeat_groups(campaign.hit, campaign.level, campaign.preload)
        count = coefficients.shape[1]
        if campaign.repeatability is not None:
            return (0.0,) * count, bool(groups)
        patterns = _patterns(self.excitation.conditions)
        scatter = tuple(
            gain_scatter(
                without_trend(coefficients[:, i], patterns), variances[:, i], groups
            )
            for i in range(count)
        )
        return scatter, bool(groups)

    def expanded(
        self,
        settling: FloatArray,
        base: FloatArray,
        terms: Sequence[Term],
        columns: list[FloatArray],
    ) -> "LumpedBench":
        """Return the bench expanded about a settling, with its scatter whitened there.

        What is taken by the slope is then the very direction that whitening blurs,
        and nothing of the settling leaks past it.
        """
        there = _settle(self, settling)
        sigma = self.noise.sigma
        moved = there.response(base, terms)
        ways = _scatter_ways(there, base, terms, moved, sigma)
        slope = ways[:, 1].reshape(*sigma.shape, -1) * sigma[:, :, None]
        whitened = _with_noise(there, self.noise, columns, ways)
        settled = Settled(float(base[self.joint_at]), slope)
        return replace(whitened, settled=settled)

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


def _patterns(conditions: Conditions) -> FloatArray:
    """Return what a joint could depend on from record to record, (2, n_records)."""
    return np.stack([np.log(conditions.preload), conditions.progress])


def _window(bench: LumpedBench, decay: float) -> FloatArray:
    n = bench.excitation.growth.size
    time = (np.arange(n) - bench.gate[0]) / bench.campaign.sample_rate
    return np.asarray(np.exp(-np.maximum(time, 0.0) / decay))


def _force_columns(
    bench: LumpedBench, base: FloatArray, sigma: FloatArray
) -> list[FloatArray]:
    """Responses to the force's own noise, over sigma, one array for each record."""
    first, last = bench.gate
    n, records = bench.excitation.growth.size, sigma.shape[0]
    if last - first >= n or bench.noise.force_sigma <= 0:
        return [np.zeros((0, sigma.shape[1] * n))] * records
    force = np.zeros((1, n))
    force[0, first] = bench.noise.force_sigma
    cases = {}
    for hit in sorted(set(bench.campaign.hit.tolist())):
        still = Conditions(np.ones(1), np.zeros(1))
        rate = bench.campaign.sample_rate
        shaken = prepare_excitation(force, np.array([hit]), rate, still)
        y = respond(bench.campaign.model, bench.theta(base), shaken)[0]
        cases[hit] = _shifted(y, last - first)
        bench.mask(cases[hit])
    return [
        _leading((cases[int(h)] / s[:, None]).reshape(last - first, -1))
        for h, s in zip(bench.campaign.hit, sigma, strict=True)
    ]


def _shifted(response: FloatArray, count: int) -> FloatArray:
    """Return a response delayed by 0 to count - 1 samples, (count, *its shape)."""
    out = np.zeros((count, *response.shape))
    for k in range(count):
        out[k, :, k:] = response[:, : response.shape[1] - k]
    return out


def _leading(rows: FloatArray) -> FloatArray:
    """Return the few directions that hold most of unit noise in every row."""
    _, vectors = np.linalg.eigh(rows @ rows.T)
    return np.asarray(vectors[:, -FORCE_SHAPES:].T @ rows)


def _scatter_ways(
    bench: LumpedBench,
    base: FloatArray,
    terms: Sequence[Term],
    model: FloatArray,
    sigma: FloatArray,
) -> FloatArray:
    """Return how hits may scatter, over sigma, (n_records, n_ways, n_rows).

    The hand: the force that acts is not quite the one measured. The joint: it settles
    anew from hit to hit, a change of its stiffness.
    """
    ways = [_harder(bench, base, terms, model)]
    n = len(bench.campaign.model.bodies)
    for i, link in enumerate(bench.campaign.model.links):
        if link.joint and not bench.campaign.continuous:
            moved = base.copy()
            moved[n + i] += SCATTER_STEP
            ways.append((bench.response(moved, terms) - model) / SCATTER_STEP)
    stacked = np.stack(ways, axis=1)
    bench.mask(stacked)
    stacked /= sigma[:, None, :, None]
    return stacked.reshape(len(sigma), len(ways), -1)


def _harder(
    bench: LumpedBench, base: FloatArray, terms: Sequence[Term], model: FloatArray
) -> FloatArray:
    """Return the change of the response per relative change of the force."""
    if not any(a.entry.law is not None for a in bench.actions(terms)):
        return model.copy()
    spectrum = bench.excitation.spectrum * (1.0 + SCATTER_STEP)
    pushed = replace(bench, excitation=replace(bench.excitation, spectrum=spectrum))
    return (pushed.response(base, terms) - model) / SCATTER_STEP


def _settle(bench: LumpedBench, settling: FloatArray | None) -> LumpedBench:
    """Return the bench with its model taken at a settling of the joint."""
    conditions = replace(bench.excitation.conditions, settling=settling)
    excitation = replace(bench.excitation, conditions=conditions)
    return replace(bench, excitation=excitation, settled=None, short={})


def _with_noise(
    bench: LumpedBench, noise: Noise, columns: list[FloatArray], ways: FloatArray
) -> LumpedBench:
    """Return the bench with the whitening of `noise`."""
    parts = []
    for own, way in zip(columns, ways, strict=True):
        spread = [s * w[None, :] for s, w in zip(noise.scatter, way, strict=True) if s]
        parts.append(whitening_basis(np.concatenate([own, *spread])))
    kept = max(b.shape[0] for b, _ in parts)
    basis = np.zeros((len(parts), kept, ways.shape[2]))
    shrink = np.zeros((len(parts), kept, 1))
    for k, (b, s) in enumerate(parts):
        basis[k, : b.shape[0]] = b
        shrink[k, : b.shape[0], 0] = s
    return replace(bench, noise=noise, basis=basis, shrink=shrink, short={})


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
