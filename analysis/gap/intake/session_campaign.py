# SPDX-License-Identifier: MIT
"""Make a campaign from recordings of a bench: hits, levels, preloads, points."""

import itertools
from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import Hit, Quantity, Recording
from jointbench.analysis.gap.intake.cut_hits import CutHits, cut_hits
from jointbench.analysis.gap.intake.intake_settings import INTAKE
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.nominal import NominalParameters
from jointbench.analysis.lumped.lumped_model import Output

SAME_LEVEL = INTAKE.same_level_ratio
LEVEL_SPAN = INTAKE.level_span
QUANTITIES = {
    Output.DISPLACEMENT: Quantity.DISPLACEMENT,
    Output.VELOCITY: Quantity.VELOCITY,
    Output.ACCELERATION: Quantity.ACCELERATION,
}


def session_campaign(
    name: str, recordings: Sequence[Recording], nominal: NominalParameters
) -> tuple[Campaign, tuple[str, ...]]:
    """Make a campaign of the accepted hits of recordings.

    Args:
        name: of the campaign, chosen by the user.
        recordings: with judged hits, in the order recorded, each with its preload.
        nominal: model that should explain them.

    Returns:
        The campaign, and one line with the reason for each accepted hit left out.

    Raises:
        BadData: a preload is missing, a hit point belongs to no body, channels
            measure another quantity than the model, or hits cannot be cut.
    """
    _require_quantity(recordings, nominal)
    cut = cut_hits(recordings, [channel.name for channel in nominal.model.channels])
    owners = [recordings[index] for index in cut.recording]
    preload = np.array([_preload(recording) for recording in owners])
    bodies = [
        _body(recording, hit, nominal)
        for recording, hit in zip(owners, cut.hits, strict=True)
    ]
    campaign = Campaign(
        name=name,
        sample_rate=cut.sample_rate,
        force=cut.force,
        response=cut.response,
        hit=np.array(bodies, dtype=np.int64),
        level=nominal_levels(_peaks(cut)),
        preload=preload,
        order=np.arange(len(cut.hits), dtype=float),
        preload_reference=_reference(preload, nominal),
        model=nominal.model,
        repeatability=nominal.repeatability,
        scatter=nominal.scatter,
    )
    return campaign, cut.left_out


def nominal_levels(peaks: FloatArray) -> FloatArray:
    """Group peak forces into the levels intended by the operator.

    A level ends at a large step to the next peak, or before it would span more than a
    factor of 2.5; its value is its geometric mean, to two digits.

    Args:
        peaks: largest force of each hit [N], shape (n_hits,), above zero.

    Returns:
        Nominal level of each hit [N], same shape.
    """
    order = np.argsort(peaks)
    groups = _split(np.log(peaks[order]))
    levels = np.empty_like(peaks)
    for first, last in groups:
        members = order[first:last]
        mean = float(np.exp(np.log(peaks[members]).mean()))
        levels[members] = float(f"{mean:.2g}")
    return levels


def _split(logs: FloatArray) -> list[tuple[int, int]]:
    """Return (first, past) of each group of ascending logarithms."""
    steps = np.diff(logs)
    edges = [0, *(np.flatnonzero(steps > np.log(SAME_LEVEL)) + 1).tolist(), logs.size]
    groups = []
    waiting = list(itertools.pairwise(edges))
    while waiting:
        first, last = waiting.pop()
        if last - first > 1 and logs[last - 1] - logs[first] > np.log(LEVEL_SPAN):
            cut = first + 1 + int(np.argmax(steps[first : last - 1]))
            waiting += [(first, cut), (cut, last)]
        else:
            groups.append((first, last))
    return groups


def _peaks(cut: CutHits) -> FloatArray:
    return np.asarray(cut.force.max(axis=1))


def _require_quantity(
    recordings: Sequence[Recording], nominal: NominalParameters
) -> None:
    """Raise `BadData` if a channel measures another quantity than the model."""
    wanted = QUANTITIES[nominal.model.output]
    names = {channel.name for channel in nominal.model.channels}
    for recording in recordings:
        for channel in recording.channels:
            if channel.name in names and channel.quantity is not wanted:
                raise BadData(
                    f"channel {channel.name!r} of recording {recording.name!r} "
                    f"measures {channel.quantity.value}, the model's output is "
                    f"{wanted.value}; correct 'output' in its [gap] table"
                )


def _preload(recording: Recording) -> float:
    preload = recording.preload
    if preload is None:
        raise BadData(
            f"recording {recording.name!r} has no preload; give it with --preload "
            "'4 kN', to `import` or here"
        )
    if not (np.isfinite(preload) and preload > 0):
        raise BadData(
            f"recording {recording.name!r} has the preload {preload:g} N, it must be "
            "above zero; give the right one with --preload '4 kN'"
        )
    return preload


def _reference(preload: FloatArray, nominal: NominalParameters) -> float:
    if nominal.preload_reference is not None:
        return nominal.preload_reference
    values = sorted(set(preload.tolist()))
    if len(values) > 1:
        shown = ", ".join(f"{value:g}" for value in values)
        raise BadData(
            f"the hits have the preloads {shown} N, and the model does not state "
            "to which its values belong; add preload_reference to its [gap] table"
        )
    return float(values[0])


def _body(recording: Recording, hit: Hit, nominal: NominalParameters) -> int:
    """Return the index of the body that a hit struck."""
    if hit.point in nominal.points:
        return nominal.points[hit.point]
    at = {channel.name: channel.point for channel in recording.channels}
    for channel in nominal.model.channels:
        if hit.point and at.get(channel.name) == hit.point:
            return nominal.model.index(channel.body)
    names = [body.name for body in nominal.model.bodies]
    if hit.point in names:
        return names.index(hit.point)
    raise BadData(
        f"recording {recording.name!r} was hit at point {hit.point!r}, which belongs "
        f"to none of the bodies {', '.join(names)}; add points = [{hit.point!r}] to "
        "the body that was struck"
    )
