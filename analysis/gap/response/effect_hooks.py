# SPDX-License-Identifier: MIT
"""How an effect acts on lumped dynamics: the hooks that a catalogue entry fills in.

A hook returns what it ADDS; a hook of amplitude 0 returns exact zeros (or ones for a
transfer), so that the base is reproduced to the last bit.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.response.slider_integration import NO_SLIDERS


@dataclass(frozen=True, slots=True, eq=False)
class HitConditions:
    """What is known of each record.

    Attributes:
        preload: over the reference preload [-], shape (n_records,).
        progress: rank in time from 0 to 1 [-], shape (n_records,).
        settling: log of the joint's stiffness over its mean, as it has settled from
            hit to hit [-], shape (n_records,); None where that is not looked at.
    """

    preload: FloatArray
    progress: FloatArray
    settling: FloatArray | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ElementState:
    """What a link or body hook may look at.

    Attributes:
        s: Laplace variable [rad/s], shape (n_lines,).
        mass: of the body [kg]; 0 for a link.
        stiffness: of the link [N/m]; 0 for a body.
        damping: of the link [N s/m]; 0 for a body.
        conditions: of each record.
    """

    s: ComplexArray
    mass: float
    stiffness: float
    damping: float
    conditions: HitConditions


@dataclass(frozen=True, slots=True, eq=False)
class Law:
    """A nonlinear force law for the compiled march.

    Attributes:
        kind: one of the constants of `force_integration`.
        parameters: of the law, shape (n,).
        slips: of sliders [m]; empty for others.
        weights: of sliders [N/m].
        tables: of sliders.
        tops: of sliders.
    """

    kind: int
    parameters: FloatArray
    slips: FloatArray = field(default_factory=lambda: NO_SLIDERS[0])
    weights: FloatArray = field(default_factory=lambda: NO_SLIDERS[1])
    tables: FloatArray = field(default_factory=lambda: NO_SLIDERS[2])
    tops: FloatArray = field(default_factory=lambda: NO_SLIDERS[3])


_Stiffness = Callable[[ElementState, FloatArray], ComplexArray]
_Transfer = Callable[[ComplexArray, FloatArray], ComplexArray]
_Shape = Callable[[FloatArray, FloatArray, FloatArray, float], FloatArray]
_Bend = Callable[[FloatArray], Law]
_Rise = Callable[[HitConditions, FloatArray], FloatArray]


def _nothing() -> Mapping[str, str]:
    return {}


@dataclass(frozen=True, slots=True)
class LumpedEffect:
    """A catalogue entry: an effect and the one or two hooks it acts through.

    Attributes:
        effect: name, parameters, source, rivals.
        sites: kinds of site it applies to, for example ``("link",)``.
        stiffness: dynamic stiffness [N/m] added to a link (between its ends) or to
            a body (to the ground), shape (1 or n_records, n_lines): a polynomial of
            degree 2 in s plus simple fractions of the effect's own poles.
        poles: own poles of that stiffness [rad/s], from values; None for none.
        law: nonlinear force across a link, from values.
        transfer: factor on a channel, shape (n_lines,).
        mixing: factor of the other channels added to this one.
        shape: from (model, measured, values, sample_rate) to the channel's output
            [SI], all of shape (n_records, n_channels, n_samples).
        rise: relative change of a link's stiffness in each record, for effects that do
            nothing else, from conditions and values, shape (n_records,); None for
            others. Where the joint's stiffness is taken from each hit, it enters by
            the slope there.
        every_channel: True where a fault of all channels alike is a site of its own.
    """

    effect: Effect
    sites: tuple[str, ...]
    stiffness: _Stiffness | None = None
    poles: Callable[[FloatArray], ComplexArray] | None = None
    law: _Bend | None = None
    transfer: _Transfer | None = None
    mixing: Callable[[FloatArray], float] | None = None
    shape: _Shape | None = None
    rise: _Rise | None = None
    every_channel: bool = False

    @property
    def name(self) -> str:
        """Name of the effect, under which the catalogue knows the entry."""
        return self.effect.name


def one_row(values: ComplexArray) -> ComplexArray:
    """Return a line array as one row that every record shares."""
    return np.asarray(values, dtype=np.complex128)[None, :]
