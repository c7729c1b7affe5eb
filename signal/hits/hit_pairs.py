# SPDX-License-Identifier: MIT
"""Which hits serve which FRF, by reciprocity where a pair was measured the other way.

Hammer and accelerometer may both rove: some points are hit, others carry the
accelerometer while one of them is hit. No rectangle of outputs and inputs is complete
then. Maxwell's reciprocity makes one: the response at p to a hit at r is that at r to a
hit at p. It is used only where pairs are missing; what was measured directly is never
replaced.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from jointbench.acquisition.basics.arrays import IntArray
from jointbench.acquisition.basics.errors import ChannelMissing


class LabelledHits(Protocol):
    """Hits of which it is known what they measured and where the hammer struck."""

    @property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        """For each hit, the label of each of its responses."""

    @property
    def points(self) -> tuple[str, ...]:
        """For each hit, where the hammer struck."""


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """The hits that measured one output from one input.

    Attributes:
        hits: indices into the hits, shape (n,).
        rows: the response row in each of them, shape (n,).
    """

    hits: IntArray
    rows: IntArray


Paired = tuple[tuple[str, ...], tuple[str, ...], tuple[Pair, ...]]
"""Output labels, input points, and their pairs, outputs outermost."""


def pair_up(measured: LabelledHits) -> Paired:
    """Sort hits into pairs of output and input.

    Returns:
        Output labels, input points, and the pairs, outputs outermost. Where pairs are
        missing and reciprocity completes the columns of some inputs, these inputs
        alone, with a row for every point that was hit or measured.

    Raises:
        ChannelMissing: a pair was never measured together, nor the other way round.

    Source:
        Ewins, Modal Testing (2000), sec. 1.4 (reciprocity).
    """
    outputs = tuple(dict.fromkeys(label for row in measured.labels for label in row))
    inputs = tuple(dict.fromkeys(measured.points))
    found = [
        [_hits_of(measured, output, point) for point in inputs] for output in outputs
    ]
    if all(row for rows in found for row in rows):
        pairs = [
            _pair(measured, o, r)
            for o, rows in zip(outputs, found, strict=True)
            for r in rows
        ]
        return outputs, inputs, tuple(pairs)
    completed = _by_reciprocity(measured, outputs, inputs)
    if completed is not None:
        return completed
    output, point = next(
        (outputs[i], inputs[j])
        for i, rows in enumerate(found)
        for j, row in enumerate(rows)
        if not row
    )
    raise ChannelMissing(
        f"response {output!r} was never measured with an accepted hit at point "
        f"{point!r}, nor the other way round; leave one of them out or add the "
        "missing hits"
    )


def _hits_of(measured: LabelledHits, output: str, point: str) -> list[int]:
    return [
        i
        for i, (labels, struck) in enumerate(
            zip(measured.labels, measured.points, strict=True)
        )
        if struck == point and output in labels
    ]


def _pair(measured: LabelledHits, output: str, hits: Sequence[int]) -> Pair:
    rows = [measured.labels[i].index(output) for i in hits]
    return Pair(np.array(hits), np.array(rows))


def _by_reciprocity(
    measured: LabelledHits, outputs: Sequence[str], inputs: Sequence[str]
) -> Paired | None:
    """Return the complete columns of all inputs that have one, or None."""
    places = [point_of(output) for output in outputs]
    only_hit = [point for point in inputs if point not in places]
    columns = {}
    for reference in inputs:
        here = [o for o in outputs if point_of(o) == reference]
        # Two directions at one point: a hit there names none of them.
        back = here[0] if len(here) == 1 else None
        column = [
            _either(measured, o, reference, back if places.count(p) == 1 else None)
            for o, p in zip(outputs, places, strict=True)
        ]
        column += [
            _pair(measured, back, hits)
            if back and (hits := _hits_of(measured, back, point))
            else None
            for point in only_hit
        ]
        whole = [pair for pair in column if pair is not None]
        if len(whole) == len(column):
            columns[reference] = whole
    if not columns:
        return None
    channel = outputs[0].rpartition("@")[0]
    labels = (*outputs, *(f"{channel}@{point}" for point in only_hit))
    pairs = tuple(pair for row in zip(*columns.values(), strict=True) for pair in row)
    return labels, tuple(columns), pairs


def _either(
    measured: LabelledHits, output: str, reference: str, back: str | None
) -> Pair | None:
    """Return the pair as measured, or the other way round, or None."""
    direct = _hits_of(measured, output, reference)
    if direct:
        return _pair(measured, output, direct)
    turned = _hits_of(measured, back, point_of(output)) if back else []
    return _pair(measured, back, turned) if back and turned else None


def point_of(output: str) -> str:
    """Return the point of a label ``"channel@point"``."""
    return output.rpartition("@")[2]
