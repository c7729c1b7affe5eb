# SPDX-License-Identifier: MIT
"""The bench of bolted bodies: hits with a model of modes and joints, for the engine."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.model.diagnosis_record import View
from jointbench.analysis.gap.model.effect import Candidate, Term, may_join
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.bench_protocol import values_of
from jointbench.analysis.gap.residuals.evaluation_resolutions import (
    FULL,
    Resolution,
)
from jointbench.analysis.gap.residuals.fit_records import Blocks, Fit
from jointbench.analysis.gap.residuals.noise_models import Noise
from jointbench.analysis.gap.residuals.residual_views import slice_views
from jointbench.analysis.gap.residuals.scatter_record import no_scatter
from jointbench.analysis.gap.residuals.slopes import SlopeArray
from jointbench.analysis.gap.structure_bench.joint_axes import ALONG_BOLTS
from jointbench.analysis.gap.structure_bench.law_slopes import LawSlopes
from jointbench.analysis.gap.structure_bench.record_whitening import RecordWhitening
from jointbench.analysis.gap.structure_bench.structure_effects import (
    StructureEffect,
    structure_state,
)
from jointbench.analysis.gap.structure_response.base_layout import BaseLayout
from jointbench.analysis.gap.structure_response.closed_flexibility import (
    closed_flexibility,
)
from jointbench.analysis.gap.structure_response.hit_campaign import (
    HitCampaign,
    record_blocks,
)
from jointbench.analysis.gap.structure_response.hit_frames import (
    HitFrame,
    hit_frame,
    window_count,
)
from jointbench.analysis.gap.structure_response.hit_response import (
    HitModel,
    direction_rows,
    hit_model,
)
from jointbench.analysis.gap.structure_response.joint_state import JointState, state_of
from jointbench.analysis.gap.structure_response.jointed_bodies import NORMAL
from jointbench.analysis.gap.structure_response.landing import (
    landing_weights,
    mean_landing,
)
from jointbench.analysis.gap.structure_response.modal_table_settings import MODAL_TABLE
from jointbench.analysis.gap.structure_response.residue_errors import (
    ResidueErrors,
    residue_errors,
    separable,
    typical_peaks,
)
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


@dataclass(frozen=True, slots=True, eq=False)
class StructureBench:
    """Hits on bolted bodies, as the engine uses them.

    Attributes:
        campaign: records, model and nominal parameters.
        layout: base coordinates.
        entries: the catalogue of this run.
        candidates: the catalogue at every site.
        floor: error of the model as a share of the peak of a record and channel [-].
        landing: tilts [rad] and offsets [m] about which hits are expanded,
            shape (n_records, 4).
        sigma: sd of the residual [m/s^2], shape (n_records, n_channels).
        directions: derivatives of the response by directions of unit sd, shape
            (n_records, 5, n_channels, n_samples), or as many samples as a window has;
            None before they are computed.
        reach: largest deviation of a base coordinate [sd].
        blocks: records as groups.
        scales: words to values.
        kept: closures, transforms and whitenings that are used again.
        policy: thresholds for fits of the bench.
        errors: of responses by those of an uncertain modal table; None if it is exact,
            and before they are computed.
        bodies: responses to errors of the bodies [m/s^2], shape
            (n_records, n_errors, n_channels, n_samples), where tests of weak effects
            weigh the table by them; None elsewhere.
    """

    campaign: HitCampaign
    layout: BaseLayout
    entries: tuple[StructureEffect, ...]
    candidates: tuple[Candidate, ...]
    floor: float
    landing: FloatArray
    sigma: FloatArray
    directions: FloatArray | None
    reach: float
    blocks: Blocks
    scales: dict[str, float]
    kept: dict[Any, Any]
    policy: Policy = STANDARD
    errors: ResidueErrors | None = None
    bodies: FloatArray | None = None

    @property
    def base_names(self) -> tuple[str, ...]:
        """Names of the base parameters."""
        return self.layout.names

    @property
    def base_sd(self) -> FloatArray:
        """Prior standard deviation of the coordinates, shape (n_base,)."""
        return self.layout.sd

    @property
    def base_limits(self) -> tuple[FloatArray, FloatArray]:
        """Bounds of the base coordinates."""
        return -self.reach * self.layout.sd, self.reach * self.layout.sd

    @property
    def probes(self) -> tuple[Candidate, ...]:
        """No shapes beyond the catalogue."""
        return ()

    @property
    def table_floor(self) -> float:
        """Error of the model that its bases do not follow, as a share of the peak [-].

        Of an uncertain modal table, errors of second order are left.
        """
        stated = MODAL_TABLE.shape_floor * self.campaign.nominal.table_sd[1]
        return max(MODAL_TABLE.table_floor, stated)

    @property
    def coherence(self) -> float:
        """Samples over independent errors of an uncertain modal table; 1 if exact.

        The error of a table is the same in all hits of a point, and in a record it is
        one amplitude and one phase of each mode: neither more hits nor more samples
        average it out. Fits give a record the weight of as many numbers.
        """
        tuned = self.layout.tuned
        if tuned is None or not self.uncertain:
            return 1.0
        points = np.unique(self.campaign.hits.point).size
        records, _, count = self.campaign.hits.response.shape
        modes = max(tuned.omega.size, 1)
        return float(records / points * max(count / (2 * modes), 1.0))

    @property
    def uncertain(self) -> bool:
        """Whether the shapes of the modal table are uncertain."""
        return self.campaign.nominal.table_sd[1] > 0.0

    @property
    def expanded(self) -> bool:
        """Whether hits are expanded about where they landed."""
        return bool(np.any(self.landing))

    @property
    def stiffness_sd(self) -> FloatArray:
        """Empty: bolts do not settle from hit to hit."""
        return np.zeros(0)

    def at_stiffness(self, settling: FloatArray) -> "StructureBench":
        """Return the bench unchanged."""
        return self

    @property
    def noise(self) -> Noise:
        """Noise of the sensors with the floor; the force counts as exact."""
        return Noise(self.sigma, 0.0, no_scatter((), len(self.sigma)))

    def views(self, fit: Fit) -> tuple[View, ...]:
        """Return the residual of a fit by view, in the units of its chi2/dof."""
        hits = self.campaign.hits
        residual = np.sqrt(self.coherence) * fit.residual.reshape(self.blocks.shape)
        names = self.campaign.bodies.channels
        return slice_views(residual, self.blocks, names, hits.sample_rate)

    def phases(self, candidate: Candidate) -> int:
        """No effect fits a phase of its own."""
        return 0

    def hints(self, fit: Fit, candidate: Candidate) -> list[FloatArray]:
        """Return starts of a mark where the hits of its point landed, if far from it.

        Aim and tilt of each hit take over most of a common offset, so directed tests
        show little of it; the mean of the offsets found shows it instead.
        """
        known = {e.effect.name for e in self.entries if e.aimed}
        if candidate.effect.name not in known:
            return []
        count = fit.residual.size // int(np.prod(self.blocks.shape[:2]))
        window = count / self.campaign.hits.sample_rate
        landing, _ = self.landed(fit.base, fit.terms, window)
        offset = mean_landing(self.campaign, candidate.site.name, landing)
        distance = float(np.linalg.norm(offset))
        if distance < STRUCTURE.mark_sd * self.campaign.nominal.aim_sd:
            return []
        azimuth = float(np.arctan2(offset[1], offset[0]))
        return [np.array([size * distance, azimuth]) for size in STRUCTURE.mark_starts]

    def scale(self, word: str) -> float:
        """Return the scale of a word [SI]."""
        return self.scales[word]

    def state(self, base: FloatArray, terms: Sequence[Term]) -> JointState:
        """Return the state of the model at base coordinates with effects."""
        bare = state_of(self.campaign.bodies, self.campaign.nominal, self.layout, base)
        values = [values_of(self, term) for term in terms]
        return structure_state(self.entries, self.campaign, bare, terms, values)

    def nonlinear(
        self, candidates: Sequence[Candidate], *, every: bool = False
    ) -> bool:
        """Return whether any of the effects, or every one, is integrated in time."""
        names = {e.effect.name for e in self.entries if e.nonlinear}
        return (all if every else any)(c.effect.name in names for c in candidates)

    def may_add(self, candidate: Candidate, fitted: Sequence[Candidate]) -> bool:
        """Return whether an effect may be fitted beside others.

        Of two laws that are integrated in time, one is sought: each fit of a pair would
        integrate both for every coordinate. What distributes the compliance along the
        bolts needs one.
        """
        yields = any(c.site == ALONG_BOLTS for c in fitted)
        yielding = {e.effect.name for e in self.entries if e.yielding}
        if self.campaign.bodies.rigid[NORMAL] and not yields:
            if candidate.effect.name in yielding:
                return False
        lonely = {e.effect.name for e in self.entries if e.alone}
        every = (candidate, *fitted)
        if fitted and any(c.effect.name in lonely for c in every):
            return False
        two = self.nonlinear((candidate,)) and self.nonlinear(fitted)
        return may_join(candidate, fitted) and not two

    def addable(self, fitted: Sequence[Candidate]) -> list[Candidate]:
        """Return the catalogue that may be fitted beside others, or beside none."""
        return [c for c in self.candidates if self.may_add(c, fitted)]

    def frame(self, window: float | None) -> HitFrame:
        """Return the transforms of a window."""
        count = window_count(self.campaign.hits, window)
        found: HitFrame = self._kept(
            ("frame", count), lambda: hit_frame(self.campaign.hits, count)
        )
        return found

    def response(
        self, base: FloatArray, terms: Sequence[Term], window: float | None
    ) -> FloatArray:
        """Predict the responses, shape (n_records, n_channels, count)."""
        return self.model(base, terms, window).response()

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return model minus measurement over sigma, whitened, shape (n_rows,)."""
        return np.asarray(self.residuals(base, [terms], resolution)[0])

    def residuals(
        self,
        base: FloatArray,
        every: Sequence[Sequence[Term]],
        resolution: Resolution,
    ) -> FloatArray:
        """Return residuals with each of several sets of effects, whitened together.

        Args:
            base: coordinates.
            every: sets of effects.
            resolution: of the records.

        Returns:
            Model minus measurement over sigma, shape (n_sets, n_rows).
        """
        fine, window = resolution.oversampling > FULL.oversampling, resolution.window
        models = (self.model(base, terms, window, fine=fine) for terms in every)
        off = np.stack([self.off(model.response()) for model in models], axis=1)
        white = self.whitening(off).swapaxes(0, 1)
        return white.reshape(len(every), -1)

    def slopes(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> SlopeArray:
        """Return the slopes of the residual by the base, shape (n_rows, n).

        Columns by the coordinates of the effects follow: if all of these are nonlinear
        laws, with which the linear response does not change, their slopes, else NaN.
        They are stored in single precision.
        """
        model = self.model(base, terms, resolution.window)
        changes: list[ComplexArray] = []
        added: list[ComplexArray] = []
        if model.forces is not None:
            laws = LawSlopes(self, model.frame, model.forces, base, terms)
            changes = laws.by_base()
            if self.nonlinear([t.candidate for t in terms], every=True):
                added = laws.by_terms()
        n, records = self.layout.sd.size, len(self.landing)
        whole = n + sum(t.coordinates.size for t in terms)
        columns = np.empty((whole, records, *model.shape), np.float32)
        model.write_slopes(self.layout, changes, self.sigma, columns)
        for k, forces in enumerate(added):
            columns[n + k] = model.pushed(forces) / self.sigma[:, :, None]
        known = columns[: n + len(added)]
        columns[len(known) :] = np.nan
        self.whitening.in_place(known.transpose(1, 0, 2, 3))
        return columns.reshape(len(columns), -1).T

    def refine(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        *,
        without: Sequence[int] = (),
    ) -> "StructureBench":
        """Return the bench with directions and sigma at a solution.

        Both come from the model, so records that are held out do not matter.
        """
        return self.at(base, terms, self.landing, self.floor)

    def at(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        landing: FloatArray,
        floor: float,
        window: float | None = None,
    ) -> "StructureBench":
        """Return the bench expanded about landing points, with a floor.

        Args:
            base: coordinates at which directions and peaks are computed.
            terms: effects there.
            landing: tilts and offsets of each hit, shape (n_records, 4).
            floor: error of the model, as a share of the peak [-].
            window: to which the bench is fitted, or shorter ones [s]; None for any.
        """
        moved = replace(self, landing=landing, kept=frames_of(self.kept), bodies=None)
        model = moved.model(base, terms, window)
        rows = direction_rows(model, landing, self.direction_sd)
        peak = np.abs(self.campaign.hits.response).max(axis=2)
        if self.uncertain:
            peak = typical_peaks(self.campaign, peak)
        sigma = np.hypot(self.campaign.hits.noise, floor * peak)
        errors = None
        if self.uncertain:
            sigma = separable(self.campaign, sigma) * np.sqrt(self.coherence)
            errors = residue_errors(self.campaign, model.state, model.frame)
        return replace(moved, floor=floor, sigma=sigma, directions=rows, errors=errors)

    def landed(
        self, base: FloatArray, terms: Sequence[Term], window: float | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Return the most likely tilts and offsets of each hit, and its gain.

        Args:
            base: coordinates.
            terms: effects.
            window: of the records [s]; None for all of them.

        Returns:
            Landing, shape (n_records, 4), and relative gain, shape (n_records,).
        """
        off = self.off(self.response(base, terms, window))
        found = self.whitening.found(off) * self.direction_sd
        return found[:, :4], found[:, 4]

    @property
    def whitening(self) -> RecordWhitening:
        """Whitening of all records for what is known of their errors."""
        hits, uncertain = self.campaign.hits, self.uncertain
        return RecordWhitening(
            hits,
            self.sigma,
            self.directions,
            self.errors,
            self.bodies,
            uncertain,
            self.kept,
        )

    @property
    def direction_sd(self) -> FloatArray:
        """Prior sd of two tilts [rad], two offsets [m] and the gain, shape (5,)."""
        nominal = self.campaign.nominal
        tilt, aim = nominal.tilt_sd, nominal.aim_sd
        return np.array([tilt, tilt, aim, aim, STRUCTURE.gain_sd])

    def at_rest(self) -> "StructureBench":
        """Return the bench without what it keeps, which is computed again when used.

        Closed responses and whitenings of all records are half a gigabyte.
        """
        return replace(self, kept=frames_of(self.kept))

    def chosen(self, records: IntArray) -> "StructureBench":
        """Return the bench of some of its records."""
        campaign = replace(self.campaign, hits=self.campaign.hits.chosen(records))
        return replace(
            self,
            campaign=campaign,
            landing=self.landing[records],
            sigma=self.sigma[records],
            directions=None if self.directions is None else self.directions[records],
            errors=None if self.errors is None else self.errors.chosen(records),
            bodies=None if self.bodies is None else self.bodies[records],
            blocks=record_blocks(campaign),
            kept={},
        )

    def off(self, modelled: FloatArray) -> FloatArray:
        """Return model minus measurement [m/s^2], about where hits landed.

        Of what the expansion adds to a response, the prior mean of its directions is
        left out.

        Args:
            modelled: responses, shape (n_records, n_channels, count).
        """
        count = modelled.shape[2]
        r = modelled - self.campaign.hits.response[:, :, :count]
        if self.directions is None:
            return r
        moved = np.zeros((len(self.landing), 5))
        moved[:, :4] = self.landing / self.direction_sd[:4]
        r -= np.einsum("rd,rdct->rct", moved, self.directions[..., :count])
        return r

    def difference(self, base: FloatArray, terms: Sequence[Term]) -> FloatArray:
        """Return model minus measurement, shape of the response."""
        return self.response(base, terms, None) - self.campaign.hits.response

    def _kept(self, key: tuple[object, ...], make: Callable[[], Any]) -> Any:
        if key not in self.kept:
            self.kept[key] = make()
        return self.kept[key]

    def model(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        window: float | None,
        *,
        fine: bool = False,
    ) -> HitModel:
        """Return the model at a state; the last one of a window is kept."""
        state = ((t.candidate, t.coordinates.tobytes()) for t in terms)
        key = (fine, base.tobytes(), *state)
        place = ("model", window_count(self.campaign.hits, window))
        if place in self.kept and self.kept[place][0] == key:
            kept: HitModel = self.kept[place][1]
            return kept
        # The last one goes before the next one comes: two take a gigabyte.
        self.kept.pop(place, None)
        found = hit_model(
            self.campaign,
            self.state(base, terms),
            self.frame(window),
            landing_weights(self.landing),
            fine=fine,
            flexibility=self.kept.get(("flexibility", place[1])),
        )
        self.kept[place] = key, found
        return found

    def for_tests(self, fit: Fit, window: Resolution) -> "StructureBench":
        """Return the bench with the joints closed once for directed tests of a fit.

        Args:
            fit: to which effects are added.
            window: of the tests.
        """
        frame = self.frame(window.window)
        state = self.state(fit.base, fit.terms)
        bodies = state.bodies_of(self.campaign.bodies)
        found = closed_flexibility(bodies, state, frame.s)
        place = ("flexibility", window_count(self.campaign.hits, window.window))
        return replace(self, kept=self.kept | {place: found})


def frames_of(kept: dict[Any, Any]) -> dict[Any, Any]:
    """Return what depends neither on where hits landed nor on the base coordinates."""
    return {key: value for key, value in kept.items() if key[0] == "frame"}
