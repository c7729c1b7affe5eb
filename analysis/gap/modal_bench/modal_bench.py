# SPDX-License-Identifier: MIT
"""A bench of modes and ports: records of a structure and a base identified from them.

It has the interface of every bench, so that the one engine (directed tests, selection,
acceptance) runs on it. No window is applied, since the excitation lasts as long as a
record; where the engine asks for one, the laws follow the measured motion of the ports.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE, check_names
from jointbench.analysis.gap.catalogue.probes import PROBES
from jointbench.analysis.gap.modal_bench.level_records import LevelRecord, RecordSet
from jointbench.analysis.gap.modal_bench.modal_base import ModalBase
from jointbench.analysis.gap.modal_bench.modal_settings import MODAL
from jointbench.analysis.gap.modal_bench.outline import outline
from jointbench.analysis.gap.modal_bench.port_effects import (
    port_candidates,
    port_scales,
)
from jointbench.analysis.gap.modal_bench.port_response import (
    PortForces,
    Shaken,
    measured_forces,
    respond_modes,
    shaken,
)
from jointbench.analysis.gap.model.campaign import TAIL, Campaign
from jointbench.analysis.gap.model.diagnosis_record import View
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.bench_protocol import values_of
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL, Resolution
from jointbench.analysis.gap.residuals.fit_records import Blocks, Fit
from jointbench.analysis.gap.residuals.noise_models import Noise, channel_sigma
from jointbench.analysis.gap.residuals.residual_views import slice_views
from jointbench.analysis.gap.residuals.scatter_record import no_scatter
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.analysis.gap.response.port_forces import PortLaw
from jointbench.analysis.gap.response.search_effort import spend


@dataclass(frozen=True, slots=True, eq=False)
class ModalBench:
    """Records of a structure with a modal base, as the engine uses them.

    Attributes:
        given: the records, with sensors, inputs and ports.
        base: nominal modes with priors.
        entries: the catalogue of this run.
        data: the transformed records of the fits.
        sigma: noise of each record and sensor, shape (n_records, n_sensors).
        candidates: the laws of the catalogue at each port.
        probes: further shapes for directed tests, at each port.
        blocks: records as groups.
        scales: words to values.
        kept: forces along the measured motion, by laws and step.
        policy: thresholds for fits of the bench.
    """

    given: RecordSet
    base: ModalBase
    entries: tuple[LumpedEffect, ...]
    data: Shaken
    sigma: FloatArray
    candidates: tuple[Candidate, ...]
    probes: tuple[Candidate, ...]
    blocks: Blocks
    scales: dict[str, float]
    kept: dict[tuple[object, ...], PortForces]
    policy: Policy = STANDARD

    @property
    def base_names(self) -> tuple[str, ...]:
        """Names of the base parameters."""
        return self.base.names

    @property
    def base_sd(self) -> FloatArray:
        """Prior standard deviation of the coordinates, shape (n_base,)."""
        return self.base.sd

    @property
    def campaign(self) -> Campaign:
        """Forces, responses, levels and points of the fits."""
        return outline(self.given, self.data)

    @property
    def noise(self) -> Noise:
        """Noise of the sensors; forces and levels count as exact."""
        return Noise(self.sigma, 0.0, no_scatter((), len(self.sigma)))

    @property
    def expanded(self) -> bool:
        """A modal base is never expanded about single records."""
        return False

    def phases(self, candidate: Candidate) -> int:
        """No law at a port fits a phase of its own."""
        return 0

    def hints(self, fit: Fit, candidate: Candidate) -> list[FloatArray]:
        """No law at a port starts at peaks of the residual."""
        return []

    def scale(self, word: str) -> float:
        """Return the scale of a word [SI], also of the form ``a@port/b@port^2``."""
        if word not in self.scales:
            top, _, bottom = word.partition("/")
            base, _, power = bottom.partition("^")
            above = self.scales[top if top != "1" else "one"]
            self.scales[word] = above / self.scales[base] ** int(power or 1)
        return self.scales[word]

    def response(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        oversampling: int,
        *,
        measured_motion: bool = False,
    ) -> FloatArray:
        """Predict the sensors, shape (n_records, n_sensors, n_samples)."""
        laws = self._laws(terms)
        forces = self._forces(terms, laws, oversampling) if measured_motion else None
        spend(self.data.measured.size, oversampling if laws and forces is None else 0)
        return respond_modes(
            self.given,
            self.base.modes(base),
            self.data,
            laws,
            oversampling=oversampling,
            forces=forces,
        )

    def _forces(
        self, terms: Sequence[Term], laws: Sequence[PortLaw], oversampling: int
    ) -> PortForces | None:
        """Return the forces along the measured motion, kept while the base moves."""
        if not laws:
            return None
        key = (
            oversampling,
            *((t.candidate.label, t.coordinates.tobytes()) for t in terms),
        )
        found = self.kept.get(key)
        if found is None:
            if len(self.kept) >= MODAL.kept_forces:
                self.kept.clear()
            found = measured_forces(self.given, self.data, laws, oversampling)
            self.kept[key] = found
        return found

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return model minus measurement over sigma, shape (n_rows,).

        A resolution with a window, which a record without an end does not have, takes
        the laws along the measured motion.
        """
        r = self._left(
            self.response(
                base,
                terms,
                resolution.oversampling,
                measured_motion=resolution.window is not None,
            )
        )
        r *= self.data.scored
        r /= self.sigma[:, :, None]
        return r.ravel()

    def difference(
        self, base: FloatArray, terms: Sequence[Term], oversampling: int
    ) -> FloatArray:
        """Return model minus measurement, shape of the response."""
        return self._left(self.response(base, terms, oversampling))

    def _left(self, model: FloatArray) -> FloatArray:
        """Return a response less the measured one, without the offsets that are free.

        Args:
            model: the response, which is overwritten.
        """
        model -= self.data.measured
        for r, scored, record in zip(
            model, self.data.scored, self.data.records, strict=True
        ):
            if record.offset:
                r -= (r * scored).sum(axis=1, keepdims=True) / scored.sum(
                    axis=1, keepdims=True
                )
        return model

    def mask(self, values: FloatArray) -> None:
        """Set samples without weight to 0, in place."""
        values *= self.data.scored

    @property
    def stiffness_sd(self) -> FloatArray:
        """Empty: the ports of a modal base do not settle."""
        return np.zeros(0)

    def at_stiffness(self, settling: FloatArray) -> "ModalBench":
        """Return the bench unchanged."""
        return self

    def refine(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        *,
        without: Sequence[int] = (),
    ) -> "ModalBench":
        """Return the bench with its noise estimated at a solution.

        The noise of a record comes from that record alone, whatever is held out.
        """
        model = self.response(base, terms, FULL.oversampling)
        residual = self._left(model.copy()) * self.data.scored
        return replace(self, sigma=noise_of(self.given, self.data, residual, model))

    def views(self, fit: Fit) -> tuple[View, ...]:
        """Return the residual of a fit by view."""
        residual = fit.residual.reshape(self.blocks.shape)
        first = min(r.lead for r in self.data.records)
        return slice_views(
            residual[:, :, first:-TAIL],
            self.blocks,
            self.given.sensors,
            self.given.sample_rate,
        )

    def _laws(self, terms: Sequence[Term]) -> list[PortLaw]:
        """Return the laws of terms, each with the index of its port."""
        entries = {e.effect.name: e for e in (*self.entries, *PROBES)}
        ports = [port.name for port in self.given.ports]
        found = []
        for term in terms:
            law = entries[term.candidate.effect.name].law
            if law is not None:
                port = ports.index(term.candidate.site.name)
                found.append(PortLaw(port, law(values_of(self, term))))
        return found


def make_modal_bench(
    given: RecordSet,
    base: ModalBase,
    *,
    records: Sequence[LevelRecord] | None = None,
    without: frozenset[str] = frozenset(),
    entries: tuple[LumpedEffect, ...] = CATALOGUE,
    policy: Policy = STANDARD,
) -> ModalBench:
    """Prepare records with a modal base for the engine.

    Args:
        given: records with sensors, inputs and ports.
        base: nominal modes with priors.
        records: those of the fits; None for those that laws are fitted to.
        without: names of effects to leave out of the catalogue.
        entries: the catalogue.
        policy: thresholds for its fits.

    Raises:
        UsageError: `without` holds a name that no entry has.
    """
    check_names(without, entries)
    entries = tuple(e for e in entries if e.effect.name not in without)
    data = shaken(given, given.fitted if records is None else records, TAIL)
    scales = port_scales(given, base.nominal, data)
    # Before the first fit, the top of the spectrum of the response bounds the noise.
    sigma = noise_of(given, data, data.measured * data.scored, data.measured)
    return ModalBench(
        given=given,
        base=base,
        entries=entries,
        data=data,
        sigma=sigma,
        candidates=port_candidates(entries, given),
        probes=port_candidates(PROBES, given),
        blocks=_blocks(given, data),
        scales=scales | {"noise": float(sigma.min())},
        kept={},
        policy=policy,
    )


def noise_of(
    given: RecordSet, data: Shaken, residual: FloatArray, model: FloatArray
) -> FloatArray:
    """Return the noise of each record and sensor, (n_records, n_sensors).

    It is that of the records where periods or a statement give it, and else that of the
    residual at the top of the spectrum; a stated repeatability adds to it.

    Args:
        given: the set.
        data: its transformed records.
        residual: model minus measurement, 0 where nothing counts, shape
            (n_records, n_sensors, n_samples).
        model: the response, same shape.
    """
    peak = np.abs(model * data.scored).max(axis=2)
    sigma = np.empty(peak.shape)
    for k, record in enumerate(data.records):
        if record.noise is not None:
            sigma[k] = record.noise
            continue
        cut = slice(record.lead, record.force.shape[1] - TAIL)
        sigma[k] = channel_sigma(residual[k : k + 1, :, cut], peak[k : k + 1])[0]
    if given.repeatability is not None:
        sigma = np.hypot(sigma, given.repeatability * peak)
    return np.asarray(np.maximum(sigma, 1e-9 * np.abs(data.measured).max()))


def _blocks(given: RecordSet, data: Shaken) -> Blocks:
    records, sensors, samples = data.measured.shape
    labels = tuple(
        {"level": r.level, "excitation": r.excitation or "any", "order": f"{k}"}
        for k, r in enumerate(data.records)
    )
    return Blocks(
        np.repeat(np.arange(records), sensors * samples),
        labels,
        int(data.scored.sum()),
        data.measured.shape,
        white=given.repeatability is None,
    )
