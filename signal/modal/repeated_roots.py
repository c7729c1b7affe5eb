# SPDX-License-Identifier: MIT
"""Two modes at one frequency: recognised by the rank of the residue, and fitted.

A symmetric structure has pairs of modes that share a pole, or nearly. One reference
shows one of them. With two, the residue of the shared pole has rank two, and two
singular values of the FRF matrix peak together. Where rank one cannot explain the lines
around a mode, two modes of rank one are fitted in its place; where the data hint at a
second one and do not show it, that is stated.
"""

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.modal_model import ModalModel, split_residues
from jointbench.signal.modal.mode_selection import FittedModes
from jointbench.signal.modal.rank_one_fit import (
    PeakLines,
    RankOneModes,
    covariance,
    fit_rank_one,
)
from jointbench.signal.modal.second_mode_words import second_mode_words

# Lines around a mode: half-power half-widths, and lines at least, each side.
_REACH_WIDTHS, _REACH_LINES = 6.0, 12
# Chance that noise in the whole band passes for a second mode; that it is remarked on.
_CHANCE, _HINT = 1e-6, 1e-3
# A second mode is one where its pole is no further off than half-power widths.
_LEASH = 1.0
# One mode in its place must leave this many times the chi-squared that two leave; else
# a second singular value above this share of the first makes it possible.
_GAIN, _LEAST_SHARE = 2.0, 0.003
# Second singular value over the first up to which the aim of the hammer explains it:
# hits a few per cent off their point give residues of rank two.
_AIMED = 0.02
_MOST_OTHERS = 2
# Chi-squared over the number of values up to which two modes explain the lines, and up
# to which the modes around them are taken from the same fit.
_EXPLAINED, _WELL = 5.0, 1.5


@dataclass(frozen=True, slots=True, eq=False)
class _Sides:
    """A fit with its FRFs as matrices, the smaller side as references.

    Attributes:
        lines: what was fitted.
        fitted: the modes.
        n_outputs: of the FRF.
        n_inputs: of the FRF.
    """

    lines: FrfLines
    fitted: FittedModes
    n_outputs: int
    n_inputs: int

    def matrices(self, rows: ComplexArray | FloatArray) -> np.ndarray:
        """Return (n_frf, n) as (n_rows, n_references, n)."""
        apart = rows.reshape(self.n_outputs, self.n_inputs, -1)
        swapped = self.n_inputs > self.n_outputs
        return apart.transpose(1, 0, 2) if swapped else apart

    def residues(self, modes: RankOneModes) -> ComplexArray:
        """Return residue matrices, shape (n_modes, n_outputs, n_inputs)."""
        found = modes.shape[:, :, None] * modes.reference[:, None]
        return self.turned(found)

    def turned(self, found: np.ndarray) -> np.ndarray:
        """Return (n_modes, n_rows, n_references, ...) with outputs first."""
        swapped = self.n_inputs > self.n_outputs
        return found.swapaxes(1, 2) if swapped else found


@dataclass(frozen=True, slots=True, eq=False)
class _Split:
    """Two modes in place of one, and what speaks for them.

    Attributes:
        peak: the lines.
        modes: at the optimum; the first two in place of one.
        gain: chi-squared gained by the second [-].
        accepted: whether the lines need both.
        possible: whether they hint at both.
        stayed: which of the modes around kept their places, shape (n_members - 1,).
        replaced: indices of modes that stood in for the second.
    """

    peak: PeakLines
    modes: RankOneModes
    gain: float
    accepted: bool
    possible: bool
    stayed: BoolArray
    replaced: IntArray


def separate_repeated(
    model: ModalModel, lines: FrfLines, fitted: FittedModes
) -> tuple[ModalModel, tuple[str, ...]]:
    """Replace modes whose residue has rank two by two modes.

    Args:
        model: built from the fit.
        lines: what was fitted.
        fitted: the modes.

    Returns:
        The model with both modes of each pair, and a sentence on every mode where a
        second one is possible but not shown.
    """
    sides = _Sides(lines, fitted, len(model.outputs), len(model.inputs))
    if min(sides.n_outputs, sides.n_inputs) < 2:
        return model, ()
    order = np.argsort(np.abs(fitted.poles.pole))
    row_of = np.argsort(order)
    left, pieces = set(range(order.size)), []
    hints: list[float] = []
    for number, place in enumerate(order):
        if number not in left or not _second_rank(model, number):
            continue
        members = _members(lines, fitted.poles.pole, int(place))
        members = members[np.isin(row_of[members], list(left))]
        found = _split(sides, members)
        if found.accepted:
            gone = row_of[found.replaced].tolist()
            members = members[~np.isin(members, found.replaced)]
            used = np.append([True, True], found.stayed)
            pieces.append(_rows_of(model, row_of[members], sides, found, used))
            along = row_of[members[1:][found.stayed]].tolist()
            left -= {number, *along, *gone}
            # One split a cluster: what else may be hidden in it is only remarked on.
            frequency = np.abs(found.modes.pole[used][2:]) / (2.0 * np.pi)
            hints.extend(
                float(f)
                for f, n in zip(frequency, along, strict=True)
                if _second_rank(model, n)
            )
        elif found.possible:
            hints.append(float(model.natural_frequency[number]))
    pieces.append(_rows(model, np.array(sorted(left), np.int64)))
    whole = _joined(model, pieces)
    matrices = sides.matrices(lines.response)
    return whole, second_mode_words(whole, lines, matrices, hints)


def _members(lines: FrfLines, pole: ComplexArray, place: int) -> IntArray:
    """Return a mode and those that overlap it, the nearest two at most."""
    width = measured_width(lines, pole)
    apart = np.abs(pole.imag - pole[place].imag)
    near = apart < 2.0 * (width + width[place])
    near[place] = False
    others = np.flatnonzero(near)
    return np.append(place, others[np.argsort(apart[others])][:_MOST_OTHERS])


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


def _peak(sides: _Sides, members: IntArray) -> PeakLines:
    """Return the lines around the first member, freed of all modes but the members."""
    lines, poles = sides.lines, sides.fitted.poles
    p = poles.pole[members]
    width = float(measured_width(lines, p[:1])[0])
    pitch = float(np.median(np.diff(lines.laplace.imag)))
    reach = max(_REACH_WIDTHS * width, _REACH_LINES * pitch)
    near = np.abs(lines.laplace.imag - p[0].imag) < reach
    s = lines.laplace[near]
    power = (s**lines.derivatives)[:, None]
    residue = sides.fitted.fit.residues()[members].T
    own = residue @ (power / (s[:, None] - p)).T
    own += residue.conj() @ (power / (s[:, None] - p.conj())).T
    left = lines.response[:, near] - sides.fitted.fit.synthesis[:, near] + own
    factor = max(1.0, float(poles.inflation[members[0]]))
    variance = sides.fitted.variance[:, near] * factor
    return PeakLines(
        s,
        sides.matrices(left),
        sides.matrices(np.sqrt(0.5 * variance)),
        lines.derivatives,
        width,
    )


def _split(sides: _Sides, members: IntArray) -> _Split:
    """Fit two modes in place of the first member, the others along with them."""
    pole = sides.fitted.poles.pole[members]
    peak = _peak(sides, members)
    residue = sides.matrices(sides.fitted.fit.residues().T[:, members])
    residue = np.moveaxis(residue, 2, 0)
    leading = np.linalg.svd(residue)[2][:, 0]
    single = fit_rank_one(peak, pole, leading)
    away = np.abs(single.pole - pole)[1:] > measured_width(sides.lines, pole[1:])
    if away.any():
        # A mode around has become the second one: two in place of both are tried.
        again = _split(sides, np.append(members[:1], members[1:][~away]))
        inside = np.abs(pole.imag - pole[0].imag)[1:] < _REACH_WIDTHS * peak.width
        gone = np.append(again.replaced, members[1:][away & inside])
        return replace(again, replaced=gone.astype(np.int64))
    start, reference = _start(peak, complex(pole[0]), residue[0])
    double = fit_rank_one(
        peak,
        np.concatenate((start, pole[1:])),
        np.concatenate((reference, leading[1:])),
    )
    n_rows, n_references, _ = peak.response.shape
    chance = _CHANCE / sides.lines.laplace.size
    limit = chi2_limit(chance, 2 * (n_rows + n_references))
    width = np.append(np.full(2, peak.width), measured_width(sides.lines, pole[1:]))
    moved = np.abs(double.pole - np.concatenate((pole[:1], pole))) / width
    stays = (moved < 2.0 * _LEASH) & (double.pole.real < 0.0)
    size = np.linalg.svd(residue[0], compute_uv=False)
    left = double.cost / (2.0 * peak.response.size)
    better = single.cost > _GAIN * double.cost and left < _EXPLAINED
    gained = single.cost - double.cost > limit and size[1] > _AIMED * size[0]
    return _Split(
        peak,
        double,
        single.cost - double.cost,
        accepted=bool(gained and stays[:2].all() and better),
        possible=bool(size[1] > _LEAST_SHARE * size[0]),
        stayed=np.asarray(stays[2:] & (left < _WELL)),
        replaced=np.empty(0, np.int64),
    )


def _start(
    peak: PeakLines, pole: complex, residue: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return two poles and their references from the residue and its slope.

    Two modes near p have R1 + R2 over s - p and d1 R1 + d2 R2 over its square; within
    the two leading directions the shifts d solve B w = d A w.
    """
    left, _, right = np.linalg.svd(residue, full_matrices=False)
    s = peak.laplace
    basis = np.stack((1.0 / (s - pole), 1.0 / (s - pole) ** 2), axis=1)
    basis = basis * (s**peak.derivatives)[:, None]
    flat = peak.response.reshape(-1, s.size)
    found = np.linalg.lstsq(basis, flat.T, rcond=None)[0]
    sums = found.reshape(2, *residue.shape)
    inner = left[:, :2].conj().T @ sums @ right[:2].conj().T
    shift, turn = np.linalg.eig(np.linalg.solve(inner[0], inner[1]))
    size = np.abs(shift)
    shift = np.where(size > 0.5 * peak.width, 0.5 * peak.width * shift / size, shift)
    return pole + shift, np.linalg.inv(turn) @ right[:2]


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
    sides: _Sides,
    found: _Split,
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
    rows = _rows(model, np.append(numbers[:1], numbers))
    significance = rows["significance"].copy()
    significance[1] = found.gain
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
