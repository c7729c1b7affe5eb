# SPDX-License-Identifier: MIT
"""Modes that the residual shows and no stable pole did.

Where a fit has all modes, its residual is white. A mode that was missed leaves a peak
that every FRF shares; it biases its neighbours and makes their intervals too narrow. So
the residual is compared with resonances of usual widths at every line. Where one stands
out, a pole is tried together with the modes around it, and kept where the FRF needs it
by the same rule as any candidate, and where it explains most of what the fit left. One
nearer to a mode than its width is kept where it leaves nothing but noise and many FRFs
give it a shape of its own: a peak that is not that of a linear mode has one shape.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
)
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.mode_significance import (
    least_significance,
    significance,
)
from jointbench.signal.modal.pole_limits import unresolved
from jointbench.signal.modal.refined_pole_covariance import RefinedPoles, refine_poles
from jointbench.signal.modal.residual_search.local_fit import (
    Group,
    WholeFit,
    group_around,
)
from jointbench.signal.modal.shape_checks import mac_matrix

Seen = Callable[[complex], bool]
"""Whether the FRF itself has a pole there [rad/s]."""
# Decay rates of the resonances looked for, over the median of the modes found.
_DECAYS = (0.5, 1.0, 2.0)
# Lines on each side of a trial: half-power half-widths, and lines at least.
_REACH_WIDTHS, _REACH_LINES = 8.0, 40
# Trials in one pass over the residual.
_TRIALS = 12
_STEPS = 12
# A mode must explain this share of the residual power above the noise around it.
_EXPLAINED = 0.5
# Residual power above the noise, over the noise, that indicates a mode.
_LEAST_EXCESS = 0.2
# Relative sd of the damping up to which a mode is known; highest damping ratio.
_VAGUE, _HIGHEST_DAMPING = 1.0 / 3.0, 0.2
# Half-power half-widths from the nearest mode, at least: nearer poles explain how one
# peak differs from that of a single mode ...
_APART = 1.0
# ... unless so many FRFs are measured, they explain this share, and their residues have
# at most this assurance criterion with those of any mode (decision record 0395).
_MANY_FRFS, _ALL_EXPLAINED, _OWN_SHAPE = 6, 0.9, 0.5
_NEAR_TRIALS = 4
# A decay rate in line distances below which a peak is a single line.
_NARROWEST = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class MissingModes:
    """Poles that the lines need and no fitted mode explains.

    Attributes:
        pole: those that the FRF shows, too [rad/s], shape (n_missing,).
        denied: the others, which are no modes unless something else shows them.
    """

    pole: ComplexArray
    denied: ComplexArray


def find_missing(whole: WholeFit, seen: Seen | None) -> MissingModes:
    """Return the poles of modes that the residual needs.

    Args:
        whole: fit of all lines with the modes found so far.
        seen: whether a pole is one of the FRF; None takes every one as seen.

    Returns:
        Refined together with their neighbours.
    """
    found: list[complex] = []
    denied: list[complex] = []
    for start in _starts(whole):
        pole = _tried(whole, start)
        if pole is None:
            continue
        kept = found if seen is None or seen(pole) else denied
        if _away(whole.lines, pole, np.array(kept, complex)):
            kept.append(pole)
    return MissingModes(np.array(found, complex), np.array(denied, complex))


def _starts(whole: WholeFit) -> list[complex]:
    """Return trial poles apart from the modes and, of many FRFs, some on them."""
    starts = _trial_starts(whole, apart=_APART, most=_TRIALS)
    if whole.lines.response.shape[0] < _MANY_FRFS:
        return starts
    near = _trial_starts(whole, apart=0.0, most=_NEAR_TRIALS)
    return starts + [start for start in near if _widths_on(whole, start).size]


def _widths_on(whole: WholeFit, start: complex) -> FloatArray:
    """Return the half-power half-widths of the modes that a trial pole stands on."""
    modes = whole.pole[: whole.n_modes]
    width = measured_width(whole.lines, modes)
    return np.asarray(width[np.abs(modes.imag - start.imag) < _APART * width])


def _trial_starts(whole: WholeFit, *, apart: float, most: int) -> list[complex]:
    """Return trial poles where the residual is most like a resonance.

    Args:
        whole: fit of all lines.
        apart: half-power half-widths around modes that are left out.
        most: trials.

    Returns:
        Poles [rad/s], the most distinct first.
    """
    limit = least_significance(whole.lines)
    omega = whole.lines.laplace.imag
    if whole.n_modes == 0 or omega.size < 3:
        return []
    modes = whole.pole[: whole.n_modes]
    width = measured_width(whole.lines, modes)
    decays = [factor * float(np.median(width)) for factor in _DECAYS]
    likeness = _likeness(whole, decays)
    best = likeness.max(axis=0)
    for pole, near in zip(modes, apart * width, strict=True):
        best[np.abs(omega - pole.imag) < near] = 0.0
    added = float(whole.lines.laplace.real[0])
    starts: list[complex] = []
    while len(starts) < most:
        at = int(np.argmax(best))
        if best[at] < limit:
            break
        decay = decays[int(np.argmax(likeness[:, at]))]
        starts.append(complex(added - decay, omega[at]))
        best[np.abs(omega - omega[at]) < 2.0 * decay] = 0.0
    return starts


def _likeness(whole: WholeFit, decays: Sequence[float]) -> FloatArray:
    """Return the chi-squared that a resonance at each line would explain.

    Shape (n_decays, n_lines). Sums over the lines are convolutions with the resonance;
    the noise is taken as constant over it.
    """
    omega = whole.lines.laplace.imag
    pitch = float(np.median(np.diff(omega)))
    away = pitch * np.arange(-omega.size + 1, omega.size)
    size = scipy.fft.next_fast_len(2 * omega.size)
    # Single precision: this chooses where to look.
    white = (whole.residual / np.sqrt(whole.noise)).astype(np.complex64)
    weighted = scipy.fft.fft(white, size, axis=1)
    ones = scipy.fft.fft(np.ones(omega.size), size)
    found = []
    for decay in decays:
        shape = 1.0 / (decay + 1j * away)
        # Turned around, and wrapped so that lag 0 is the first.
        turned = np.zeros(size, complex)
        turned[: omega.size] = shape[omega.size - 1 :: -1].conj()
        turned[size - omega.size + 1 :] = shape[: omega.size - 1 : -1].conj()
        filtered = weighted * scipy.fft.fft(turned.astype(np.complex64))
        alike = scipy.fft.ifft(filtered, axis=1, overwrite_x=True)
        total = scipy.fft.ifft(ones * scipy.fft.fft(np.abs(turned) ** 2)).real
        power = np.square(alike[:, : omega.size].view(np.float32)).sum(axis=0)
        found.append(2.0 * (power[::2] + power[1::2]) / total[: omega.size])
    return np.array(found)


def _tried(whole: WholeFit, start: complex) -> complex | None:
    """Return the refined pole where the lines around it need it."""
    pitch = float(np.median(np.diff(whole.lines.laplace.imag)))
    added = float(whole.lines.laplace.real[0])
    group = trial_group(whole, start)
    without = refined_group(whole, group)
    fitted = refined_group(whole, group, start)
    pole = complex(fitted.pole[-1])
    if not _plausible(whole, fitted, pole, pitch):
        return None
    near = np.abs(group.lines.laplace.imag - pole.imag) < max(
        2.0 * (added - pole.real), 5.0 * pitch
    )
    before, after = (_excess(f.residual, group, near) for f in (without, fitted))
    apart = _away(whole.lines, pole, fitted.pole[:-1])
    if not apart and not _own_shape(fitted):
        return None
    share = _EXPLAINED if apart else _ALL_EXPLAINED
    if before < _LEAST_EXCESS or after > (1.0 - share) * before:
        return None
    need = significance(
        group.lines, fitted.residual, fitted.pole, group.noise, fitted.beyond
    )
    return pole if need[-1] > least_significance(whole.lines) else None


def trial_group(whole: WholeFit, start: complex) -> Group:
    """Return the modes and lines around a trial pole.

    On a mode there are as many lines as that mode needs: on fewer, what is left of it
    may pass for modes beyond them.
    """
    pitch = float(np.median(np.diff(whole.lines.laplace.imag)))
    width = float(whole.lines.laplace.real[0]) - start.real
    width = float(np.max(_widths_on(whole, start), initial=width))
    reach = max(_REACH_WIDTHS * width, _REACH_LINES * pitch)
    return group_around(whole, start.imag, reach)


def refined_group(
    whole: WholeFit, group: Group, more: complex | None = None
) -> RefinedPoles:
    """Refine the modes of a group, and a further pole where one is given."""
    start = whole.pole[group.modes]
    return refine_poles(
        group.lines,
        start if more is None else np.append(start, more),
        group.variance,
        beyond=whole.pole[group.beyond],
        steps=_STEPS,
    )


def _plausible(
    whole: WholeFit, fitted: RefinedPoles, pole: complex, pitch: float
) -> bool:
    """Return whether a pole is within the band and known."""
    one = np.array([pole])
    narrow = float(measured_width(whole.lines, one)[0]) < _NARROWEST * pitch
    sd = float(np.sqrt(fitted.covariance[-1, 0, 0] * fitted.inflation[-1]))
    return (
        bool(fitted.converged[-1])
        and not narrow
        and pole.real < 0.0
        and -pole.real < _HIGHEST_DAMPING * abs(pole)
        and sd < _VAGUE * abs(pole.real)
        and not bool(unresolved(whole.lines, one)[0])
    )


def _own_shape(fitted: RefinedPoles) -> bool:
    """Return whether the last mode of a fit has another shape than all others."""
    parts = fitted.fit.coefficients[:, : 2 * fitted.pole.size]
    if parts.shape[0] < _MANY_FRFS:
        return False
    residue = (parts[:, ::2] + 1j * parts[:, 1::2]).T
    return bool(np.all(mac_matrix(residue[-1:], residue[:-1]) < _OWN_SHAPE))


def _away(lines: FrfLines, pole: complex, others: ComplexArray) -> bool:
    """Return whether a pole keeps its distance from others."""
    width = measured_width(lines, np.append(others, pole))
    apart = np.abs(others.imag - pole.imag)
    return bool(np.all(apart > _APART * np.maximum(width[:-1], width[-1])))


def _excess(residual: ComplexArray, group: Group, near: np.ndarray) -> float:
    """Return the residual power over the noise above 1 on some lines [-]."""
    ratio = np.abs(residual[:, near]) ** 2 / group.noise[:, near]
    return max(float(np.mean(ratio)) - 1.0, 0.0)
