# SPDX-License-Identifier: MIT
"""The bench of lumped dynamics: a campaign and its model, as used by the engine."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.catalogue.catalogue import ALL_CHANNELS
from jointbench.analysis.gap.model.campaign import TAIL
from jointbench.analysis.gap.model.diagnosis_record import View
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.residuals.bench_noise import refine_noise
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_settling import joint_at
from jointbench.analysis.gap.residuals.lumped_residual import LumpedResidual, settle
from jointbench.analysis.gap.residuals.residual_views import residual_peaks, slice_views


@dataclass(frozen=True, slots=True, eq=False)
class LumpedBench(LumpedResidual):
    """Residuals of a lumped model, with the candidates of the catalogue.

    Attributes:
        candidates: the catalogue, at every site.
        probes: further shapes for directed tests, at every site.
    """

    candidates: tuple[Candidate, ...]
    probes: tuple[Candidate, ...]

    @property
    def base_names(self) -> tuple[str, ...]:
        """Names of the base parameters."""
        return self.campaign.model.base_names

    @property
    def base_sd(self) -> FloatArray:
        """Prior sd of log(parameter / nominal), shape (n_base,)."""
        return self.campaign.model.spread

    @property
    def stiffness_sd(self) -> FloatArray:
        """Prior sd of the joint's log stiffness in each hit: that of the joint."""
        model = self.campaign.model
        settles = any(x.joint for x in model.links) and not self.campaign.continuous
        if not settles or self.campaign.repeatability is not None:
            return np.zeros(0)
        return np.full(len(self.campaign.hit), model.spread[joint_at(model)])

    def at_stiffness(self, settling: FloatArray) -> "LumpedBench":
        """Return the bench at a given stiffness of each hit, scatter not whitened."""
        there = settle(self, settling)
        return replace(there, shrink=np.zeros_like(there.shrink), mixing=None)

    def refine(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        *,
        without: Sequence[int] = (),
    ) -> "LumpedBench":
        """Return the bench with its noise estimated at a solution."""
        return refine_noise(self, base, terms, without=without)

    def views(self, fit: Fit) -> tuple[View, ...]:
        """Return the residual of a fit by view."""
        records, channels, samples = self.campaign.response.shape
        residual = fit.residual.reshape(records, channels, samples)
        return slice_views(
            residual[:, :, self.campaign.lead : -TAIL],
            self.blocks,
            [c.name for c in self.campaign.model.channels],
            self.campaign.sample_rate,
        )

    def hints(self, fit: Fit, candidate: Candidate) -> list[FloatArray]:
        """Return starts at the spectral peaks of a fit's residual: hum lines, modes."""
        if not candidate.effect.starts_at_peaks:
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
        """Return the number of phases that an effect fits; 0 for most effects."""
        if not candidate.effect.own_phases:
            return 0
        records, channels = self.noise.sigma.shape
        everywhere = candidate.site.name == ALL_CHANNELS
        return int(records) * (int(channels) if everywhere else 1)
