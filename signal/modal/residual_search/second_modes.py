# SPDX-License-Identifier: MIT
"""Two modes of rank one fitted in place of one, on the lines around it."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.lsfd import LinearFit
from jointbench.signal.modal.refined_pole_covariance import RefinedPoles
from jointbench.signal.modal.residual_search.peak_sums import PeakLines
from jointbench.signal.modal.residual_search.rank_one_fit import (
    RankOneModes,
    fit_rank_one,
)

# Lines around a mode: half-power half-widths, and lines at least, each side.
_REACH_WIDTHS, _REACH_LINES = 6.0, 12
# Chance that noise in the whole band passes for a second mode.
_CHANCE = 1e-6
# A second mode is one where its pole is no further off than half-power widths.
_LEASH = 1.0
# One mode in its place must leave this many times the chi-squared that two leave, and
# the second singular value be above this share of the first. It is possible with the
# latter, or where two modes explain the lines and leave less than noise would allow.
_GAIN, _LEAST_SHARE = 2.0, 0.003
# Relative sd of an FRF from hit to hit where it is not known: aim, a few per cent.
_UNKNOWN_AIM = 0.02
# Modes around that are fitted along: two pairs side by side are four.
_MOST_OTHERS = 3
_PAIR = 2
# Chi-squared over the number of values up to which two modes explain the lines, and up
# to which the modes around them are taken from the same fit.
_EXPLAINED, _WELL = 5.0, 1.5
# Two references cannot show a third mode closer to a pair than this many half-power
# widths: the residue of a shared pole has rank two.
_AT_ONE_POLE = 0.1
_NONE = np.empty(0, np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class FrfSides:
    """A fit with its FRFs as matrices, the smaller side as references.

    Attributes:
        lines: what was fitted.
        poles: of the modes.
        fit: residues of the modes, and the synthesis.
        variance: noise and model error of each line, shape (n_frf, n_lines).
        scatter: variance of the FRFs from their hits, shape (n_frf, n_lines), or None.
        n_outputs: of the FRF.
        n_inputs: of the FRF.
    """

    lines: FrfLines
    poles: RefinedPoles
    fit: LinearFit
    variance: FloatArray
    scatter: FloatArray | None
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
class SecondModes:
    """Two modes in place of one, and what speaks for them.

    Attributes:
        peak: the lines.
        modes: at the optimum; two in place of each of the first members.
        count: how many members that are.
        gain: chi-squared gained by each second mode [-].
        left: chi-squared that is left, over the number of values [-].
        over_noise: the same without the residual of the whole fit as noise [-].
        accepted: whether the lines need both.
        possible: whether they hint at both.
        members: indices of the mode and of those around that were fitted along.
        stayed: which of the modes around kept their places, shape (n_members - 1,).
        replaced: indices of modes that stood in for the second.
    """

    peak: PeakLines
    modes: RankOneModes
    count: int
    gain: float
    left: float
    over_noise: float
    accepted: bool
    possible: bool
    members: IntArray
    stayed: BoolArray
    replaced: IntArray

    @property
    def complete(self) -> bool:
        """Whether the modes leave no more than a few times the noise."""
        return self.over_noise < _EXPLAINED


def peak_members(lines: FrfLines, pole: ComplexArray, place: int) -> IntArray:
    """Return a mode and those that overlap it, the nearest few at most."""
    width = measured_width(lines, pole)
    apart = np.abs(pole.imag - pole[place].imag)
    near = apart < 2.0 * (width + width[place])
    near[place] = False
    others = np.flatnonzero(near)
    return np.append(place, others[np.argsort(apart[others])][:_MOST_OTHERS])


def second_modes(
    sides: FrfSides, members: IntArray, gone: IntArray = _NONE
) -> SecondModes:
    """Fit two modes in place of the first member, the others along with them.

    Args:
        sides: the fit.
        members: indices of the mode and of those around it.
        gone: of modes that stood in for the second: the lines must do without.
    """
    pole = sides.poles.pole[members]
    peak = _peak(sides, members, gone)
    residue = sides.matrices(sides.fit.residues().T[:, members])
    residue = np.moveaxis(residue, 2, 0)
    leading = np.linalg.svd(residue)[2][:, 0]
    single = fit_rank_one(peak, pole, leading)
    away, into = _left_their_places(sides.lines, pole, single.pole, peak.width)
    if away.any():
        # A mode around has become the second one: two in place of both are tried.
        inside = np.abs(pole.imag - pole[0].imag)[1:] < _REACH_WIDTHS * peak.width
        more = members[1:][into | (away & inside)]
        kept = np.append(members[:1], members[1:][~away])
        without = second_modes(sides, kept, np.append(gone, more))
        # What it is elsewhere may be needed there.
        fits = without.accepted and without.left < _WELL
        return without if fits else second_modes(sides, kept, gone)
    found = _doubled(sides, peak, members, single.cost, 1, gone)
    if found.accepted or found.left < _EXPLAINED or members.size < 2:
        return found
    both = _doubled(sides, peak, members, single.cost, 2, gone)
    return both if both.accepted else found


def without_third(sides: FrfSides, found: SecondModes) -> SecondModes:
    """Return a pair fitted in place of all modes at its pole, where the lines allow it.

    Args:
        sides: the fit.
        found: an accepted pair.
    """
    if min(sides.n_outputs, sides.n_inputs) != _PAIR or found.count > 1:
        return found
    pole, pair = sides.poles.pole, found.modes.pole[:_PAIR]
    apart = np.min(np.abs(pole[:, None] - pair), axis=1)
    near = apart < _AT_ONE_POLE * found.peak.width
    near[found.members[0]] = near[found.replaced] = False
    if not near.any():
        return found
    kept = found.members[~near[found.members]]
    gone = np.append(found.replaced, np.flatnonzero(near))
    alone = second_modes(sides, kept, gone)
    return alone if alone.accepted else found


def _doubled(
    sides: FrfSides,
    peak: PeakLines,
    members: IntArray,
    cost: float,
    count: int,
    gone: IntArray,
) -> SecondModes:
    """Fit two modes in place of each of the first members.

    Args:
        sides: the fit.
        peak: the lines.
        members: the modes.
        cost: chi-squared that one mode for each leaves.
        count: of members that are doubled.
        gone: see `second_modes`.
    """
    pole = sides.poles.pole[members]
    residue = sides.matrices(sides.fit.residues().T[:, members])
    residue = np.moveaxis(residue, 2, 0)
    leading = np.linalg.svd(residue)[2][:, 0]
    starts = [_start(peak, pole, residue[n], n) for n in range(count)]
    double = fit_rank_one(
        peak,
        np.concatenate((*(start for start, _ in starts), pole[count:])),
        np.concatenate((*(turn for _, turn in starts), leading[count:])),
    )
    n_rows, n_references, _ = peak.response.shape
    chance = _CHANCE / sides.lines.laplace.size
    limit = count * chi2_limit(chance, 2 * (n_rows + n_references))
    whole = np.append(np.repeat(pole[:count], 2), pole[count:])
    width = measured_width(sides.lines, whole)
    stays = np.abs(double.pole - whole) / width < 2.0 * _LEASH
    stays &= double.pole.real < 0.0
    size = np.linalg.svd(residue[:count], compute_uv=False)
    share = float(np.min(size[:, 1] / size[:, 0]))
    left = double.cost / (2.0 * peak.response.size)
    gain = cost - double.cost
    factor = max(1.0, float(sides.poles.inflation[members[0]]))
    better = cost > _GAIN * double.cost and left < _EXPLAINED
    aimed = _aimed_share(sides, members[:count])
    gained = gain > limit and share > max(aimed, _LEAST_SHARE)
    return SecondModes(
        peak,
        double,
        count,
        gain / count,
        left,
        left * factor,
        accepted=bool(gained and stays[: 2 * count].all() and better),
        possible=bool(
            size[0, 1] > _LEAST_SHARE * size[0, 0]
            or (gain > limit and left < _EXPLAINED)
        ),
        members=members,
        stayed=np.asarray(stays[2 * count :] & (left < _WELL)),
        replaced=gone,
    )


def _aimed_share(sides: FrfSides, members: IntArray) -> float:
    """Return the second singular value over the first that aim may have made [-].

    Hits off their point change the FRFs of a reference by factors that drift over the
    lines. One mode alone keeps rank one; what the drift leaves of its neighbours on its
    lines does not: the relative sd of the average of the hits times their share there.

    Args:
        sides: the fit.
        members: the modes that are examined.
    """
    lines, poles = sides.lines, sides.poles
    p = poles.pole[members]
    width = float(measured_width(lines, p[:1])[0])
    away = np.abs(lines.laplace.imag - p[0].imag)
    near = away <= max(width, float(away.min()))
    s, response = lines.laplace[near, None], lines.response[:, near]
    modes = sides.fit.residues()[members].T
    own = modes @ (s**lines.derivatives / (s - p)).T
    others = np.sum(np.abs(response - own) ** 2) / np.sum(np.abs(own) ** 2)
    if sides.scatter is None:
        return _UNKNOWN_AIM * float(np.sqrt(others))
    power = np.maximum(np.sum(np.abs(response) ** 2, axis=1), 1e-300)
    scatter = np.sum(sides.scatter[:, near], axis=1) / power
    return float(np.sqrt(np.median(scatter) * others))


def _peak(sides: FrfSides, members: IntArray, gone: IntArray) -> PeakLines:
    """Return the lines around the first member, freed of all modes but those given."""
    lines, poles = sides.lines, sides.poles
    members = np.append(members, gone)
    p = poles.pole[members]
    width = float(measured_width(lines, p[:1])[0])
    pitch = float(np.median(np.diff(lines.laplace.imag)))
    reach = max(_REACH_WIDTHS * width, _REACH_LINES * pitch)
    near = np.abs(lines.laplace.imag - p[0].imag) < reach
    s = lines.laplace[near]
    power = (s**lines.derivatives)[:, None]
    residue = sides.fit.residues()[members].T
    own = residue @ (power / (s[:, None] - p)).T
    own += residue.conj() @ (power / (s[:, None] - p.conj())).T
    left = lines.response[:, near] - sides.fit.synthesis[:, near] + own
    factor = max(1.0, float(poles.inflation[members[0]]))
    variance = sides.variance[:, near] * factor
    return PeakLines(
        s,
        sides.matrices(left),
        sides.matrices(np.sqrt(0.5 * variance)),
        lines.derivatives,
        width,
    )


def _left_their_places(
    lines: FrfLines, before: ComplexArray, after: ComplexArray, width: float
) -> tuple[BoolArray, BoolArray]:
    """Return which modes around the first moved away, and which into its peak.

    A broad computational pole beside a pair becomes its second mode within its own
    half-power width.
    """
    moved = np.abs(after - before)[1:]
    own, narrow = measured_width(lines, before[1:]), measured_width(lines, after[1:])
    into = (np.abs(after[1:] - after[0]) < width) & (moved > np.minimum(own, narrow))
    return np.asarray((moved > own) | into), np.asarray(into)


def _start(
    peak: PeakLines, pole: ComplexArray, residue: ComplexArray, number: int
) -> tuple[ComplexArray, ComplexArray]:
    """Return two poles and their references from the residue and its slope.

    Two modes near p have R1 + R2 over s - p and d1 R1 + d2 R2 over its square; within
    the two leading directions the shifts d solve B w = d A w.
    """
    left, _, right = np.linalg.svd(residue, full_matrices=False)
    s, own = peak.laplace[:, None], pole[number]
    columns = np.hstack((1.0 / (s - own), 1.0 / (s - own) ** 2, 1.0 / (s - pole)))
    basis = np.delete(columns, 2 + number, axis=1) * s**peak.derivatives
    flat = peak.response.reshape(-1, s.size)
    found = np.linalg.lstsq(basis, flat.T, rcond=None)[0][:2]
    sums = found.reshape(2, *residue.shape)
    inner = left[:, :2].conj().T @ sums @ right[:2].conj().T
    shift, turn = np.linalg.eig(np.linalg.solve(inner[0], inner[1]))
    size, most = np.abs(shift), -0.5 * own.real
    shift = np.where(size > most, most * shift / size, shift)
    return own + shift, np.linalg.inv(turn) @ right[:2]
