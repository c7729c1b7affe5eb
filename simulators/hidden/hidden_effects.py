# SPDX-License-Identifier: MIT
"""Changes of the specimen by hidden effects, by name."""

import difflib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.hidden.campaign_design import CampaignCondition
from jointbench.simulators.hidden.campaign_sampling import SAMPLE_RATE, SAMPLES
from jointbench.simulators.hidden.sensor_faults import (
    ALL_CHANNELS,
    SENSOR_FAULTS,
    Parameters,
)
from jointbench.simulators.mechanics.joint_laws import JointLaw, LawKind
from jointbench.simulators.mechanics.plant import GROUND, Plant, PlantLink
from jointbench.simulators.mechanics.sliders import iwan_bank, jenkins_bank

_TOP, _BASE = 1, 0
_JOINT = 1  # index of the joint among the links
_Change = Callable[[Plant, Parameters, CampaignCondition], Plant]


@dataclass(frozen=True, slots=True)
class HiddenEffect:
    """An effect that the nominal model of a campaign lacks.

    Attributes:
        name: as in the catalogue of campaigns.
        parameters: by name, SI units; `dof` is its body or channel, `ALL_CHANNELS`
            for a fault that all channels share.
    """

    name: str
    parameters: Mapping[str, float]

    def __post_init__(self) -> None:
        """Refuse unknown names."""
        if self.name not in MECHANICS and self.name not in SENSOR_FAULTS:
            known = sorted((*MECHANICS, *SENSOR_FAULTS))
            near = difflib.get_close_matches(self.name, known, n=3)
            raise UsageError(
                f"unknown effect {self.name!r}; "
                + (f"did you mean {' or '.join(near)}?" if near else ", ".join(known))
            )

    @property
    def site(self) -> str:
        """Site of the effect: a link, a body or a channel."""
        shared = self.parameters.get("dof") == ALL_CHANNELS
        if shared or self.name in {"saturation", "clock_drift"}:
            return "channel:all"
        dof = int(self.parameters.get("dof", 0))
        if self.name in SENSOR_FAULTS:
            return f"channel:a{dof}"
        if self.name == "extra_damping":
            return "body:m2"
        if self.name in {"added_mass", "hidden_mode", "rattling_mass"}:
            return f"body:m{dof + 1}"
        return "link:ground" if self.name == "preload_ground" else "link:joint"


def change_plant(
    plant: Plant, effect: HiddenEffect, condition: CampaignCondition
) -> Plant:
    """Add an effect to the plant; a sensor fault does not change it."""
    change = MECHANICS.get(effect.name)
    return plant if change is None else change(plant, effect.parameters, condition)


def _law(plant: Plant, kind: LawKind, *parameters: float) -> Plant:
    law = JointLaw(kind, _BASE, _TOP, parameters)
    return replace(plant, laws=(*plant.laws, law))


def _scale(
    plant: Plant, stiffness: float, damping: float = 1.0, *, link: int = _JOINT
) -> Plant:
    links = list(plant.links)
    links[link] = replace(
        links[link],
        stiffness=links[link].stiffness * stiffness,
        damping=links[link].damping * damping,
    )
    return replace(plant, links=tuple(links))


def _take(plant: Plant, stiffness: float) -> Plant:
    """Reduce the spring of the joint by the stiffness of the sliders."""
    own = plant.links[_JOINT].stiffness
    return _scale(plant, (own - stiffness) / own)


def _jenkins(plant: Plant, p: Parameters, _: CampaignCondition) -> Plant:
    bank = jenkins_bank(kt=p["kt"], slip_force=p["Fs"], sharpness=p["sharpness"])
    law = JointLaw(LawKind.SLIDERS, _BASE, _TOP, sliders=bank)
    return _take(replace(plant, laws=(*plant.laws, law)), p["kt"])


def _iwan(plant: Plant, p: Parameters, _: CampaignCondition) -> Plant:
    bank = iwan_bank(
        kt=p["kt"],
        phimax=p["phimax"],
        chi=p["chi"],
        sharpness=p["sharpness"],
        count=int(p["sliders"]),
    )
    law = JointLaw(LawKind.SLIDERS, _BASE, _TOP, sliders=bank)
    return _take(replace(plant, laws=(*plant.laws, law)), p["kt"])


def _bouc_wen(plant: Plant, p: Parameters, _: CampaignCondition) -> Plant:
    numbers = (p["k"], p["n"], p["b"], p["g"], p["zy"])
    return _take(_law(plant, LawKind.BOUC_WEN, *numbers), p["k"])


def _added_mass(plant: Plant, p: Parameters, _: CampaignCondition) -> Plant:
    masses = list(plant.masses)
    masses[int(p["dof"])] += p["m"]
    return replace(plant, masses=tuple(masses))


def _hidden_mode(plant: Plant, p: Parameters, _: CampaignCondition) -> Plant:
    link = PlantLink(int(p["dof"]), len(plant.masses), p["k"], p["c"])
    return replace(plant, masses=(*plant.masses, p["m"]), links=(*plant.links, link))


def _extra_damping(plant: Plant, p: Parameters, _: CampaignCondition) -> Plant:
    return replace(plant, links=(*plant.links, PlantLink(GROUND, _TOP, 0.0, p["c"])))


def _rattling_mass(plant: Plant, p: Parameters, _: CampaignCondition) -> Plant:
    """Add a loose part in a slot; a weak spring at 20 Hz keeps it centred."""
    body, dof = len(plant.masses), int(p["dof"])
    weak = p["m"] * (2 * np.pi * 20) ** 2
    link = PlantLink(dof, body, weak, 0.1 * weak / (2 * np.pi * 20))
    slot = JointLaw(LawKind.SLOT, dof, body, (p["k"], p["g"]))
    return Plant((*plant.masses, p["m"]), (*plant.links, link), (*plant.laws, slot))


def _coulomb(plant: Plant, p: Parameters, _: CampaignCondition) -> Plant:
    # The stick velocity is far below every measured velocity, and the reduced mass of
    # the joint, at least 2 kg, is within the stability of the stepper.
    stick = max(2e-5, p["Fc"] / (2.0 * 2e5))
    return _law(plant, LawKind.COULOMB, p["Fc"], stick)


def _drift(plant: Plant, p: Parameters, _: CampaignCondition) -> Plant:
    stiffness = p["frac"] * plant.links[_JOINT].stiffness
    return _law(plant, LawKind.DRIFT, stiffness, SAMPLES / SAMPLE_RATE)


MECHANICS: Mapping[str, _Change] = {
    "cubic_stiffness": lambda m, p, _: _law(m, LawKind.ODD_POWER, p["k3"], 3.0),
    "quadratic_stiffness": lambda m, p, _: _law(m, LawKind.SQUARE, p["k2"]),
    "gap": lambda m, p, _: _law(m, LawKind.STOP, p["k"], p["g"]),
    "jenkins": _jenkins,
    "iwan": _iwan,
    "bouc_wen": _bouc_wen,
    "coulomb": _coulomb,
    "quadratic_damping": lambda m, p, _: _law(m, LawKind.SQUARE_DAMPING, p["c"]),
    "maxwell": lambda m, p, _: _law(m, LawKind.MAXWELL, p["k"], p["tau"]),
    "extra_damping": _extra_damping,
    "added_mass": _added_mass,
    "hidden_mode": _hidden_mode,
    "preload_stiffness": lambda m, p, c: _scale(m, c.preload_ratio ** p["n"]),
    "preload_damping": lambda m, p, c: _scale(m, 1.0, c.preload_ratio ** p["n"]),
    "loosening": lambda m, p, c: _scale(m, 1 - p["frac"] * c.progress),
    # Outside the catalogue.
    "quintic_stiffness": lambda m, p, _: _law(m, LawKind.ODD_POWER, p["k5"], 5.0),
    "root_stiffness": lambda m, p, _: _law(m, LawKind.ROOT, p["k"], p["e"]),
    "time_varying_stiffness": _drift,
    "rattling_mass": _rattling_mass,
    "dead_zone_damping": lambda m, p, _: _law(
        m, LawKind.DEAD_ZONE_DAMPING, p["c"], p["g"]
    ),
    "thermal_drift": lambda m, p, c: _scale(m, 1 + p["frac"] * c.progress**2),
    "preload_ground": lambda m, p, c: _scale(m, c.preload_ratio ** p["n"], link=0),
}
