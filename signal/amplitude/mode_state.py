# SPDX-License-Identifier: MIT
"""Records of the joint fit: one mode's parameters, and what a fit found."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.amplitude.curve_basis import CurveBasis

# Damping ratios that a step may reach: beyond them no mode is a resonance.
_ZETA_RANGE = (1e-6, 0.5)
# ln of the weights of other modes' squares that a step may reach.
_WEIGHT_RANGE = (-12.0, 6.0)


def _no_squares() -> FloatArray:
    return np.zeros((1, 1, 0))


def _no_weights() -> FloatArray:
    return np.zeros((2, 0))


def _no_turn() -> ComplexArray:
    return np.zeros(0, complex)


@dataclass(frozen=True, slots=True, eq=False)
class ModeState:
    """One mode's parameters.

    Attributes:
        basis: of both curves.
        log_omega: coefficients of ln(omega / centre), shape (n_functions,).
        log_zeta: coefficients of ln zeta, shape (n_functions,).
        shape: of the virtual channels, 1 at `reference`, shape (n_virtual,).
        reference: index of that channel.
        start: L of each hit at time 0, shape (n_hits,).
        phase: of each hit at time 0 [rad], shape (n_hits,).
        weights: of the penalties on ln omega and ln zeta.
        squares: of the amplitudes of other modes on the same joint, over time, in
            units of exp(2 L), shape (n_hits, n_nodes, n_others).
        log_weights: ln of the weights of these squares in the amplitude on which ln
            omega (first row) and ln zeta depend, shape (2, n_others).
        turn: of the shape with the change of the pole, 0 at `reference`, shape
            (n_virtual,); empty where the shape is constant.
    """

    basis: CurveBasis
    log_omega: FloatArray
    log_zeta: FloatArray
    shape: ComplexArray
    reference: int
    start: FloatArray
    phase: FloatArray
    weights: tuple[float, float] = (1.0, 1.0)
    squares: FloatArray = field(default_factory=_no_squares)
    log_weights: FloatArray = field(default_factory=_no_weights)
    turn: ComplexArray = field(default_factory=_no_turn)

    @property
    def shared(self) -> int:
        """Number of parameters that all hits share, without those of the shape."""
        return 2 * self.basis.size + int(self.log_weights.size)

    @property
    def others(self) -> list[int]:
        """Channels whose shape is free."""
        return [c for c in range(self.shape.size) if c != self.reference]

    @property
    def signals(self) -> int:
        """Signals that channels are made of: the mode's, and that of its turn."""
        return 2 if self.turn.size else 1


@dataclass(frozen=True, slots=True, eq=False)
class JointFit:
    """Modes fitted to a band.

    Attributes:
        modes: in the order given.
        residual: shape (n_hits, n_virtual, n_lines).
        normal: J'J, shape (n, n).
        gradient: J'r, shape (n,).
        covariance: of all parameters, shape (n, n); mode by mode the coefficients of
            ln omega and of ln zeta come first, see `curve_slices`.
        chi2: squares of the residual.
        freedom: degrees of freedom left.
    """

    modes: tuple[ModeState, ...]
    residual: ComplexArray
    normal: FloatArray
    gradient: FloatArray
    covariance: FloatArray
    chi2: float
    freedom: float

    @property
    def residual_ratio(self) -> float:
        """Rms residual over the noise of the tails [-]."""
        return float(np.sqrt(self.chi2 / max(self.freedom, 1.0)))


@dataclass(frozen=True, slots=True)
class ModeSlices:
    """Where one mode's parameters are among all.

    Attributes:
        shared: coefficients of ln omega, of ln zeta, ln weights.
        shape: real and imaginary part in turn, channel by channel; then those of the
            shape's turn.
        hits: start and phase in turn, hit by hit.
    """

    shared: slice
    shape: slice
    hits: slice


def mode_slices(modes: Sequence[ModeState]) -> tuple[ModeSlices, ...]:
    """Return where each mode's parameters are: all shared, all shapes, all hits."""
    first = [0, 0, 0]
    first[1] = sum(mode.shared for mode in modes)
    first[2] = first[1] + sum(2 * mode.signals * len(mode.others) for mode in modes)
    found = []
    for mode in modes:
        shape = 2 * mode.signals * len(mode.others)
        sizes = (mode.shared, shape, 2 * mode.start.size)
        parts = [
            slice(at, at + size) for at, size in zip(tuple(first), sizes, strict=True)
        ]
        first = [part.stop for part in parts]
        found.append(ModeSlices(*parts))
    return tuple(found)


def curve_slices(modes: Sequence[ModeState]) -> tuple[slice, ...]:
    """Return where the coefficients of each mode's two curves are."""
    return tuple(
        slice(own.shared.start, own.shared.start + 2 * mode.basis.size)
        for mode, own in zip(modes, mode_slices(modes), strict=True)
    )


def moved(
    modes: tuple[ModeState, ...], step: FloatArray
) -> tuple[ModeState, ...] | None:
    """Return the modes after a step; None where it leaves what is physical."""
    low, high = np.log(_ZETA_RANGE)
    new = []
    for mode, own in zip(modes, mode_slices(modes), strict=True):
        one = _mode_moved(mode, step[own.shared], step[own.shape], step[own.hits])
        zeta = one.basis.values @ one.log_zeta
        omega = one.basis.values @ one.log_omega
        if not (np.all((zeta > low) & (zeta < high)) and np.all(np.abs(omega) < 0.5)):
            return None
        new.append(one)
    return tuple(new)


def _mode_moved(
    mode: ModeState, shared: FloatArray, turned: FloatArray, hits: FloatArray
) -> ModeState:
    size, free = mode.basis.size, len(mode.others)
    shape, turn = mode.shape.copy(), mode.turn.copy()
    both = turned[::2] + 1j * turned[1::2]
    shape[mode.others] += both[:free]
    if turn.size:
        turn[mode.others] += both[free:]
    weights = mode.log_weights + shared[2 * size :].reshape(mode.log_weights.shape)
    return replace(
        mode,
        log_omega=mode.log_omega + shared[:size],
        log_zeta=mode.log_zeta + shared[size : 2 * size],
        shape=shape,
        turn=turn,
        start=mode.start + hits[::2],
        phase=mode.phase + hits[1::2],
        log_weights=np.clip(weights, *_WEIGHT_RANGE),
    )
