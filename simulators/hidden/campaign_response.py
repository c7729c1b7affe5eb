# SPDX-License-Identifier: MIT
"""The noise-free records of a campaign: plant, sensors, filter, samples."""

from collections.abc import Mapping, Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.hidden.campaign_design import (
    CampaignCondition,
    CampaignDesign,
)
from jointbench.simulators.hidden.campaign_sampling import SAMPLE_RATE, SAMPLES
from jointbench.simulators.hidden.hidden_effects import HiddenEffect, change_plant
from jointbench.simulators.hidden.sensor_faults import clip_samples, distort_signals
from jointbench.simulators.measuring.converter import AntiAlias, decimate
from jointbench.simulators.measuring.hammer import pulse_force
from jointbench.simulators.mechanics.plant import two_bodies
from jointbench.simulators.mechanics.plant_integration import step_plant

# Pass band 0.42 of the sample rate, as of a sigma-delta converter.
CONVERTER = AntiAlias(
    oversampling=16, pass_band=0.42, stop_band=0.48, attenuation=100.0
)


def simulate_records(
    design: CampaignDesign,
    effects: Sequence[HiddenEffect],
    *,
    converter: AntiAlias = CONVERTER,
) -> tuple[FloatArray, FloatArray]:
    """Return the noise-free records.

    Args:
        design: specimen and hits.
        effects: hidden ones; none for the base model at its true values.
        converter: of force and accelerations.

    Returns:
        Forces [N], shape (n_records, n), and accelerations [m/s^2], shape
        (n_records, 2, n), both through the same anti-alias filter.
    """
    faults = [(effect.name, effect.parameters) for effect in effects]
    beyond = converter.half_length // converter.oversampling + 1
    forces, responses = [], []
    for condition in design.conditions:
        force, acceleration = _stream(
            design.physical,
            effects,
            condition,
            samples=SAMPLES + beyond,
            oversampling=converter.oversampling,
        )
        (seen,) = decimate([np.vstack((force, acceleration))], converter)
        forces.append(seen[0, :SAMPLES])
        responses.append(clip_samples(seen[1:, :SAMPLES], faults))
    return np.stack(forces), np.stack(responses)


def sketch_responses(
    design: CampaignDesign,
    effects: Sequence[HiddenEffect] = (),
    *,
    physical: Mapping[str, float] | None = None,
    oversampling: int = 4,
) -> FloatArray:
    """Return accelerations as `simulate_records` does, faster and less exact.

    Four steps per sample and no anti-alias filter: within one percent of a change,
    enough for the size of an effect.

    Args:
        design: specimen and hits.
        effects: hidden ones.
        physical: replaces the true values of the design.
        oversampling: steps of the plant per sample.

    Returns:
        Accelerations [m/s^2], shape (n_records, 2, n).
    """
    values = design.physical if physical is None else physical
    faults = [(effect.name, effect.parameters) for effect in effects]
    responses = []
    for condition in design.conditions:
        _, acceleration = _stream(
            values, effects, condition, samples=SAMPLES, oversampling=oversampling
        )
        responses.append(clip_samples(acceleration[:, ::oversampling], faults))
    return np.stack(responses)


def _stream(
    physical: Mapping[str, float],
    effects: Sequence[HiddenEffect],
    condition: CampaignCondition,
    *,
    samples: int,
    oversampling: int,
) -> tuple[FloatArray, FloatArray]:
    """Return force and sensed accelerations at every step of the plant."""
    values = dict(physical)
    values["kj"] *= condition.joint_factor
    plant = two_bodies(**values)
    for effect in effects:
        plant = change_plant(plant, effect, condition)
    rate = SAMPLE_RATE * oversampling
    time = np.arange(2 * samples * oversampling + 1, dtype=float) / (2 * rate)
    force = pulse_force([condition.pulse], time)
    acceleration, _ = step_plant(
        plant,
        condition.force_factor * force,
        body=condition.hit_dof,
        time_step=1 / rate,
    )
    seen = force[:-1:2]
    if condition.force_delay:
        seen = pulse_force([condition.pulse], time[:-1:2] - condition.force_delay)
    sensed = distort_signals(
        np.array(condition.channel_gain)[:, None] * acceleration[:2],
        [(effect.name, effect.parameters) for effect in effects],
        rate=rate,
        condition=condition,
    )
    return seen, sensed
