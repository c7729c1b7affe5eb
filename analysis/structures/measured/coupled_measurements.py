# SPDX-License-Identifier: MIT
"""Modes and FRFs of bodies that were struck alone, joined by springs and dampers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData, ChannelMissing
from jointbench.analysis.structures.measured.coupled_roots import (
    GapMatrix,
    poles_near,
)
from jointbench.analysis.structures.measured.fitted_frfs import FittedFrfs
from jointbench.analysis.structures.measured.frf_coupling import (
    FrfBlock,
    FrfLink,
    link_rows,
)
from jointbench.analysis.structures.measured.measured_body import (
    ModalTable,
    modal_body,
)
from jointbench.analysis.structures.measured.measured_frfs import fit_twice
from jointbench.analysis.structures.reduction.assembled import assemble_components
from jointbench.analysis.structures.reduction.component import BodySource
from jointbench.analysis.structures.reduction.port_joints import PortJoint
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.signal.frf.frf import Frf

# Modes beyond those of the bodies that the assembly is asked for.
_SPARE = 8
_BOX = (1e3, 1e12)
# Poles that start outside of the band by this factor may end in it.
_AROUND = 1.15
# Poles that agree to this are one.
_SAME = 1e-7
# Least ratio of imaginary part to size of an oscillating pole.
_SWINGS = 0.02
# A mode is remarked on if its 95 % interval exceeds this share of its frequency.
_WIDE, _HARDLY = 1.96, 5e-3


@dataclass(frozen=True, slots=True, eq=False)
class CoupledModes:
    """Modes of coupled bodies within the band of their measurement.

    Attributes:
        frequency: |pole| / 2 pi [Hz], shape (n_modes,).
        frequency_sd: from noise, and from the modes above the band [Hz].
        damping_ratio: [-], same shape.
        damping_sd: [-], same shape.
        remarks: modes that the FRFs hardly determine, and why.
    """

    frequency: FloatArray
    frequency_sd: FloatArray
    damping_ratio: FloatArray
    damping_sd: FloatArray
    remarks: tuple[str, ...] = ()

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
        Oscillating modes within the band, with standard deviations: those of draws
        with two further powers for the modes above the band, and the change with these.

    Raises:
        BadData: there is none, or a fit fails.
    """
    fits = [fit_twice(one, band) for one in blocks]
    best = [one for one, _ in fits]
    ties = link_rows(blocks, links)

    def gap(some: Sequence[FittedFrfs]) -> GapMatrix:
        return GapMatrix(
            tuple(one.response() for one in some),
            ties,
            np.array([one.stiffness for one in links], float),
            np.array([one.damping for one in links], float),
        )

    starts = _starts([one.table() for one in best], links, band)
    poles = _within(_distinct(poles_near(gap(best), starts)), band)
    if not poles.size:
        raise BadData(
            f"the coupled bodies have no mode from {band[0]:g} to {band[1]:g} Hz; "
            "widen the band of the measurement"
        )
    fuller = [one for _, one in fits]
    other = poles_near(gap(fuller), poles.tolist())
    places = other.tolist()
    random = np.random.default_rng(seed)
    # A further power moves the poles by the error of the description, or by its own
    # noise; the noise of the fuller fit is that of a description without error.
    drawn = np.array(
        [
            _numbers(poles_near(gap([one.drawn(random) for one in fuller]), places))
            for _ in range(draws)
        ]
    )
    apart = _numbers(other) - _numbers(poles)
    noise = np.nanstd(drawn, axis=0, ddof=1)
    sd = np.hypot(noise, np.where(np.isfinite(apart), apart, np.inf))
    frequency, ratio = _numbers(poles)
    return CoupledModes(frequency, sd[0], ratio, sd[1], _remarks(frequency, noise, sd))


def _numbers(poles: ComplexArray) -> FloatArray:
    """Return frequencies [Hz] and damping ratios [-], shape (2, n)."""
    size = np.abs(poles)
    return np.stack([size / (2.0 * np.pi), -poles.real / size])


def _distinct(poles: ComplexArray) -> ComplexArray:
    """Return the poles that were found, each once, the lowest first."""
    found = poles[np.isfinite(poles)]
    found = found[np.argsort(np.abs(found))]
    apart = np.abs(np.diff(found)) > _SAME * np.abs(found[1:])
    return np.asarray(found[np.append(True, apart)]) if found.size else found


def _within(poles: ComplexArray, band: tuple[float, float]) -> ComplexArray:
    """Return the oscillating poles within a band [Hz]."""
    frequency = np.abs(poles) / (2.0 * np.pi)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    return np.asarray(poles[inside & (poles.imag > _SWINGS * np.abs(poles))])


def _remarks(
    frequency: FloatArray, noise: FloatArray, sd: FloatArray
) -> tuple[str, ...]:
    """Return what limits modes that the FRFs hardly determine."""
    found = []
    for at in np.flatnonzero(_WIDE * sd[0] > _HARDLY * frequency):
        cause = (
            "noise of the FRFs; average more hits"
            if noise[0, at] > 0.5 * sd[0, at]
            else "the modes above the band; measure to a higher frequency"
        )
        found.append(
            f"mode {at + 1} at {frequency[at]:.4g} Hz is known within "
            f"{100 * _WIDE * sd[0, at] / frequency[at]:.2g} % (95 %): the limit is "
            f"{cause}"
        )
    return tuple(found)


def _starts(
    tables: Sequence[ModalTable],
    links: Sequence[FrfLink],
    band: tuple[float, float],
) -> list[complex]:
    """Return poles of the bodies' modes joined by the links, in and around the band."""
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
    pole = whole.complex_modes(values).pole
    level = np.abs(pole) / (2.0 * np.pi)
    near = (level > band[0] / _AROUND) & (level < band[1] * _AROUND)
    return [complex(one) for one in pole[near & (pole.imag > 0.0)]]
