# SPDX-License-Identifier: MIT
"""Peaks at multiples of a mode's frequency that a nonlinear joint makes, and no mode.

The force of a joint that slips or stiffens has harmonics of the motion. Under the free
decay of a strong mode the second or third harmonic decays like a mode of its own, two
or three times as high, one to three times as fast, and far weaker; higher harmonics and
sums of several modes make further weak peaks. Hits of several levels distinguish them
from modes: such a peak changes with the level by as much as it is high. Without levels,
place, decay and size alone may be chance: a peak with all three is left out only where
the lines do not determine its damping; else it stays, with a remark on what it may be.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.records.provenance import step
from jointbench.signal.frf.frf import Frf
from jointbench.signal.frf.linearity import Linearity
from jointbench.signal.modal.modal_model import ModalModel

# Symmetric joints have odd harmonics; unsymmetric ones (openings) even ones as well.
_ORDERS = (2, 3)
# Residue of a harmonic over that of its mode, at most: those of simulated joints are
# 3e-5 to 2e-3, those of modes above 1e-2 but where all sensors are near nodes.
_WEAKER = 0.01
# Standard deviations within which place and decay agree.
_AGREES = 2.6
# Relative sd of the damping from which it is not known.
_VAGUE = 1.0 / 3.0
# Change of a peak for a doubling of the force, as a share of the peak: 0 for a mode,
# ln 2 for what grows with the square of the force, twice that for a cubic spring. What
# changes by more is another mode's.
_GROWS, _MOST = 0.35, 3.0
# Lines whose change is that of the peak, and those beside it, in half-power
# half-widths; power of the change at the peak over that beside it, at least.
_PEAK, _BESIDE, _STANDS_OUT = 1.0, (3.0, 8.0), 6.0


@dataclass(frozen=True, slots=True)
class Harmonic:
    """A mode that may be a harmonic of another.

    Attributes:
        mode: its index.
        of: index of the stronger one.
        order: of the harmonic, 2 or 3.
    """

    mode: int
    of: int
    order: int


def possible_harmonics(model: ModalModel) -> tuple[Harmonic, ...]:
    """Return the modes whose place, decay and size are those of a harmonic.

    Args:
        model: all modes of a structure; those kept by hand are no harmonics.
    """
    size, found = _sizes(model), []
    for mode in np.flatnonzero(~model.by_hand):
        pairs = [
            Harmonic(int(mode), int(of), order)
            for of in np.flatnonzero(size * _WEAKER > size[mode])
            for order in _ORDERS
            if _agrees(model, int(mode), int(of), order)
        ]
        if pairs:
            found.append(max(pairs, key=lambda pair: float(size[pair.of])))
    return tuple(found)


def _agrees(model: ModalModel, mode: int, of: int, order: int) -> bool:
    """Return whether frequency and decay rate are those of a harmonic.

    The stronger mode's frequency at large amplitude may be a half-width off. A harmonic
    decays as fast as its mode where the joint slips fully, and `order` times as fast
    where its force is that power of the motion.
    """
    f, f_sd = model.natural_frequency, model.frequency_sd
    z, z_sd = model.damping_ratio, model.damping_ratio_sd
    reach = _AGREES * float(np.hypot(f_sd[mode], order * f_sd[of]))
    reach += order * float(z[of] * f[of])
    decay, spread = float(z[mode] * f[mode]), _AGREES * float(z_sd[mode] * f[mode])
    slow, fast = float(z[of] * f[of]), order * float(z[of] * f[of])
    near = abs(float(f[mode] - order * f[of])) < reach
    return near and slow / 1.5 - spread < decay < 1.5 * fast + spread


def without_vague_harmonics(model: ModalModel) -> tuple[ModalModel, tuple[str, ...]]:
    """Leave out harmonics whose damping the lines do not determine.

    Args:
        model: all modes of a structure.

    Returns:
        The model, and a sentence on each harmonic, left out or not.
    """
    vague = model.damping_ratio_sd > _VAGUE * np.abs(model.damping_ratio)
    pairs = possible_harmonics(model)
    out = [pair for pair in pairs if vague[pair.mode]]
    left = [pair for pair in pairs if not vague[pair.mode]]
    words = (
        *(
            f"{_named(model, pair)}, and the lines do not determine its damping: left "
            f"out as a harmonic of a joint's force; {_WAY_OUT}"
            for pair in out
        ),
        *(
            f"{_named(model, pair)}: a mode near a node of every sensor, or a harmonic "
            "of a joint's force; hit softly and hard in turn to decide"
            for pair in left
        ),
    )
    return _without(model, [pair.mode for pair in out]), words


_WAY_OUT = "hits of several levels would show what it is, and --keep keeps it"


def without_growing_harmonics(
    model: ModalModel, remarks: Sequence[str], frf: Frf, linearity: Linearity | None
) -> tuple[ModalModel, tuple[str, ...]]:
    """Leave out weak peaks that change with the level of the hits.

    Args:
        model: all modes of a structure.
        remarks: on it; those on peaks that the hits decide are replaced.
        frf: that it was fitted to.
        linearity: of the same hits; None leaves model and remarks as they are.

    Returns:
        The model, and the remarks with a sentence on each peak that was left out.
    """
    if linearity is None:
        return model, tuple(remarks)
    size = _sizes(model)
    weak = (size < _WEAKER * size.max(initial=0.0)) & ~model.by_hand
    growth = {
        int(mode): _growth(model, frf, linearity, int(mode))
        for mode in np.flatnonzero(weak)
    }
    out = [mode for mode, share in growth.items() if _GROWS < share < _MOST]
    pairs = {pair.mode: pair for pair in possible_harmonics(model)}
    decided = tuple(_named(model, pairs[mode]) for mode in growth if mode in pairs)
    left = [words for words in remarks if not decided or not words.startswith(decided)]
    words = tuple(
        (_named(model, pairs[mode]) if mode in pairs else _weak_peak(model, mode))
        + f", and changes by {100.0 * growth[mode]:.2g} % for a doubling of the force: "
        "left out as a harmonic of a joint's force or a sum of several modes; --keep "
        "keeps it"
        for mode in out
    )
    return _without(model, out), (*words, *left)


def _growth(model: ModalModel, frf: Frf, linearity: Linearity, mode: int) -> float:
    """Return the change of a peak for a doubling of the force, over the peak [-].

    What the lines beside it change as well is noise, or that of other modes.
    """
    at = np.searchsorted(frf.frequency, linearity.frequency)
    level = np.sum(np.abs(frf.response[:, :, at]) ** 2, axis=(0, 1))
    s = 2j * np.pi * linearity.frequency + frf.added_decay_rate
    pole = model.poles[mode]
    shape = np.abs(s**frf.kind.derivatives / (s - pole)) ** 2
    own = float(np.sum(np.abs(model.residues[mode]) ** 2)) * shape
    change = linearity.change**2 * level
    width = abs(pole.real - frf.added_decay_rate) / (2.0 * np.pi)
    away = np.abs(linearity.frequency - abs(pole.imag) / (2.0 * np.pi))
    peak = away <= max(_PEAK * width, float(away.min()))
    beside = (away > _BESIDE[0] * width) & (away < _BESIDE[1] * width)
    rest = float(np.median(change[beside])) if beside.any() else 0.0
    excess = float(np.mean(change[peak])) - rest
    if excess < (_STANDS_OUT - 1.0) * rest:
        return 0.0
    return float(np.sqrt(max(excess, 0.0) / max(float(np.mean(own[peak])), 1e-300)))


def _sizes(model: ModalModel) -> FloatArray:
    """Return the rms residue of each mode over the pairs."""
    return np.asarray(np.sqrt(np.mean(np.abs(model.residues) ** 2, axis=(1, 2))))


def _weak_peak(model: ModalModel, mode: int) -> str:
    size = _sizes(model)
    return (
        f"the peak at {model.natural_frequency[mode]:.6g} Hz has "
        f"{100.0 * size[mode] / size.max():.1g} % of the largest residue"
    )


def _named(model: ModalModel, pair: Harmonic) -> str:
    f, size = model.natural_frequency, _sizes(model)
    times, share = f[pair.mode] / f[pair.of], size[pair.mode] / size[pair.of]
    return (
        f"the peak at {f[pair.mode]:.6g} Hz is at {times:.4g} times the frequency of "
        f"the mode at {f[pair.of]:.6g} Hz, with {100.0 * share:.1g} % of its residue"
    )


def _without(model: ModalModel, out: Sequence[int]) -> ModalModel:
    """Return the model without some modes; the fit of the others contains them."""
    if not out:
        return model
    keep: BoolArray = np.ones(model.natural_frequency.size, bool)
    keep[list(out)] = False
    rows: dict[str, Any] = {
        field.name: getattr(model, field.name)[keep]
        for field in fields(model)
        if isinstance(getattr(model, field.name), np.ndarray)
    }
    done = step("leave_out_harmonics", modes=len(out))
    return replace(model, provenance=(*model.provenance, done), **rows)
