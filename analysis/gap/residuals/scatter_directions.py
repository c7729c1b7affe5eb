# SPDX-License-Identifier: MIT
"""Directions in which hits scatter: derivatives of the model, record by record.

On lumped bodies that move along one line, aim and tilt of the hammer change the gain of
each channel (rocking adds to the motion at its sensor), so their direction is a gain of
each channel and hit.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.catalogue.linear_effects import DELAY
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.lumped_residual import LumpedResidual
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.residuals.scatter_record import (
    CHANNEL_GAIN,
    DELAY_OF_CHANNEL,
    DELAY_OF_HIT,
    FORCE_GAIN,
    JOINT,
    ScatterDirection,
)
from jointbench.analysis.gap.response.dynamic_stiffness import Action


def scatter_directions(campaign: Campaign) -> tuple[ScatterDirection, ...]:
    """Return the directions in which hits may scatter, in the order of their columns.

    Joints do not settle in records without hits.
    """
    model, stated = campaign.model, campaign.scatter
    joints = [x.name for x in model.links if x.joint and not campaign.continuous]
    found = [ScatterDirection(FORCE_GAIN, "-", (0,), expected=stated.force_gain or 0.0)]
    settling = stated.joint_stiffness or 0.0
    for name in joints:
        at = (len(found),)
        found.append(ScatterDirection(JOINT + name, "-", at, expected=settling))
    if campaign.continuous:
        return tuple(found)
    first, channels = len(found), len(model.channels)
    gains = tuple(range(first, first + channels))
    late = first + channels
    delays = tuple(range(late + 1, late + 1 + channels))
    step = 1.0 / campaign.sample_rate
    return (
        *found,
        ScatterDirection(CHANNEL_GAIN, "-", gains, expected=stated.channel_gain or 0.0),
        ScatterDirection(DELAY_OF_HIT, "s", (late,), step, stated.force_delay or 0.0),
        ScatterDirection(
            DELAY_OF_CHANNEL, "s", delays, step, stated.channel_delay or 0.0
        ),
    )


def scatter_columns(
    bench: LumpedResidual,
    base: FloatArray,
    terms: Sequence[Term],
    model: FloatArray,
) -> FloatArray:
    """Return the columns over the noise, shape (n_records, n_columns, n_rows).

    First the operator: the acting force differs slightly from the measured one. Then
    each joint, whose stiffness settles differently in each hit; then gains and delays.

    Args:
        bench: measurement and model.
        base: log(parameter / nominal), shape (n_base,).
        terms: effects.
        model: response there, shape (n_records, n_channels, n_samples).
    """
    level = 1.0 if bench.gains is None else bench.gains.factor[:, :, None]
    columns = [_harder(bench, base, terms, model) / level]
    n = len(bench.campaign.model.bodies)
    for i, link in enumerate(bench.campaign.model.links):
        if link.joint and not bench.campaign.continuous:
            moved = base.copy()
            moved[n + i] += RESIDUALS.scatter_step
            columns.append(
                (bench.response(moved, terms) - model) / RESIDUALS.scatter_step
            )
    if not bench.campaign.continuous:
        columns += _each_channel(_louder(bench, base, terms, model) / level)
        late = _later(bench, base, terms, model)
        columns += [late, *_each_channel(late)]
    stacked = np.stack(columns, axis=1)
    bench.mask(stacked)
    stacked /= bench.noise.sigma[:, None, :, None]
    return stacked.reshape(len(model), len(columns), -1)


def _each_channel(rows: FloatArray) -> list[FloatArray]:
    """Return one array for each channel, 0 in all others."""
    found = []
    for c in range(rows.shape[1]):
        alone = np.zeros_like(rows)
        alone[:, c] = rows[:, c]
        found.append(alone)
    return found


def _harder(
    bench: LumpedResidual,
    base: FloatArray,
    terms: Sequence[Term],
    model: FloatArray,
) -> FloatArray:
    """Return the change of the response per relative change of the force.

    A clipped sample does not change.
    """
    entries = [a.entry for a in bench.actions(terms)]
    if all(e.law is None and e.shape is None for e in entries):
        return model.copy()
    spectrum = bench.excitation.spectrum * (1.0 + RESIDUALS.scatter_step)
    pushed = replace(bench, excitation=replace(bench.excitation, spectrum=spectrum))
    return (pushed.response(base, terms) - model) / RESIDUALS.scatter_step


def _louder(
    bench: LumpedResidual,
    base: FloatArray,
    terms: Sequence[Term],
    model: FloatArray,
) -> FloatArray:
    """Return the change of each channel per relative change of its gain."""
    if all(a.entry.shape is None for a in bench.actions(terms)):
        return model
    clipped = np.abs(model) >= np.abs(model).max(axis=2, keepdims=True)
    kept = np.sum(clipped, axis=2, keepdims=True) < RESIDUALS.flat_samples
    return np.where(clipped & ~kept, 0.0, model)


def _later(
    bench: LumpedResidual,
    base: FloatArray,
    terms: Sequence[Term],
    model: FloatArray,
) -> FloatArray:
    """Return the change of the response per sample of delay, by the transform."""
    step = RESIDUALS.delay_step
    late = np.array([step / bench.campaign.sample_rate])
    delay = Action(DELAY, "channel", -1, late)
    moved = bench.acted(base, [*bench.actions(terms), delay], 8)
    return (moved - model) / step
