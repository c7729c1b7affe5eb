# SPDX-License-Identifier: MIT
"""Hooks through which a catalogue entry acts on lumped dynamics.

A hook returns its additional contribution; at amplitude 0 it returns exact zeros (ones
for a transfer), so that the base is reproduced to the last bit.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.response.slider_integration import NO_SLIDERS


@dataclass(frozen=True, slots=True, eq=False)
class HitConditions:
    """Conditions of each record.

    Attributes:
        preload: over the reference preload [-], shape (n_records,).
        progress: rank in time from 0 to 1 [-], shape (n_records,).
        settling: log of the joint's stiffness in each hit over its mean [-], shape
            (n_records,); None if settling is not modelled.
    """

    preload: FloatArray
    progress: FloatArray
    settling: FloatArray | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ElementState:
    """Inputs of a link or body hook.

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
    """A nonlinear force law for the time integration.

    Attributes:
        kind: one of the constants of `law_forces`.
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
    """A catalogue entry: an effect and its hooks.

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
        rise: relative change of a link's stiffness in each record, from conditions and
            values, shape (n_records,), for effects without any other action; None
            for others. If the model is expanded about the stiffness of each hit, the
            change enters by the slope at that stiffness.
        every_channel: True if the same fault of all channels is a site.
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
        """Name of the effect, which identifies the entry in the catalogue."""
        return self.effect.name


def one_row(values: ComplexArray) -> ComplexArray:
    """Return a line array as one row that is common to all records."""
    return np.asarray(values, dtype=np.complex128)[None, :]
