# SPDX-License-Identifier: MIT
"""Two modes at one frequency: recognised by the rank of the residue.

A symmetric structure has pairs of modes that share a pole, or nearly. One reference
shows one of them. With two, the residue of the shared pole has rank two, and two
singular values of the FRF matrix peak together. Where rank one cannot explain the lines
around a mode, two modes of rank one are fitted in its place; where the data hint at a
second one and do not show it, that is stated.
"""

from dataclasses import fields, replace
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.signal.modal.frf_lines import FrfLines
from jointbench.signal.modal.modal_model import ModalModel, split_residues
from jointbench.signal.modal.mode_selection import FittedModes
from jointbench.signal.modal.residual_search.rank_one_fit import covariance
from jointbench.signal.modal.residual_search.second_modes import (
    FrfSides,
    SecondModes,
    peak_members,
    second_modes,
    without_third,
)
from jointbench.signal.modal.second_mode_words import second_mode_words

# Chance that noise passes for a residue of rank two, from which it is looked into.
_HINT = 1e-3


def separate_repeated(
    model: ModalModel,
    lines: FrfLines,
    fitted: FittedModes,
    scatter: FloatArray | None,
) -> tuple[ModalModel, tuple[str, ...]]:
    """Replace modes whose residue has rank two by two modes.

    Args:
        model: built from the fit.
        lines: what was fitted.
        fitted: the modes.
        scatter: variance of the FRFs from their hits, shape (n_frf, n_lines), or None.

    Returns:
        The model with both modes of each pair, and a sentence on every mode where a
        second one is possible but not shown.
    """
    sides = FrfSides(
        lines,
        fitted.poles,
        fitted.fit,
        fitted.variance,
        scatter,
        len(model.outputs),
        len(model.inputs),
    )
    if min(sides.n_outputs, sides.n_inputs) < 2:
        return model, ()
    order = np.argsort(np.abs(fitted.poles.pole))
    row_of = np.argsort(order)
    left, pieces = set(range(order.size)), []
    hints: list[float] = []
    for number, place in enumerate(order):
        if number not in left or not _second_rank(model, number):
            continue
        members = peak_members(lines, fitted.poles.pole, int(place))
        members = members[np.isin(row_of[members], list(left))]
        found = second_modes(sides, members)
        if found.accepted:
            found = without_third(sides, found)
            gone, members = row_of[found.replaced].tolist(), found.members
            used = np.append(np.ones(2 * found.count, bool), found.stayed)
            pieces.append(_rows_of(model, row_of[members], sides, found, used))
            own, around = np.split(row_of[members], [found.count])
            along = around[found.stayed].tolist()
            left -= {*own.tolist(), *along, *gone}
            # One split a cluster: what else may be hidden in it is only remarked on.
            frequency = np.abs(found.modes.pole[used]) / (2.0 * np.pi)
            pairs, frequency = np.split(frequency, [2 * found.count])
            half = found.peak.width / (2.0 * np.pi)
            hints.extend([] if found.complete else pairs.tolist())
            hints.extend(
                float(f)
                for f, n in zip(frequency, along, strict=True)
                if _second_rank(model, n) or np.min(np.abs(f - pairs)) < half
            )
        elif found.possible:
            hints.append(float(model.natural_frequency[number]))
    pieces.append(_rows(model, np.array(sorted(left), np.int64)))
    whole = _joined(model, pieces)
    matrices = sides.matrices(lines.response)
    return whole, second_mode_words(whole, lines, matrices, hints)


def _second_rank(model: ModalModel, number: int, chance: float = _HINT) -> bool:
    """Return whether a residue matrix differs from rank one by more than noise."""
    residue, sd = model.residues[number], model.residues_sd[number]
    left, scale, right = np.linalg.svd(residue, full_matrices=False)
    rest = residue - scale[0] * np.outer(left[:, 0], right[0])
    floor = 1e-12 * float(np.abs(residue).max())
    power = (rest.real / np.maximum(sd.real, floor)) ** 2
    power += (rest.imag / np.maximum(sd.imag, floor)) ** 2
    dof = 2 * (residue.shape[0] - 1) * (residue.shape[1] - 1)
    return bool(power.sum() > chi2_limit(chance, dof))


_Piece = dict[str, np.ndarray]


def _rows(model: ModalModel, numbers: IntArray) -> _Piece:
    return {
        f.name: getattr(model, f.name)[numbers]
        for f in fields(model)
        if isinstance(getattr(model, f.name), np.ndarray)
    }


def _rows_of(
    model: ModalModel,
    numbers: IntArray,
    sides: FrfSides,
    found: SecondModes,
    used: BoolArray,
) -> _Piece:
    """Return the rows of a split mode and of the used ones of those around it."""
    pole = found.modes.pole
    spread, variance = covariance(found.peak, found.modes)
    size = np.abs(pole)
    along = np.stack((pole.real, pole.imag), axis=1) / size[:, None]
    across = np.stack((-(pole.imag**2), pole.real * pole.imag), axis=1)
    across = across / size[:, None] ** 3
    residues = sides.residues(found.modes)
    shapes, participation = split_residues(residues)
    sd = np.sqrt(sides.turned(variance))
    twice = np.append(np.repeat(numbers[: found.count], 2), numbers[found.count :])
    rows = _rows(model, twice)
    significance = rows["significance"].copy()
    significance[1 : 2 * found.count : 2] = found.gain
    frequency_sd = np.sqrt(_quadratic(along, spread)) / (2.0 * np.pi)
    damping_sd = np.sqrt(_quadratic(across, spread))
    rows = rows | {
        "natural_frequency": size / (2.0 * np.pi),
        # What is fixed here had errors of its own in the fit of all lines.
        "frequency_sd": np.maximum(frequency_sd, rows["frequency_sd"]),
        "damping_ratio": -pole.real / size,
        "damping_ratio_sd": np.maximum(damping_sd, rows["damping_ratio_sd"]),
        "residues": residues,
        "residues_sd": sd[..., 0] + 1j * sd[..., 1],
        "shapes": shapes,
        "shapes_sd": _shapes_sd(sd, participation),
        "participation": participation,
        "significance": significance,
    }
    return {name: values[used] for name, values in rows.items()}


def _quadratic(row: FloatArray, matrix: FloatArray) -> FloatArray:
    return np.asarray(np.maximum(np.einsum("mi,mij,mj->m", row, matrix, row), 0.0))


def _shapes_sd(sd: FloatArray, participation: ComplexArray) -> ComplexArray:
    """Return the sd of shapes, from the input that drives each mode most."""
    best = np.argmax(np.abs(participation), axis=1)
    index = np.arange(best.size)
    parts = sd[index, :, best] / np.abs(participation[index, best])[:, None, None]
    return np.asarray(parts[..., 0] + 1j * parts[..., 1])


def _joined(model: ModalModel, pieces: list[_Piece]) -> ModalModel:
    whole = {k: np.concatenate([p[k] for p in pieces]) for k in pieces[0]}
    order = np.argsort(whole["natural_frequency"], kind="stable")
    ordered: dict[str, Any] = {k: v[order] for k, v in whole.items()}
    return replace(model, **ordered)
