# SPDX-License-Identifier: MIT
"""The contact bench: stiffness and damping of a joint over preload, for the engine.

It has the interface of every bench, so that directed tests, descent, scores and rivals
are those of the one engine. A base of a contact law with priors predicts the logarithm
of each value; effects act on the way from the torque to that value.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
import scipy.special

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.contact_bench.contact_catalogue import contact_catalogue
from jointbench.analysis.gap.contact_bench.contact_damping import contact_probes
from jointbench.analysis.gap.contact_bench.contact_effect import (
    ContactEffect,
    LoadedJoint,
    Stage,
)
from jointbench.analysis.gap.contact_bench.contact_layout import (
    ContactLayout,
    contact_layout,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.contact_views import contact_views
from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    ContactQuantity,
    JointData,
    JointRows,
)
from jointbench.analysis.gap.contact_bench.preload_law import (
    LinearisedLaw,
    PreloadLaw,
    linearised,
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
        omega: angular frequency of the vibration [rad/s], shape (n_states,).
        whitener: inverse root of the covariance, 0 for values known from below,
            shape (n_rows, n_rows).
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
    omega: FloatArray
    whitener: FloatArray
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
        """Return the bench with its law linearised at a solution."""
        about = tuple(float(v) for v in base[: self.layout.law])
        return replace(self, law=linearised(self.law.law, _range(self.data), about))

    def chosen(self, keep: BoolArray) -> "ContactBench":
        """Return the bench with some of its rows, (n_rows,); states remain."""
        rows = self.data.rows.chosen(keep)
        return replace(
            self,
            data=replace(self.data, rows=rows),
            whitener=_whitener(rows),
            blocks=_blocks(replace(self.data, rows=rows)),
        )

    def plain(self, keep: BoolArray) -> "ContactBench":
        """Return some rows with residuals that are logarithms, not whitened."""
        rows = self.data.rows.chosen(keep)
        seen = replace(rows, bound=np.zeros(rows.value.size, dtype=bool))
        return replace(
            self,
            data=replace(self.data, rows=seen),
            whitener=np.eye(rows.value.size),
        )

    def joint(self, base: FloatArray, terms: Sequence[Term]) -> LoadedJoint:
        """Return the joint in all its states, shape (6, n_states) of its table."""
        acts: list[list[tuple[ContactEffect, FloatArray]]] = [[] for _ in Stage]
        for term in terms:
            entry = self.entries[term.candidate.label]
            acts[entry.stage].append((entry, values_of(self, term)))
        layout, data = self.layout, self.data
        log_p = data.nominal_log_preload + base[layout.state :]
        if layout.nut >= 0:
            log_p = log_p - data.states.by_torque * base[layout.nut]
        joint = LoadedJoint(
            data, self.law, log_p, data.log_overload, self.omega, np.zeros((6, 1))
        )
        for entry, values in acts[Stage.PRELOAD]:
            log_p = log_p + entry.act(values, joint)
        joint = replace(joint, log_preload=log_p)
        turn = sum(
            (entry.act(values, joint) for entry, values in acts[Stage.LAW]),
            np.zeros(log_p.size),
        )
        joint = replace(joint, table=self._contact(base, joint, turn))
        for entry, values in acts[Stage.STIFFNESS]:
            joint = replace(joint, table=entry.act(values, joint))
        joint = replace(joint, table=self._damped(base, joint))
        for entry, values in acts[Stage.DAMPING]:
            joint = replace(joint, table=entry.act(values, joint))
        for entry, values in acts[Stage.VALUE]:
            joint = replace(joint, table=joint.table * np.exp(entry.act(values, joint)))
        return joint

    def _contact(
        self, base: FloatArray, joint: LoadedJoint, turn: FloatArray
    ) -> FloatArray:
        """Return the stiffness of the contact alone, shape (6, n_states)."""
        layout, states = self.layout, self.data.states
        log_k = self.law.log_stiffness(joint.log_preload, base[: layout.law])
        middle = np.median(self.data.nominal_log_preload)
        turn = turn + base[layout.factor + 1] * (joint.log_preload - middle)
        common = turn + base[layout.factor] + base[layout.assembly + states.assembly]
        log_lever = 2.0 * np.log(self.data.facts.rocking_radius or 1.0)
        table = np.zeros((len(QUANTITIES), states.torque.size))
        for row in range(4):
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

    def predict(self, base: FloatArray, terms: Sequence[Term]) -> FloatArray:
        """Return ln of each measured value as predicted, shape (n_rows,)."""
        table, rows = self.joint(base, terms).table, self.data.rows
        return np.asarray(np.log(np.maximum(table[rows.quantity, rows.state], 1e-300)))

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return the whitened residual; the resolution does not matter here."""
        raw = self.predict(base, terms) - self.data.rows.value
        found = self.whitener @ raw
        bound = self.data.rows.bound
        if bound.any():
            found[bound] = _from_below(self._beyond(raw)[bound])
        return np.asarray(found)

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
        slopes[each, layout.state + rows.state] = change
        found = self.whitener @ slopes
        bound = rows.bound
        if bound.any():
            z = self._beyond(at - rows.value)[bound]
            down = -_from_below_slope(z) / self._bound_sd()[bound]
            found[bound] = -down[:, None] * slopes[bound]
        return np.asarray(found)

    def _bound_sd(self) -> FloatArray:
        own = np.sqrt(np.diag(self.data.rows.covariance))
        return np.asarray(np.hypot(own, CONTACT.bound_sd))

    def _beyond(self, raw: FloatArray) -> FloatArray:
        """Return how far a prediction lies above a lower bound [sd]."""
        return np.asarray(raw / self._bound_sd() + CONTACT.bound_z)

    def views(self, fit: Fit) -> tuple[View, ...]:
        """Return the residual of a fit by view."""
        return contact_views(self.data, fit.residual)


def _from_below(z: FloatArray) -> FloatArray:
    """Return the root of -2 ln Phi(z): a bound that is exceeded costs nothing."""
    return np.asarray(np.sqrt(-2.0 * scipy.special.log_ndtr(z)))


def _from_below_slope(z: FloatArray) -> FloatArray:
    """Return d/dz of that root, negative."""
    log_phi = scipy.special.log_ndtr(z)
    density = -0.5 * z**2 - 0.5 * np.log(2.0 * np.pi)
    root = np.sqrt(-2.0 * log_phi)
    return np.asarray(-np.exp(density - log_phi) / np.maximum(root, 1e-12))


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
    effects = [Candidate(e.effect, e.site) for e in (*catalogue, *probes)]
    entries = dict(zip((c.label for c in effects), (*catalogue, *probes), strict=True))
    return ContactBench(
        data=data,
        law=linearised(law, _range(data)),
        layout=contact_layout(data, law.parameters),
        entries=entries,
        candidates=tuple(effects[: len(catalogue)]),
        probes=tuple(effects[len(catalogue) :]),
        omega=_omega(data),
        whitener=_whitener(data.rows),
        blocks=_blocks(data),
        scales=_scales(data),
        policy=policy,
    )


def _range(data: JointData) -> tuple[float, float]:
    log_p = data.nominal_log_preload
    return float(log_p.min()), float(log_p.max())


def _whitener(rows: JointRows) -> FloatArray:
    """Return the inverse root of the covariance, 0 where only a bound is known."""
    found = np.zeros_like(rows.covariance)
    seen = np.flatnonzero(~rows.bound)
    root = np.linalg.cholesky(rows.covariance[np.ix_(seen, seen)])
    inverse = scipy.linalg.solve_triangular(root, np.eye(seen.size), lower=True)
    found[np.ix_(seen, seen)] = inverse
    return found


def _blocks(data: JointData) -> Blocks:
    states, rows = data.states, data.rows
    unit = "N" if np.isnan(states.torque).all() else "N m"
    labels = tuple(
        {
            "torque": f"{level:.4g} {unit}",
            "branch": "falling" if falling else "rising",
            "assembly": f"{j + 1}",
        }
        for level, falling, j in zip(
            states.level, states.falling, states.assembly, strict=True
        )
    )
    seen = int((~rows.bound).sum())
    return Blocks(rows.state, labels, seen, (len(rows.value), 1, 1), white=True)


def _omega(data: JointData) -> FloatArray:
    """Return the angular frequency; where it is unknown, one that fits the median."""
    omega, rows = 2.0 * np.pi * data.states.frequency, data.rows
    damped = rows.quantity >= 4
    if not damped.any():
        return np.ones(omega.size)
    stiff = rows.quantity < 4
    ratio = np.median(rows.value[stiff]) - np.median(rows.value[damped])
    return np.where(np.isnan(omega), CONTACT.loss_factor * np.exp(ratio), omega)


def _scales(data: JointData) -> dict[str, float]:
    """Return characteristic sizes, which scale starts and bounds of effects."""
    rows, states = data.rows, data.states
    first = rows.quantity == rows.quantity.min()
    stiffness = np.exp(rows.value[first])
    preload = np.exp(data.nominal_log_preload)
    shear = np.where(np.isnan(states.shear), 1.0, states.shear)
    torque = states.torque[states.by_torque]
    found = {
        "one": 1.0,
        # A total compliance cannot exceed that of the stiffest state.
        "compliance": 1.0 / float(stiffness.max()),
        "least_stiffness": float(stiffness.min()),
        "highest": float(preload.max()),
        "least_torque": float(torque.min()) if torque.size else 1.0,
        "slip": float((preload / shear).min()),
        "loss": CONTACT.loss_factor,
    }
    for row, name in ((4, "normal"), (5, "tangential")):
        own = np.exp(rows.value[rows.quantity == row])
        found[f"damping_{name}"] = float(own.min()) if own.size else 1.0
    return found
