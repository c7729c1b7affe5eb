# SPDX-License-Identifier: MIT
"""Two nonlinear joints, for the forward response alone: a fixed set, and drawn ones.

In the fixed set specimen, hit and sizes are the same for all pairs of laws. For drawn
pairs specimen, laws and their sizes are drawn as for the simulated campaigns; level,
length and point of the hit are drawn as well.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from two_joints_maker import LAWS, scales_of

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.model.two_body_model import two_body_model
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.gap.response.excitation import (
    Excitation,
    prepare_excitation,
)
from jointbench.analysis.gap.response.predict_records import respond
from jointbench.analysis.gap.second_method.verify import second_response
from jointbench.analysis.lumped.lumped_model import LumpedModel
from jointbench.simulators.hidden.campaign_design import (
    NOMINAL_SIGMA,
    draw_design,
)
from jointbench.simulators.hidden.effect_draws import (
    Scales,
    draw_effect,
    resize_effect,
)

PAIRED = (*LAWS, "maxwell")
RUBBING = ("coulomb",)
STEPS = (8, 16, 64)
POINTS = {True: 64, False: 16}
"""Points of solve_ivp per sample, where dry friction jumps and otherwise."""
TOLERANCE = 1e-9
RATE, SAMPLES, TAIL = 16384.0, 288, 64
SIZES = (0.1, 1.0)
"""Share of the largest physical size of a law, log-uniform."""
LEVELS = (200.0, 1000.0)
"""Peak of the force [N], log-uniform."""
LENGTHS = (2.0e-4, 3.0e-4)
"""Standard deviation of the pulse, a Gaussian [s]."""
WIDTHS = (1e-3, 1e-2)
"""Speed over which dry friction changes its sign, over the largest speed."""


@dataclass(frozen=True, slots=True, eq=False)
class JointPair:
    """A hit on a specimen with a law at its foot and another one at its joint."""

    model: LumpedModel
    excitation: Excitation
    actions: tuple[Action, Action]

    @property
    def names(self) -> list[str]:
        """Names of the laws, that of the foot first."""
        return [action.entry.effect.name for action in self.actions]

    def response(self, steps: int, actions: Sequence[Action]) -> FloatArray:
        """Return the response by the engine at so many steps a sample."""
        nominal = self.model.nominal
        return respond(
            self.model, nominal, self.excitation, actions, oversampling=steps
        )

    def reference(self, finer: int = 1) -> FloatArray:
        """Return the response by solve_ivp, at a finer tolerance and more points."""
        return second_response(
            self.model,
            self.model.nominal,
            self.excitation,
            self.actions,
            tolerance=TOLERANCE / finer,
            points=POINTS[bool(set(self.names) & set(RUBBING))] * min(finer, 2),
        )

    def compared(self, *, checked: bool) -> dict[str, Any]:
        """Return the largest differences from solve_ivp over the peak of a channel.

        Args:
            checked: True to compare the reference with one of a tenth of its tolerance
                and twice its points as well.
        """
        expected = self.reference()
        peak = np.abs(expected).max(axis=-1, keepdims=True)

        def apart(found: FloatArray) -> float:
            return float(np.abs((found - expected)[..., :-TAIL] / peak).max())

        steps = {str(n): apart(self.response(n, self.actions)) for n in STEPS}
        first, second = ([action] for action in self.actions)
        both = self.response(16, first) + self.response(16, second)
        found = {"apart": steps, "serial": apart(both - self.response(16, []))}
        return found | {"reference": apart(self.reference(10))} if checked else found


def fixed_names() -> Iterator[str]:
    """Return every pair once; which of the two is at the foot alternates."""
    for i, first in enumerate(PAIRED):
        for j, second in enumerate(PAIRED[i:]):
            yield f"{first} {second}" if j % 2 == 0 else f"{second} {first}"


def fixed_pair(names: str) -> JointPair:
    """Return a pair of the fixed set."""
    nominal = {"m1": 8.0, "m2": 4.0, "k0": 2.4e7, "c0": 300.0, "kj": 6e7, "cj": 220.0}
    entries = {entry.name: entry for entry in CATALOGUE}
    # Stiffness, largest motion and speed of the foot and of the joint under that hit.
    links = ((2.4e7, 4.1e-5, 0.07), (6e7, 1.8e-5, 0.07))
    foot, joint = (
        Action(entries[name], "link", at, np.array(_values(*links[at])[name]))
        for at, name in enumerate(names.split())
    )
    excitation = _excitation(1000.0, 2.5e-4, 0.004, body=1)
    return JointPair(_model(nominal), excitation, (foot, joint))


def _values(k: float, travel: float, speed: float) -> dict[str, list[float]]:
    """Return parameters of a typical size at a link."""
    return {
        "cubic_stiffness": [0.3 * k / travel**2],
        "quadratic_stiffness": [0.3 * k / travel],
        "gap": [0.3 * k, 0.2 * travel],
        "jenkins": [0.3 * k, 0.2 * travel, 14.0],
        "iwan": [0.3 * k, 0.6 * travel, 0.5, 14.0],
        "bouc_wen": [0.3 * k, 0.3 * travel, 1.5, 1.8],
        "coulomb": [0.05 * k * travel, 0.003 * speed],
        "quadratic_damping": [0.6 * k * travel / speed],
        "maxwell": [0.3 * k, 8e-4],
    }


def draw_pair(seed: int) -> JointPair:
    """Draw a specimen, two laws and a hit."""
    rng = np.random.default_rng([seed, 29])
    design = draw_design(seed, grid="middle", noise=0.1)
    entries = {entry.name: entry for entry in CATALOGUE}
    names = [str(name) for name in rng.choice(PAIRED, size=2)]
    foot, joint = (
        Action(entries[name], "link", at, np.array(_drawn(name, scales, rng)))
        for at, (name, scales) in enumerate(zip(names, scales_of(design), strict=True))
    )
    return JointPair(_model(design.physical), _hit(rng), (foot, joint))


def _model(physical: Mapping[str, float]) -> LumpedModel:
    model = two_body_model(physical, NOMINAL_SIGMA)
    foot, joint = model.links
    return replace(model, links=(replace(foot, joint=True), joint))


def _hit(rng: np.random.Generator) -> Excitation:
    level, length = (float(np.exp(rng.uniform(*np.log(x)))) for x in (LEVELS, LENGTHS))
    start = 0.004 + rng.uniform(0.0, 1.0) / RATE
    return _excitation(level, length, start, body=int(rng.integers(2)))


def _excitation(level: float, length: float, start: float, *, body: int) -> Excitation:
    time = np.arange(SAMPLES) / RATE
    force = level * np.exp(-0.5 * ((time - start) / length) ** 2)
    conditions = HitConditions(np.ones(1), np.zeros(1))
    return prepare_excitation(force[None, :], np.array([body]), RATE, conditions)


def _drawn(name: str, scales: Scales, rng: np.random.Generator) -> list[float]:
    """Return parameters in the order of the catalogue."""
    share = float(np.exp(rng.uniform(*np.log(SIZES))))
    p = resize_effect(draw_effect(name, scales, rng), share).parameters
    width = scales.rate * float(np.exp(rng.uniform(*np.log(WIDTHS))))
    if name == "coulomb":
        return [p["Fc"], width]
    if name == "jenkins":
        return [p["kt"], p["Fs"] / p["kt"], p["sharpness"]]
    if name == "iwan":
        return [p["kt"], p["phimax"], p["chi"] + 2.0, p["sharpness"]]
    if name == "bouc_wen":
        loading = p["b"] + p["g"]
        slip = p["zy"] * loading ** (-1.0 / p["n"])
        return [p["k"], slip, p["n"], (p["b"] - p["g"]) / loading]
    return list(p.values())
