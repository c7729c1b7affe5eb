# SPDX-License-Identifier: MIT
"""Hits on two blocks whose joint has the stiffness of its own bolted surfaces."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.simulators.bolted_faces.bolted_faces import (
    BoltedFaces,
    FaceDesign,
    JointStiffness,
)
from jointbench.simulators.bolted_faces.rough_layer import random_face, rough_layer
from jointbench.simulators.campaigns.campaign_records import SimulatedCampaign, noisy
from jointbench.simulators.hidden.campaign_design import (
    CampaignCondition,
    CampaignDesign,
    pulse_of,
)
from jointbench.simulators.hidden.campaign_response import simulate_records
from jointbench.simulators.hidden.hidden_effects import HiddenEffect

TORQUES = (2.0, 3.5, 6.0, 10.0, 16.0, 24.0)
"""On each bolt [N m], ascending."""
_HITS = (
    (1, 30.0),
    (1, 200.0),
    (1, 1000.0),
    (1, 200.0),
    (0, 200.0),
    (0, 1000.0),
)
"""Struck body and level [N] at each torque; one condition is there twice."""
_FACE_POINTS = 256
FACE_SPACING = 2e-6
"""Of the maps of the roughness of one surface [m]."""
_FACE_RMS = 0.6e-6
"""Rms height of the roughness of one surface [m]."""
_LONGEST = 80e-6
"""Wavelength beyond which the roughness of a surface is level [m]."""
_COARSER = 2
"""Points of a map over those of the boundary elements, along a side."""
_PRESSURES = (2e5, 8e8, 12)
"""Least and largest pressure of the roughness [Pa], and how many."""
_WRENCH = 0.03
"""Relative sd of the preload from one tightening to the next [-]."""
_SCATTER = 0.001
_NOISE = 0.05
"""Of each acceleration [m/s^2]."""
_NOMINAL = {
    "m1": 60.0,
    "m2": 40.0,
    "k0": 1.6e8,
    "c0": 6.0e3,
    "kj": 1.0e9,
    "cj": 6.0e3,
}
_REFERENCE = 10.0
"""Torque that the nominal joint belongs to [N m]."""


@dataclass(frozen=True, slots=True, eq=False)
class JointCampaign:
    """Two blocks on a bolted joint: surfaces, hits and truth.

    Attributes:
        surfaces: design of bodies, bolts and waviness.
        heights: roughness of the lower and the upper surface [m], (2, n, n).
        stiffness: of the joint at each torque, cause by cause, without scatter.
        campaign: the hits.
    """

    surfaces: FaceDesign
    heights: FloatArray
    stiffness: tuple[JointStiffness, ...]
    campaign: SimulatedCampaign

    def __post_init__(self) -> None:
        """Make the array read-only."""
        freeze(self, "heights")


@dataclass(frozen=True, slots=True, eq=False)
class TightenedJoint:
    """A joint at each torque, before anything is struck.

    Attributes:
        surfaces: design of bodies, bolts and waviness.
        heights: roughness of the lower and the upper surface [m], (2, n, n).
        stiffness: at each torque, cause by cause, without scatter.
        scattered: of the joint as it was tightened [N/m], shape (n_torques,).
    """

    surfaces: FaceDesign
    heights: FloatArray
    stiffness: tuple[JointStiffness, ...]
    scattered: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "heights", "scattered")


def joint_campaign(
    seed: int, *, effects: tuple[HiddenEffect, ...] = ()
) -> JointCampaign:
    """Simulate surfaces, joint and hits at six torques.

    Args:
        seed: of surfaces, bodies and hits.
        effects: hidden in the structure.
    """
    rng = np.random.default_rng([seed, 43])
    made = pressed_joint(seed, rng)
    campaign = _hits(seed, rng, made.scattered, effects)
    return JointCampaign(made.surfaces, made.heights, made.stiffness, campaign)


def pressed_joint(
    seed: int, rng: np.random.Generator, rms: float = _FACE_RMS
) -> TightenedJoint:
    """Press two ground surfaces together at six torques.

    Args:
        seed: of the surfaces.
        rng: of sizes and torques.
        rms: height of the roughness of one surface [m].
    """
    design = FaceDesign(
        side=0.080,
        thickness=0.012,
        bolt_place=0.026,
        wave_height=float(np.exp(rng.uniform(np.log(2e-6), np.log(5e-6)))),
        wave_lengths=(0.006, 0.020),
        nut_factor=float(0.2 * np.exp(0.1 * rng.standard_normal())),
        seed=seed,
    )
    heights = ground_surfaces(seed, rms)
    both = heights.sum(axis=0)[::_COARSER, ::_COARSER]
    pressures = np.geomspace(*_PRESSURES[:2], int(_PRESSURES[2]))
    layer = rough_layer(both, _COARSER * FACE_SPACING, design.modulus, pressures)
    bolted = BoltedFaces(design, layer)
    clean = tuple(bolted.stiffness(design.preload(torque)) for torque in TORQUES)
    scattered = [
        bolted.stiffness(
            design.preload(torque) * float(np.exp(_WRENCH * rng.standard_normal()))
        ).bolted
        for torque in TORQUES
    ]
    return TightenedJoint(design, heights, clean, np.array(scattered))


def ground_surfaces(seed: int, rms: float = _FACE_RMS) -> FloatArray:
    """Return the roughness of the lower and the upper surface [m], shape (2, n, n).

    Args:
        seed: of the campaign.
        rms: height of each [m].
    """
    return np.stack(
        [
            random_face(_FACE_POINTS, FACE_SPACING, rms, _LONGEST, 2 * seed + k)
            for k in (0, 1)
        ]
    )


def nominal_preload(torque: float) -> float:
    """Return the preload by the nominal nut factor 0.2 [N] at a torque [N m]."""
    return replace(FaceDesign(), nut_factor=0.2).preload(torque)


def _hits(
    seed: int,
    rng: np.random.Generator,
    stiffness: FloatArray,
    effects: tuple[HiddenEffect, ...],
) -> SimulatedCampaign:
    """Strike the blocks at every torque."""
    sd = {"m1": 1e-3, "m2": 1e-3, "k0": 0.05, "c0": 0.2, "cj": 0.3}
    physical = {
        name: value * float(np.exp(sd.get(name, 0.0) * rng.standard_normal()))
        for name, value in _NOMINAL.items()
    }
    last = len(TORQUES) * len(_HITS) - 1
    conditions = tuple(
        CampaignCondition(
            level=level,
            hit_dof=body,
            preload=nominal_preload(torque),
            preload_ratio=torque / _REFERENCE,
            order=k * len(_HITS) + i,
            progress=(k * len(_HITS) + i) / last,
            pulse=pulse_of(level, rng),
            force_factor=1 + _SCATTER * float(rng.standard_normal()),
            joint_factor=float(stiffness[k] / physical["kj"])
            * (1 + _SCATTER * float(rng.standard_normal())),
            phase=float(rng.uniform(0, 2 * np.pi)),
        )
        for k, torque in enumerate(TORQUES)
        for i, (body, level) in enumerate(_HITS)
    )
    design = CampaignDesign(
        seed=seed,
        nominal=_NOMINAL,
        physical=physical,
        preload_reference=nominal_preload(_REFERENCE),
        noise=_NOISE,
        hit_scatter=_SCATTER,
        conditions=conditions,
    )
    force, acceleration = noisy(design, *simulate_records(design, effects))
    return SimulatedCampaign(design, effects, (), force, acceleration)
