# SPDX-License-Identifier: MIT
"""Reduce a structure by its interfaces, for a whole box of joint stiffnesses."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.assembled import (
    Assembled,
    assemble_components,
)
from jointbench.analysis.structures.reduction.box_reduction import (
    BoxReduction,
    ReductionStep,
    reduce_box,
    trial_points,
    weak_points,
)
from jointbench.analysis.structures.reduction.component import BodyPort, Component
from jointbench.analysis.structures.reduction.compressed import compressed
from jointbench.analysis.structures.reduction.enrichment import enrichment, widened
from jointbench.analysis.structures.reduction.full_modes import shift_of
from jointbench.analysis.structures.reduction.reduce_body import (
    FactoredBody,
    factor_body,
    reduce_body,
)
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    solve_reduced,
)
from jointbench.analysis.structures.reduction.reduction_cache import (
    body_key,
    cached_bodies,
    cached_component,
    content_key,
)
from jointbench.analysis.structures.reduction.sparse_factor import Solver
from jointbench.analysis.structures.reduction.structure_bodies import (
    LOADS,
    BodyRange,
    body_matrices,
    body_ranges,
    structure_ports,
)

DEFAULT_BOX = (1e6, 1e11)
"""Range of total stiffness of machine joints [N/m]."""

MACHINE_BOX = (1e5, 1e11)
"""Range of total stiffness of the joints of a machine, printed values included."""

# Order of the polynomials of the traction patterns: of a machine, and to begin with.
_MACHINE_ORDER = 5
_FIRST_ORDER = 4
# Enrichments before the reduction gives up.
_MOST_ROUNDS = 10
# ... or if the bound falls by less than this over so many.
_NO_GAIN, _NO_GAIN_ROUNDS = 0.8, 3
# Trial points that are checked before the second reduction, and used at once.
_FIRST_CHECKED = 12
_AT_ONCE = 4
# The band may be exceeded by this factor.
_BAND_SLACK = 1.05


def reduce_machine(
    structure: Structure,
    band_hz: float,
    *,
    box: tuple[float, float] = MACHINE_BOX,
    modes: int = 20,
    order: int = _MACHINE_ORDER,
    loads: FloatArray | None = None,
    solver: Solver = Solver.AUTO,
    cache: Path | None = None,
) -> Assembled:
    """Reduce every body once, and close the machine over its joints.

    A body is factored, reduced and freed before the next one. The band should hold the
    modes that are wanted.

    Args:
        structure: bodies and joints.
        band_hz: highest frequency of interest [Hz].
        box: smallest and largest total stiffness of any joint and direction [N/m].
        modes: number of modes that are wanted, rigid ones included.
        order: of the polynomials of the traction patterns.
        loads: rows of `sensor_rows` where forces act or motion is read, shape
            (n_points, n_free).
        solver: of the factors.
        cache: folder of reduced bodies, by content; None keeps none.

    Returns:
        The assembly; `Assembled.bound` bounds its errors.
    """
    ports, joints = structure_ports(structure, order, loads)

    def few() -> Sequence[Component]:
        bodies = [
            _one_body(structure, where, ports[where.name], band_hz, solver, cache)
            for where in body_ranges(structure)
        ]
        whole = assemble_components(bodies, joints, box=box, modes=modes)
        return compressed(whole, (LOADS,)).components

    key = ""
    if cache is not None:
        key = content_key(structure, band_hz, box, modes, order, loads)
    return assemble_components(
        cached_bodies(cache, key, few), joints, box=box, modes=modes
    )


def _one_body(
    structure: Structure,
    where: BodyRange,
    ports: list[BodyPort],
    band_hz: float,
    solver: Solver,
    cache: Path | None,
) -> Component:
    """Reduce one body of a machine, or read it from the cache."""
    body = body_matrices(structure, where)
    key = body_key(body, ports, band_hz) if cache is not None else ""
    return cached_component(
        cache, key, lambda: reduce_body(body, ports, band_hz, solver=solver)
    )


def reduce_structure(
    structure: Structure,
    *,
    modes: int,
    box: tuple[float, float] = DEFAULT_BOX,
    tolerance: float = 5e-5,
    loads: FloatArray | None = None,
    solver: Solver = Solver.AUTO,
    progress: Callable[[ReductionStep], None] | None = None,
) -> ReducedModel:
    """Reduce a structure to a model valid for all joints in a box.

    The bodies are reduced by their interfaces, with traction patterns and motions from
    the points of the box with the largest bound until it is small everywhere; then the
    assembly is reduced to its modes in the box.

    Args:
        structure: bodies and joints.
        modes: number of accurate modes, rigid ones included.
        box: smallest and largest total stiffness of any joint and direction [N/m].
        tolerance: of the bound, relative frequency [-].
        loads: rows of `sensor_rows` where forces act or FRFs are read, shape
            (n_points, n_free): the local compliance of the bodies there is added to the
            basis.
        solver: of the factors.
        progress: called after every point.

    Returns:
        The reduced structure.

    Raises:
        BadData: the bound stays above `tolerance` after many enrichments.
        UsageError: there is no joint with parameters, or the box is empty.
    """
    _require_box(structure, box)
    ports, joints = structure_ports(structure, _FIRST_ORDER, loads)
    # Waves of about the size of the structure.
    band = float(np.sqrt(shift_of(structure.stiffness, structure.mass)) / (2 * np.pi))
    bodies = _factored(structure, band, modes, solver)
    inertia: Mapping[str, FloatArray] = {}
    worst: list[float] = []
    while len(worst) < _MOST_ROUNDS and not _stuck(worst):
        whole = assemble_components(
            [
                one.reduce(ports[one.body.name], inertia.get(one.body.name))
                for one in bodies
            ],
            joints,
            box=box,
            modes=modes,
        )
        top = _highest(whole.model)
        if top > _BAND_SLACK * band:
            band = top
            bodies = _factored(structure, band, modes, solver)
            continue
        found = _checked(whole, tolerance, progress)
        if not found.weak:
            return found.model
        worst.append(found.worst)
        more = enrichment(whole, found.weak[:_AT_ONCE], max(1, len(worst) - 1))
        ports = widened(ports, joints, more.patterns)
        inertia = more.inertia
    raise BadData(
        f"the reduced model's error bound stays at {found.worst:.2g} of the frequency, "
        f"{tolerance:g} is allowed, with {whole.model.size} coordinates, and more of "
        "them do not lower it; narrow the box, allow a larger tolerance, or reduce "
        "fewer modes"
    )


def _stuck(worst: Sequence[float]) -> bool:
    """Return whether the last enrichments did not lower the bound."""
    if len(worst) <= _NO_GAIN_ROUNDS or worst[-1] >= 1.0:
        return False
    return worst[-1] > _NO_GAIN * worst[-1 - _NO_GAIN_ROUNDS]


def _factored(
    structure: Structure, band: float, modes: int, solver: Solver
) -> list[FactoredBody]:
    return [
        factor_body(
            body_matrices(structure, one), band, least_modes=modes, solver=solver
        )
        for one in body_ranges(structure)
    ]


def _highest(model: ReducedModel) -> float:
    """Return the highest wanted frequency at the stiffest joints [Hz]."""
    stiffest = np.full(len(model.names), model.box[1])
    return float(solve_reduced(model, stiffest).natural_frequency[-1])


def _checked(
    whole: Assembled,
    tolerance: float,
    progress: Callable[[ReductionStep], None] | None,
) -> BoxReduction:
    """Check a few points first; reduce once more where these are good."""
    model = whole.model
    points = trial_points(len(model.names), model.box)[:_FIRST_CHECKED]
    weak = sorted(weak_points(model, points, tolerance), key=lambda one: -one[0])
    if weak:
        if progress is not None:
            progress(ReductionStep(weak[0][0], model.size))
        return BoxReduction(model, tuple(point for _, point in weak), weak[0][0])
    loads = [
        whole.rows((body.name, LOADS))
        for body in whole.components
        if LOADS in body.rows
    ]
    rows = np.concatenate([np.zeros((0, model.size)), *loads])
    return reduce_box(model, tolerance, loads=rows, progress=progress)


def _require_box(structure: Structure, box: tuple[float, float]) -> None:
    if not structure.spread or not 0 < box[0] < box[1]:
        raise UsageError(
            f"a reduction over joints from {box[0]:g} to {box[1]:g} N/m with "
            f"{len(structure.spread)} joint directions; give joints, and low below high"
        )
