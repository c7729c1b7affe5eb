# SPDX-License-Identifier: MIT
"""How what was named moves every later quantity: stiffness, modes, responses.

Each state is predicted from all others: the joint's stiffness from the contact law and
the effects, then modes, FRF and ring-down of the structure with that stiffness.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.analysis.gap.chain.chain_diagnosis import ChainDiagnosis
from jointbench.analysis.gap.chain.chain_settings import CHAIN
from jointbench.analysis.gap.chain.lumped_structure import FittedState, LumpedStructure
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.lumped.lumped_model import LumpedModel
from jointbench.analysis.lumped.lumped_modes import solve_modes


@dataclass(frozen=True, slots=True, eq=False)
class MovedStiffness:
    """Stiffness of the joint in each state.

    Attributes:
        preload: by the nominal nut factor [N], shape (n_states,).
        measured: by the structure [N/m], same shape.
        measured_sd: of its logarithm [-].
        before: by the law of the surfaces with nominal inputs [N/m].
        after: predicted from the other states with what was named [N/m].
        after_sd: of ln(measured / predicted) [-].
    """

    preload: FloatArray
    measured: FloatArray
    measured_sd: FloatArray
    before: FloatArray
    after: FloatArray
    after_sd: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "preload", "measured", "measured_sd", "before", "after")
        freeze(self, "after_sd")

    @property
    def inside(self) -> float:
        """Share of the states within the 95 % interval of their prediction [-]."""
        off = np.abs(np.log(self.measured / self.after))
        return float(np.mean(off <= CONTACT.interval_z * self.after_sd))


@dataclass(frozen=True, slots=True, eq=False)
class MovedModes:
    """Natural frequencies [Hz] of one state: measured, before, after."""

    preload: float
    measured: FloatArray
    before: FloatArray
    after: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "measured", "before", "after")


@dataclass(frozen=True, slots=True, eq=False)
class MovedResponse:
    """FRF and ring-down at one channel after hits on one body, in one state.

    Attributes:
        preload: of the state [N].
        body: that was hit.
        channel: that responded.
        frequency: [Hz], shape (n_lines,).
        measured: FRF, same shape.
        before: by the law of the surfaces.
        after: with what was named.
        time: of the ring-down [s], shape (n_samples,).
        ring_down: measured, before and after, shape (3, n_samples).
    """

    preload: float
    body: str
    channel: str
    frequency: FloatArray
    measured: ComplexArray
    before: ComplexArray
    after: ComplexArray
    time: FloatArray
    ring_down: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "measured", "before", "after", "time", "ring_down")

    @property
    def errors(self) -> tuple[float, float]:
        """Residual over response of the ring-down, rms, before and after [-]."""
        size = float(np.sqrt(np.mean(self.ring_down[0] ** 2)))
        off = np.sqrt(np.mean((self.ring_down[1:] - self.ring_down[0]) ** 2, axis=1))
        return float(off[0] / size), float(off[1] / size)


def moved_stiffness(found: ChainDiagnosis) -> MovedStiffness:
    """Return the stiffness of every state as measured and as predicted.

    Args:
        found: diagnosis of the chain.
    """
    contact, chain = found.contact, found.chain
    surface = chain.surface
    log_p = contact.bench.nominal.log_preload
    nominal = surface.law.log_stiffness(log_p, np.zeros(len(surface.law.parameters)))
    row = 0 if int(contact.bench.data.rows.quantity[0]) == 0 else 1
    held = found.joint.after
    return MovedStiffness(
        preload=chain.states.preload,
        measured=np.exp(chain.reading.log_stiffness),
        measured_sd=np.sqrt(np.diag(chain.reading.covariance)),
        before=np.exp(nominal[row]),
        after=np.exp(held.predicted),
        after_sd=held.sd,
    )


def moved_modes(
    structure: LumpedStructure, stiffness: MovedStiffness
) -> tuple[MovedModes, ...]:
    """Return the natural frequencies of every state.

    Args:
        structure: hits and fits.
        stiffness: of the joint.
    """
    found = []
    for k, state in enumerate(structure.states):
        at = structure.link
        plain, own = _model(state, state.before.base), _model(state, state.best.base)
        found.append(
            MovedModes(
                float(stiffness.preload[k]),
                solve_modes(own).natural_frequency,
                _frequencies(plain, at, float(stiffness.before[k])),
                _frequencies(own, at, float(stiffness.after[k])),
            )
        )
    return tuple(found)


def _model(state: FittedState, base: FloatArray) -> LumpedModel:
    """Return the lumped model with fitted values."""
    model = state.bench.campaign.model
    n, m = len(model.bodies), len(model.links)
    theta = model.nominal * np.exp(base)
    return replace(
        model,
        bodies=tuple(
            replace(b, mass=float(v)) for b, v in zip(model.bodies, theta, strict=False)
        ),
        links=tuple(
            replace(x, stiffness=float(k), damping=float(c))
            for x, k, c in zip(
                model.links, theta[n : n + m], theta[n + m :], strict=True
            )
        ),
    )


def _frequencies(model: LumpedModel, link: int, stiffness: float) -> FloatArray:
    links = list(model.links)
    links[link] = replace(links[link], stiffness=stiffness)
    return solve_modes(replace(model, links=tuple(links))).natural_frequency


def moved_response(
    structure: LumpedStructure, stiffness: MovedStiffness, state: int
) -> MovedResponse:
    """Return FRF and ring-down of one state at the body that was hit most.

    Args:
        structure: hits and fits.
        stiffness: of the joint.
        state: index of the state.
    """
    one = structure.states[state]
    campaign = one.bench.campaign
    hit = int(np.bincount(campaign.hit).argmax())
    own = np.flatnonzero(campaign.hit == hit)
    body = campaign.model.bodies[hit].name
    channels = [c.body for c in campaign.model.channels]
    row = channels.index(body) if body in channels else 0
    at = len(campaign.model.bodies) + structure.link
    nominal = campaign.model.links[structure.link].stiffness
    predicted = []
    pairs = ((one.before, stiffness.before[state]), (one.best, stiffness.after[state]))
    for fit, value in pairs:
        base = fit.base.copy()
        base[at] = np.log(value / nominal)
        predicted.append(one.bench.response(base, fit.terms)[own, row])
    records = [campaign.response[own, row], *predicted]
    force = campaign.force[own]
    loudest = int(np.argmax(np.abs(force).max(axis=1)))
    frequency, (seen, law, named) = _frfs(force, records, campaign.sample_rate)
    return MovedResponse(
        float(stiffness.preload[state]),
        body,
        campaign.model.channels[row].name,
        frequency,
        seen,
        law,
        named,
        np.arange(force.shape[1]) / campaign.sample_rate,
        np.stack([r[loudest] for r in records]),
    )


def _frfs(
    force: FloatArray, records: Sequence[FloatArray], sample_rate: float
) -> tuple[FloatArray, list[ComplexArray]]:
    """Return H1 of measured and predicted records with the same forces."""
    spectrum = np.fft.rfft(force, axis=1)
    power = np.sum(np.abs(spectrum) ** 2, axis=0)
    frequency = np.fft.rfftfreq(force.shape[1], 1.0 / sample_rate)
    seen = (power > CHAIN.least_force**2 * power.max()) & (frequency > 0)
    frfs = [
        np.asarray(
            np.sum(np.fft.rfft(r, axis=1) * spectrum.conj(), axis=0)[seen] / power[seen]
        )
        for r in records
    ]
    return frequency[seen], frfs
