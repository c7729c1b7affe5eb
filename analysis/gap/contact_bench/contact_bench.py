# SPDX-License-Identifier: MIT
"""The contact bench: stiffness and damping of a joint over preload, for the engine.

It has the interface of every bench, so that directed tests, descent, scores and rivals
are those of the one engine. A base of a contact law with priors predicts the logarithm
of each value; effects act on the way from the torque to that value.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.contact_bench.contact_catalogue import contact_catalogue
from jointbench.analysis.gap.contact_bench.contact_damping import contact_probes
from jointbench.analysis.gap.contact_bench.contact_effect import (
    ContactEffect,
    EffectPlace,
    LoadedJoint,
)
from jointbench.analysis.gap.contact_bench.contact_layout import (
    ContactLayout,
    contact_layout,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.contact_views import contact_views
from jointbench.analysis.gap.contact_bench.joint_sizes import (
    joint_scales,
    log_range,
    nominal_joint,
    state_blocks,
)
from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    ContactQuantity,
    JointData,
)
from jointbench.analysis.gap.contact_bench.preload_law import (
    LinearisedLaw,
    PreloadLaw,
    linearised,
)
from jointbench.analysis.gap.contact_bench.value_residuals import (
    ValueResiduals,
    plain_residuals,
    value_residuals,
)
from jointbench.analysis.gap.model.diagnosis_record import View
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.bench_protocol import values_of
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Blocks, Fit
from jointbench.analysis.gap.residuals.noise_models import Noise
from jointbench.analysis.gap.residuals.scatter_record import no_scatter

_DAMPING_OF = {
    QUANTITIES.index(ContactQuantity.NORMAL_DAMPING): 0,
    QUANTITIES.index(ContactQuantity.TANGENTIAL_DAMPING): 1,
}


@dataclass(frozen=True, slots=True, eq=False)
class ContactBench:
    """Measured values of a joint with a contact law, as the engine uses them.

    Attributes:
        data: states, values and facts.
        law: the base, linearised.
        layout: base coordinates.
        entries: effects and probes by name and site word.
        candidates: the catalogue.
        probes: further shapes for directed tests.
        nominal: the joint before any fit: its nominal preloads, their median, the
            highest earlier ones, and the frequency of the vibration.
        values: what whitens the values.
        blocks: groups of rows: one for each state.
        scales: words to values.
        policy: thresholds for its fits.
    """

    data: JointData
    law: LinearisedLaw
    layout: ContactLayout
    entries: dict[str, ContactEffect]
    candidates: tuple[Candidate, ...]
    probes: tuple[Candidate, ...]
    nominal: LoadedJoint
    values: ValueResiduals
    blocks: Blocks
    scales: dict[str, float]
    policy: Policy = STANDARD

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
        """Bounds of the base coordinates, shape (n_base,) each."""
        reach = CONTACT.reach * self.layout.sd
        return -reach, reach

    @property
    def noise(self) -> Noise:
        """Noise of the values; assemblies and preloads are base parameters."""
        return Noise(np.ones((1, 1)), 0.0, no_scatter((), 1))

    @property
    def expanded(self) -> bool:
        """The model is never expanded about single values."""
        return False

    @property
    def stiffness_sd(self) -> FloatArray:
        """Empty: there are no hits."""
        return np.zeros(0)

    def at_stiffness(self, settling: FloatArray) -> "ContactBench":
        """Return the bench unchanged."""
        return self

    def phases(self, candidate: Candidate) -> int:
        """No effect fits a phase."""
        return 0

    def hints(self, fit: Fit, candidate: Candidate) -> list[FloatArray]:
        """No effect starts at peaks of the residual."""
        return []

    def scale(self, word: str) -> float:
        """Return the scale of a word [SI]."""
        return self.scales[word]

    def refine(
        self, base: FloatArray, terms: Sequence[Term], *, without: Sequence[int] = ()
    ) -> "ContactBench":
        """Return the bench with its law linearised at a solution.

        A base that has not found its effect yet may leave the range in which the law
        is defined, so the point is kept near the nominal inputs.
        """
        reach = CONTACT.law_reach * self.layout.sd[: self.layout.law]
        about = np.clip(base[: self.layout.law], -reach, reach)
        try:
            law = linearised(self.law.law, log_range(self.data), about.tolist())
        except BadData:
            return self
        return replace(self, law=law)

    def chosen(self, keep: BoolArray) -> "ContactBench":
        """Return the bench with some of its rows, (n_rows,); states remain."""
        rows = self.data.rows.chosen(keep)
        return replace(
            self,
            data=replace(self.data, rows=rows),
            values=value_residuals(rows),
            blocks=state_blocks(replace(self.data, rows=rows)),
        )

    def plain(self, keep: BoolArray) -> "ContactBench":
        """Return some rows with residuals that are logarithms, not whitened."""
        rows = self.data.rows.chosen(keep)
        seen = replace(rows, bound=np.zeros(rows.value.size, dtype=bool))
        return replace(
            self,
            data=replace(self.data, rows=seen),
            values=plain_residuals(seen),
        )

    def joint(self, base: FloatArray, terms: Sequence[Term]) -> LoadedJoint:
        """Return the joint in all its states, shape (6, n_states) of its table."""
        acts: list[list[tuple[ContactEffect, FloatArray]]] = [[] for _ in EffectPlace]
        for term in terms:
            entry = self.entries[term.candidate.label]
            acts[entry.place].append((entry, values_of(self, term)))
        layout, data = self.layout, self.data
        own = base[layout.state :][data.states.settings]
        log_p = self.nominal.log_preload + own
        if layout.nut >= 0:
            log_p = log_p - data.states.by_torque * base[layout.nut]
        joint = replace(self.nominal, law=self.law, log_preload=log_p)
        for entry, values in acts[EffectPlace.PRELOAD]:
            log_p = log_p + entry.act(values, joint)
        joint = replace(joint, log_preload=log_p)
        turn = sum(
            (entry.act(values, joint) for entry, values in acts[EffectPlace.LAW]),
            np.zeros(log_p.size),
        )
        joint = replace(joint, table=self._contact(base, joint, turn))
        for entry, values in acts[EffectPlace.STIFFNESS]:
            joint = replace(joint, table=entry.act(values, joint))
        joint = replace(joint, table=self._damped(base, joint))
        for entry, values in acts[EffectPlace.DAMPING]:
            joint = replace(joint, table=entry.act(values, joint))
        joint = replace(joint, table=self._bolted(base, joint))
        for entry, values in acts[EffectPlace.VALUE]:
            joint = replace(joint, table=joint.table * np.exp(entry.act(values, joint)))
        return joint

    def _contact(
        self, base: FloatArray, joint: LoadedJoint, turn: FloatArray
    ) -> FloatArray:
        """Return the stiffness of the contact alone, shape (6, n_states)."""
        layout, states = self.layout, self.data.states
        log_k = self.law.log_stiffness(joint.log_preload, base[: layout.law])
        turn = turn + base[layout.factor + 1] * (joint.log_preload - joint.middle)
        turn = turn + self._waves(base)
        common = turn + base[layout.factor] + base[layout.assembly + states.assembly]
        log_lever = 2.0 * np.log(self.data.facts.rocking_radius or 1.0)
        table = np.zeros((len(QUANTITIES), states.torque.size))
        needed = {0, *np.flatnonzero(layout.own[:4] >= 0)}
        needed |= {1} if layout.own[5] >= 0 else set()
        for row in range(4):
            if row not in needed:
                continue
            own = log_k[0 if row in (0, 3) else 1] + common
            if layout.ratio[row] >= 0:
                own = own + base[layout.ratio[row]]
            if layout.own[row] >= 0:
                own = own + base[layout.own[row] + states.assembly]
            table[row] = np.exp(own + (log_lever if row == 3 else 0.0))
        return table

    def _damped(self, base: FloatArray, joint: LoadedJoint) -> FloatArray:
        """Add the damping of the contact, loss factor times k/omega."""
        layout, table = self.layout, joint.table.copy()
        for row, stiffness in _DAMPING_OF.items():
            if layout.ratio[row] >= 0:
                own = (
                    base[layout.ratio[row]]
                    + base[layout.own[row] + self.data.states.assembly]
                )
                loss = CONTACT.loss_factor * np.exp(own)
                table[row] = loss * table[stiffness] / joint.omega
        return table

    def _waves(self, base: FloatArray) -> float:
        """Return the change of ln k by waves that the surfaces were too short to show.

        Until they close they are heights like all others.

        Source:
            Persson 2007, Phys. Rev. Lett. 99, 125502: k = p/u_0 with u_0 in proportion
            to the rms height of all wavelengths.
        """
        at, rough = self.layout.waves, self.law.law.roughness_alone
        if at < 0 or rough is None:
            return 0.0
        height = self.layout.nominal[at] * np.exp(base[at])
        return -0.5 * float(np.log1p((height / rough) ** 2))

    def _bolted(self, base: FloatArray, joint: LoadedJoint) -> FloatArray:
        """Add the bolts, in parallel with contact and bodies (VDI 2230, sec. 5.1)."""
        facts, at = self.data.facts, self.layout.bolts
        if at < 0 or facts.bolt_stiffness is None:
            return joint.table
        table, own = joint.table.copy(), facts.bolt_stiffness * np.exp(base[at])
        table[0] += own
        table[3] += own * (facts.bolt_radius or 0.0) ** 2
        return table

    def predict(self, base: FloatArray, terms: Sequence[Term]) -> FloatArray:
        """Return ln of each measured value as predicted, shape (n_rows,)."""
        table, rows = self.joint(base, terms).table, self.data.rows
        return np.asarray(np.log(np.maximum(table[rows.quantity, rows.state], 1e-300)))

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return the whitened residual; the resolution does not matter here."""
        raw = self.predict(base, terms) - self.data.rows.value
        return self.values.residual(raw)

    def slopes(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return d residual / d base, shape (n_rows, n_base).

        A coordinate of one state or assembly changes its own rows only, so that all of
        them are differenced at once.
        """
        layout, rows = self.layout, self.data.rows
        at, step = self.predict(base, terms), CONTACT.slope_step
        slopes = np.zeros((at.size, base.size))

        def moved(columns: FloatArray | list[int]) -> FloatArray:
            shifted = base.copy()
            shifted[np.asarray(columns, dtype=int)] += step
            return (self.predict(shifted, terms) - at) / step

        for k in range(layout.assembly):
            slopes[:, k] = moved([k])
        each = np.arange(at.size)
        assembly = self.data.states.assembly[rows.state]
        count = int(self.data.states.assembly.max()) + 1
        firsts = [layout.assembly, *layout.own[layout.own >= 0]]
        for first in firsts:
            change = moved(list(range(first, first + count)))
            slopes[each, first + assembly] = change
        change = moved(list(range(layout.state, base.size)))
        setting = self.data.states.settings[rows.state]
        slopes[each, layout.state + setting] = change
        return self.values.slopes(at - rows.value, slopes)

    def views(self, fit: Fit) -> tuple[View, ...]:
        """Return the residual of a fit by view."""
        return contact_views(self.data, fit.residual)


def make_contact_bench(
    data: JointData,
    law: PreloadLaw,
    *,
    without: frozenset[str] = frozenset(),
    policy: Policy = STANDARD,
) -> ContactBench:
    """Prepare measured values of a joint with a contact law for the engine.

    Args:
        data: states, values and facts.
        law: the base.
        without: names of effects to leave out of the catalogue.
        policy: thresholds for its fits.

    Raises:
        UsageError: `without` holds an unknown name.
        BadData: the law cannot be evaluated at these preloads.
    """
    catalogue, probes = contact_catalogue(data, without), contact_probes(data)
    if not any(p.per_cut for p in law.parameters):
        catalogue = tuple(e for e in catalogue if e.effect.name != "scale_cut")
    base_law = linearised(law, log_range(data))
    effects = [Candidate(e.effect, e.site) for e in (*catalogue, *probes)]
    entries = dict(zip((c.label for c in effects), (*catalogue, *probes), strict=True))
    return ContactBench(
        data=data,
        law=base_law,
        layout=contact_layout(data, law),
        entries=entries,
        candidates=tuple(effects[: len(catalogue)]),
        probes=tuple(effects[len(catalogue) :]),
        nominal=nominal_joint(data, base_law),
        values=value_residuals(data.rows),
        blocks=state_blocks(data),
        scales=joint_scales(data),
        policy=policy,
    )
