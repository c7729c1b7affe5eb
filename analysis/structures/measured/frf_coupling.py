# SPDX-License-Identifier: MIT
"""Couple bodies by their measured FRFs, line by line, with their uncertainty."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.signal.frf.frf import Frf, FrfKind

# Reciprocal FRFs that differ by more than this share of the largest are not of one set
# of points.
_NOT_RECIPROCAL = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class FrfBlock:
    """FRFs of one body between all of its points.

    Attributes:
        name: of the body.
        frequency: lines [Hz], shape (n_lines,).
        receptance: [m/N], shape (n_points, n_points, n_lines).
        variance: E|error|^2 of each [m^2/N^2], same shape.
    """

    name: str
    frequency: FloatArray
    receptance: ComplexArray
    variance: FloatArray

    def __post_init__(self) -> None:
        """Check shapes and reciprocity; make the arrays read-only."""
        count = self.receptance.shape[0]
        require_shape(
            "receptance", self.receptance, (count, count, self.frequency.size)
        )
        require_shape("variance", self.variance, self.receptance.shape)
        apart = np.abs(self.receptance - np.swapaxes(self.receptance, 0, 1)).sum(axis=2)
        size = np.abs(self.receptance).sum(axis=2)
        if np.any(apart > _NOT_RECIPROCAL * size.max(initial=0.0)):
            raise BadData(
                f"the FRFs of {self.name!r} are not symmetric; hit and measure the "
                "same points in the same directions and order"
            )
        freeze(self, "frequency", "receptance", "variance")


@dataclass(frozen=True, slots=True)
class FrfLink:
    """A connection of two points, or of a point and the ground.

    Attributes:
        first: name of a block, and number of a point in it.
        second: the same, or None for the ground.
        stiffness: [N/m]; infinite is rigid.
        damping: [N s/m].
    """

    first: tuple[str, int]
    second: tuple[str, int] | None
    stiffness: float = float("inf")
    damping: float = 0.0


def couple_frfs(
    blocks: Sequence[FrfBlock],
    links: Sequence[FrfLink],
    points: Sequence[tuple[str, int]],
) -> Frf:
    """Couple bodies by their FRFs.

    Args:
        blocks: FRFs of each body on the same lines.
        links: connections.
        points: where the coupled FRFs are wanted: all of these by all of these.

    Returns:
        Receptances with their variance to first order in that of the blocks.

    Raises:
        BadData: the blocks have different lines.
        UsageError: there is no such body or point.

    Source:
        de Klerk, Rixen and Voormeeren 2008, AIAA J. 46, 1169-1181 (dual assembly).
    """
    frequency = blocks[0].frequency
    if any(not np.array_equal(one.frequency, frequency) for one in blocks):
        raise BadData("the FRFs of the bodies have different lines; use one resolution")
    whole = _block_diagonal([one.receptance for one in blocks])
    variance = _block_diagonal([one.variance for one in blocks]).real
    size = whole.shape[1]
    ties = link_rows(blocks, links)
    laplace = 2j * np.pi * frequency
    impedance = [np.asarray(one.stiffness + laplace * one.damping) for one in links]
    soft = np.zeros((frequency.size, len(links)), complex)
    for row, one in enumerate(impedance):
        soft[:, row] = 1.0 / one
    kept = [_place(blocks, one) for one in points]
    gap = ties @ whole @ ties.T + soft[:, :, None] * np.eye(len(links))
    # What a change of any FRF of a body does: left' dH right, with one factor each.
    moved = np.linalg.solve(gap, ties @ whole)
    left = np.eye(size)[kept] - (whole @ ties.T)[:, kept] @ np.linalg.solve(
        gap, np.broadcast_to(ties, (frequency.size, *ties.shape))
    )
    right = np.eye(size)[:, kept] - (ties.T @ moved)[:, :, kept]
    coupled = left @ whole[:, :, kept]
    spread = np.abs(left) ** 2 @ variance @ np.abs(right) ** 2
    labels = tuple(f"{name}:{number}" for name, number in points)
    return Frf(
        frequency=frequency,
        response=np.moveaxis(coupled, 0, 2),
        kind=FrfKind.RECEPTANCE,
        variance=np.moveaxis(spread, 0, 2),
        outputs=labels,
        inputs=labels,
    )


def link_rows(blocks: Sequence[FrfBlock], links: Sequence[FrfLink]) -> FloatArray:
    """Return the relative motion of links from the points of all blocks.

    Args:
        blocks: in the order of the points.
        links: connections.

    Returns:
        Shape (n_links, n_points).

    Raises:
        UsageError: there is no such body or point.
    """
    ties = np.zeros((len(links), sum(one.receptance.shape[0] for one in blocks)))
    for row, link in enumerate(links):
        ties[row, _place(blocks, link.first)] += 1.0
        if link.second is not None:
            ties[row, _place(blocks, link.second)] -= 1.0
    return ties


def _block_diagonal(parts: Sequence[ComplexArray | FloatArray]) -> ComplexArray:
    """Return line-first block diagonal matrices, shape (n_lines, n, n)."""
    size = sum(one.shape[0] for one in parts)
    whole = np.zeros((parts[0].shape[2], size, size), complex)
    at = 0
    for one in parts:
        count = one.shape[0]
        whole[:, at : at + count, at : at + count] = np.moveaxis(one, 2, 0)
        at += count
    return whole


def _place(blocks: Sequence[FrfBlock], point: tuple[str, int]) -> int:
    name, number = point
    begin = 0
    for one in blocks:
        count = one.receptance.shape[0]
        if one.name == name:
            if not 0 <= number < count:
                raise UsageError(f"{name!r} has points 0 to {count - 1}, not {number}")
            return begin + number
        begin += count
    raise UsageError(f"no body {name!r}; the blocks are {[b.name for b in blocks]}")
