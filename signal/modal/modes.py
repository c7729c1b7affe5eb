# SPDX-License-Identifier: MIT
"""Identify the modes of a structure from its FRF."""

from dataclasses import dataclass, field
from functools import partial

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    freeze,
)
from jointbench.acquisition.basics.errors import NoModeFound, UsageError
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.records.provenance import Step, step
from jointbench.signal.frf.band import choose_band, force_nulls, null_words
from jointbench.signal.frf.frf import Frf
from jointbench.signal.frf.line_weights import weights_of
from jointbench.signal.kalman.process_models import StageGain
from jointbench.signal.kalman.stage_provenance import stage_gain_of
from jointbench.signal.modal.chosen_poles.frf_parts import (
    force_noise_of,
    missed_share,
    scatter_of,
    synthesis_of,
)
from jointbench.signal.modal.frf_lines import lines_of
from jointbench.signal.modal.lscf import Progress, fit_poles
from jointbench.signal.modal.manual_selection import Choices, overrule
from jointbench.signal.modal.modal_model import ModalModel, build_model
from jointbench.signal.modal.mode_selection import FittedModes, fit_modes
from jointbench.signal.modal.repeated_roots import separate_repeated
from jointbench.signal.modal.residual_search.doubtful_neighbours import neighbour_words
from jointbench.signal.modal.response_harmonics import without_vague_harmonics
from jointbench.signal.modal.stabilisation import (
    Stabilisation,
    StabilityLimits,
    candidates,
    from_residual,
    recurs,
    stabilise,
)

_LOWEST_ORDER = 2
_HIGHEST_ORDER = 100
_ORDERS_TRIED = 50
# An order needs at least this many lines for each coefficient it adds.
_LINES_PER_ORDER = 6
# Largest accepted order; beyond it a fit takes hours and fits noise.
_LARGEST_ORDER = 200
_LEAST_LINES_PER_ORDER = 2


@dataclass(frozen=True, slots=True)
class ModalSettings:
    """Settings of the modal identification.

    Attributes:
        band: lowest and highest frequency [Hz], or None for the automatic choice.
        highest_order: of the fit, 2 or more, or None for 100 over the number of
            references, the smaller of outputs and inputs.
        stability: criteria of a stable pole.
        refine: whether poles are refined by nonlinear least squares.
        choices: poles kept or dropped by hand.
    """

    band: tuple[float, float] | None = None
    highest_order: int | None = None
    stability: StabilityLimits = field(default_factory=StabilityLimits)
    refine: bool = True
    choices: Choices = field(default_factory=Choices)


@dataclass(frozen=True, slots=True, eq=False)
class ModalResult:
    """Result of `identify_modes`.

    Attributes:
        model: the modes.
        stabilisation: poles of all orders.
        synthesis: FRF of the model on the lines of the band.
        synthesis_error: rms over all pairs of measured less synthesised FRF, as a share
            of the rms of the FRF on that line [-], shape (n_lines,).
        settings: as requested.
        band: lowest and highest fitted line [Hz].
        stage_gain: gain of the Kalman stage at each mode, or None without one.
        remarks: possible further modes that the data do not resolve, a sentence each.
    """

    model: ModalModel
    stabilisation: Stabilisation
    synthesis: Frf
    synthesis_error: FloatArray
    settings: ModalSettings
    band: tuple[float, float]
    stage_gain: StageGain | None = None
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Make the error read-only."""
        freeze(self, "synthesis_error")


@one_thread()
def identify_modes(
    frf: Frf,
    settings: ModalSettings | None = None,
    *,
    progress: Progress | None = None,
) -> ModalResult:
    """Identify the modes of an FRF without start values.

    The steps are: poles of all orders (LSCF), stable poles (stabilisation), significant
        poles (selection), refinement by nonlinear least squares, residues (LSFD).

    Where the residual shows a resonance, the mode is added; where it hints at one, the
    intervals of its neighbours include it and a remark names the frequency.

    Standard uncertainties are linearised at the optimum from the line variances, times
    the factor by which the residual around each mode exceeds them (on real hits leakage
    and small local modes dominate over noise, and they are correlated from line to
    line), plus a part from errors that all FRFs of a reference share. A jackknife over
    hits is not used: the hits of one session share those errors, so it would not
    include them. The variance of a pole that could not be refined includes the scatter
    over orders.

    Args:
        frf: any kind, any number of outputs and inputs.
        settings: see `ModalSettings`; None for the defaults.
        progress: called with the current step and its share; None for no reports.

    Returns:
        The modal model with its evidence.

    Raises:
        NoModeFound: no pole is stable and needed, or a response is zero throughout.
        BadData: the band holds too few lines.
        UsageError: the requested highest order is out of range.
    """
    settings = settings or ModalSettings()
    _require_alive(frf)
    keep, reason = choose_band(frf, settings.band)
    null = force_nulls(frf, keep)
    nulls, keep = null_words(frf.frequency, null), keep & ~null
    table, weighed = _stabilisation(frf, keep, settings, progress)
    found = candidates(table, settings.stability)
    found = overrule(found, table, settings.choices)
    lines = lines_of(frf, keep)
    start = np.array([c.pole for c in found], complex)
    scatter = scatter_of(frf, keep)
    fitted = fit_modes(
        lines,
        start,
        scatter,
        held=np.array([c.by_hand for c in found], bool),
        seen=None if settings.choices.drop else partial(recurs, table),
        force=force_noise_of(frf, keep),
        refine=settings.refine,
        progress=progress,
    )
    if fitted.chosen.size == 0:
        raise NoModeFound(
            f"none of {start.size} stable poles rises above the noise, orders "
            f"{table.orders[0]} to {table.orders[-1]}, {reason}; "
            + "; ".join((*nulls, "give another band or more hits"))
        )
    more = fitted.candidates[start.size :]
    found = (*found, *(from_residual(table, complex(pole)) for pole in more))
    done = _record(reason, weighed, table, start.size, fitted, settings.choices)
    model = build_model(frf, fitted, found, (*frf.provenance, done))
    model, remarks = separate_repeated(model, lines, fitted, scatter)
    model, harmonics = without_vague_harmonics(model)
    return ModalResult(
        model=model,
        stabilisation=table,
        synthesis=synthesis_of(frf, keep, fitted),
        synthesis_error=missed_share(lines, fitted),
        settings=settings,
        band=(float(frf.frequency[keep][0]), float(frf.frequency[keep][-1])),
        stage_gain=stage_gain_of(frf.provenance, model.natural_frequency),
        remarks=(*remarks, *nulls, *harmonics, *neighbour_words(fitted.doubts)),
    )


def _stabilisation(
    frf: Frf, keep: BoolArray, settings: ModalSettings, progress: Progress | None
) -> tuple[Stabilisation, str]:
    """Return the poles of all orders, and the source of the line weights."""
    response = references_last(frf.response[:, :, keep])
    orders = orders_to_try(settings, response.shape[2], response.shape[1])
    weight, source = weights_of(frf, keep)
    poles = fit_poles(
        frf.frequency[keep],
        response,
        orders,
        weight=weight,
        # One pole per mode gives the clearer table; refinement includes mirror images.
        mirrored=False,
        added_decay_rate=frf.added_decay_rate,
        progress=progress,
    )
    return stabilise(poles, settings.stability), source


def references_last(response: ComplexArray) -> ComplexArray:
    """Return the FRF matrix with no more columns than rows.

    Every input adds a pole to each order, so that twelve hit points and one
    accelerometer would leave eight orders of twelve poles each. Maxwell's reciprocity
    lets either side be the references: the smaller one is. Poles need no more; residues
    are fitted to the matrix as measured, so that shapes and participation keep their
    sides.

    Args:
        response: shape (n_outputs, n_inputs, n_lines).

    Returns:
        The same, or its transpose, shape (n_inputs, n_outputs, n_lines), where there
        are more inputs than outputs.

    Source:
        Ewins, Modal Testing (2000), sec. 1.4 and 3.8.
    """
    swapped = response.shape[1] > response.shape[0]
    return response.transpose(1, 0, 2) if swapped else response


def orders_to_try(
    settings: ModalSettings, n_lines: int, n_inputs: int
) -> tuple[int, ...]:
    """Return the orders of the fit, about fifty at most.

    Args:
        settings: `highest_order` is used as given.
        n_lines: lines in the band.
        n_inputs: references; each order has as many poles.

    Returns:
        Ascending orders.

    Raises:
        UsageError: the requested highest order is below 2, or beyond 200 or one pole
            for every two lines.
    """
    highest = settings.highest_order
    if highest is None:
        fitting = n_lines // (_LINES_PER_ORDER * n_inputs)
        highest = max(_LOWEST_ORDER + 4, min(round(_HIGHEST_ORDER / n_inputs), fitting))
    else:
        carried = n_lines // (_LEAST_LINES_PER_ORDER * n_inputs)
        limit = max(_LOWEST_ORDER, min(_LARGEST_ORDER, carried))
        if not _LOWEST_ORDER <= highest <= limit:
            raise UsageError(
                f"order is {highest}; give {_LOWEST_ORDER} to {limit} ({n_lines} lines "
                f"in the band, {n_inputs} input{'s' * (n_inputs > 1)}), or none"
            )
    pitch = max(1, -(-(highest - _LOWEST_ORDER) // _ORDERS_TRIED))
    return tuple(range(highest, _LOWEST_ORDER - 1, -pitch))[::-1]


def _require_alive(frf: Frf) -> None:
    """Raise `NoModeFound` with the names of responses that are zero on every line."""
    dead = ~np.any(frf.response, axis=2)
    if dead.any():
        names = sorted({frf.outputs[row] for row in np.flatnonzero(dead.any(axis=1))})
        raise NoModeFound(
            f"the FRF of {', '.join(map(repr, names))} is zero on every line: a dead "
            "channel; check its cable and measure again, or leave it out"
        )


def _record(
    band: str,
    weights: str,
    table: Stabilisation,
    candidates_found: int,
    fitted: FittedModes,
    choices: Choices,
) -> Step:
    return step(
        "identify_modes",
        band=band,
        line_weights=weights,
        highest_order=int(table.orders[-1]),
        candidates=candidates_found,
        modes=fitted.chosen.size,
        model_error=fitted.model_error,
        unrefined=int(np.count_nonzero(~fitted.poles.converged)),
        beyond_band=fitted.poles.beyond.size,
        kept_by_hand=", ".join(f"{f:g} Hz" for f in choices.keep) or "none",
        dropped_by_hand=", ".join(f"{f:g} Hz" for f in choices.drop) or "none",
    )
