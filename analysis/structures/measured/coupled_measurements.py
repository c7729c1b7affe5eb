# SPDX-License-Identifier: MIT
"""Modes and FRFs of bodies that were struck alone, joined by springs and dampers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData, ChannelMissing
from jointbench.analysis.structures.measured.frf_coupling import FrfBlock, FrfLink
from jointbench.analysis.structures.measured.measured_body import (
    ModalTable,
    modal_body,
)
from jointbench.analysis.structures.measured.measured_frfs import with_uncertainty
from jointbench.analysis.structures.reduction.assembled import assemble_components
from jointbench.analysis.structures.reduction.component import BodySource
from jointbench.analysis.structures.reduction.port_joints import PortJoint
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.signal.frf.frf import Frf

# Modes beyond those of the bodies that the assembly is asked for.
_SPARE = 8
_BOX = (1e3, 1e12)


@dataclass(frozen=True, slots=True, eq=False)
class CoupledModes:
    """Modes of coupled bodies within the band of their measurement.

    Attributes:
        frequency: |pole| / 2 pi [Hz], shape (n_modes,).
        frequency_sd: from noise, and from the modes above the band [Hz].
        damping_ratio: [-], same shape.
        damping_sd: [-], same shape.
    """

    frequency: FloatArray
    frequency_sd: FloatArray
    damping_ratio: FloatArray
    damping_sd: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "frequency_sd", "damping_ratio", "damping_sd")


def frf_block(name: str, frf: Frf) -> tuple[FrfBlock, tuple[str, ...]]:
    """Return the FRFs of a body between all of its points, and their labels.

    Args:
        name: of the body.
        frf: every point struck, and measured in the same direction.

    Returns:
        Receptances with their variance, and the labels of the points.

    Raises:
        ChannelMissing: a point was struck but not measured, or the other way round.
        BadData: no noise is known, or the FRFs have an exponential window.
    """
    outputs = [one.rpartition("@")[2] for one in frf.outputs]
    if sorted(outputs) != sorted(frf.inputs):
        raise ChannelMissing(
            f"body {name!r} was measured at {outputs} and struck at "
            f"{list(frf.inputs)}; all points must be both"
        )
    if frf.variance is None:
        raise BadData(
            f"the FRFs of {name!r} have no variance, or coherence with a number of "
            "averages; intervals need one of them"
        )
    if frf.added_decay_rate:
        raise BadData(
            f"the FRFs of {name!r} have an exponential window of "
            f"{frf.added_decay_rate:g} 1/s; measure until the decay has ended"
        )
    order = [outputs.index(one) for one in frf.inputs]
    scale = (2j * np.pi * frf.frequency) ** -frf.kind.derivatives
    response = frf.response[order] * scale
    variance = frf.variance[order] * np.abs(scale) ** 2
    return FrfBlock(name, frf.frequency, response, variance), tuple(frf.inputs)


def coupled_modes(
    blocks: Sequence[FrfBlock],
    links: Sequence[FrfLink],
    band: tuple[float, float],
    *,
    draws: int = 40,
    seed: int = 1,
) -> CoupledModes:
    """Return the modes of measured bodies joined by links.

    Args:
        blocks: FRFs of each free body between all of its points.
        links: between points.
        band: of the fits [Hz]: above the suspension, within the excited range.
        draws: from the uncertainty of the fits.
        seed: of the draws.

    Returns:
        Oscillating modes within the band, with standard deviations.

    Raises:
        BadData: there is none, or a fit fails.
    """
    nominal = [0]

    def modes(tables: Sequence[ModalTable]) -> FloatArray:
        found = _modes_of(tables, links, band)
        count = nominal[0] or found.shape[1]
        nominal[0] = count
        # A draw may move the last mode out of the band.
        wide = np.full((2, count), np.nan)
        wide[:, : min(count, found.shape[1])] = found[:, :count]
        return wide

    value, sd = with_uncertainty(modes, blocks, band, draws=draws, seed=seed)
    kept = np.isfinite(value).all(axis=0) & np.isfinite(sd).all(axis=0)
    if not kept.any():
        raise BadData(
            f"the coupled bodies have no mode from {band[0]:g} to {band[1]:g} Hz; "
            "widen the band of the measurement"
        )
    return CoupledModes(value[0, kept], sd[0, kept], value[1, kept], sd[1, kept])


def _modes_of(
    tables: Sequence[ModalTable],
    links: Sequence[FrfLink],
    band: tuple[float, float],
) -> FloatArray:
    """Return frequencies and damping ratios within the band, shape (2, n)."""
    bodies = [
        modal_body(
            one,
            {str(at): [at] for at in range(one.shapes.shape[1])},
            BodySource.FRF_BLOCK,
        )
        for one in tables
    ]
    joints = [
        PortJoint(
            f"link {at + 1}",
            (link.first[0], str(link.first[1])),
            None if link.second is None else (link.second[0], str(link.second[1])),
            ("along",),
        )
        for at, link in enumerate(links)
    ]
    count = sum(one.rigid for one in bodies) + _SPARE
    count += sum(one.frequency.size for one in tables)
    size = sum(one.size for one in bodies)
    whole = assemble_components(bodies, joints, box=_BOX, modes=min(count, size))
    values = JointValues(
        np.array([one.stiffness for one in links], float),
        np.array([one.damping for one in links], float),
    )
    found = whole.complex_modes(values)
    frequency = found.natural_frequency
    inside = (
        (frequency >= band[0])
        & (frequency <= band[1])
        & np.logical_not(found.overdamped)
    )
    order = np.flatnonzero(inside)[np.argsort(frequency[inside])]
    return np.stack([frequency[order], found.damping_ratio[order]])
