# SPDX-License-Identifier: MIT
"""Fewer coordinates of each body: those that the machine's modes in the box use."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.reduction.assembled import (
    Assembled,
    assemble_components,
)
from jointbench.analysis.structures.reduction.box_reduction import trial_points
from jointbench.analysis.structures.reduction.component import Component
from jointbench.analysis.structures.reduction.dense_modes import shifted_inverse
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    solve_reduced,
)

# A direction stays if any mode at any trial point has this share of its energy norm in
# it; the error of a frequency is about its square.
_SHARE = 2e-3
# Modes beyond the wanted ones at each point.
_SPARE = 2
# Terms of the series of the response to a load.
_TERMS = 3


def compressed(whole: Assembled, keep: tuple[str, ...] = ()) -> Assembled:
    """Leave out what no mode at any trial point of the box uses, body by body.

    Many traction patterns are needed because their shares differ from joint value to
    joint value, but a body uses few combinations of them. The bound of the result
    includes what is left out.

    Args:
        whole: assembly with rich bodies.
        keep: ports whose static responses stay complete: sensors, loads.

    Returns:
        The assembly of smaller bodies.
    """
    model, samples = whole.model, []
    loads = _loads(whole, keep)
    for point in trial_points(len(model.names), model.box):
        found = solve_reduced(model, point, min(model.modes + _SPARE, model.size))
        samples.append(found.shapes / np.sqrt(found.eigenvalue + model.shift))
        samples.append(_responses(model, point, loads))
    motion = np.concatenate(samples, axis=1)
    bodies = [
        restricted(body, _used(body, motion[place], model.shift, keep))
        for body, place in zip(whole.components, whole.places, strict=True)
    ]
    return assemble_components(
        bodies, whole.joints, whole.springs, box=model.box, modes=model.modes
    )


def _loads(whole: Assembled, keep: tuple[str, ...]) -> FloatArray:
    """Return the loads of the kept ports of all bodies, shape (n, n_loads)."""
    rows = [
        whole.rows((body.name, name))
        for body in whole.components
        for name in keep
        if name in body.rows
    ]
    return np.concatenate([np.zeros((0, whole.model.size)), *rows]).T


def _responses(model: ReducedModel, point: FloatArray, loads: FloatArray) -> FloatArray:
    """Return responses to loads at the shift and their next terms, of unit energy."""
    solve = shifted_inverse(model.with_joints(point), model.shift)
    found, force = [np.zeros((model.size, 0))], loads
    for _ in range(_TERMS):
        motion = solve(force)
        size = np.sqrt(np.einsum("rk,rk->k", motion, force))
        force = motion / size
        found.append(force)
    return np.concatenate(found, axis=1)


def _used(
    body: Component, motion: FloatArray, shift: float, keep: tuple[str, ...]
) -> FloatArray:
    """Return orthonormal elastic directions that modes and loads use."""
    still = body.rigid
    scale = np.sqrt(np.diag(body.stiffness)[still:] + shift)[:, None]
    vector, size, _ = np.linalg.svd(scale * motion[still:], full_matrices=False)
    parts = [vector[:, size > _SHARE] / scale]
    parts += [
        body.rows[name].T[still:] / scale**2 for name in keep if name in body.rows
    ]
    return np.asarray(np.linalg.qr(np.concatenate(parts, axis=1))[0])


def restricted(body: Component, elastic: FloatArray) -> Component:
    """Return a body in fewer coordinates, again modal ones.

    Args:
        body: reduced body.
        elastic: orthonormal directions among its elastic coordinates, shape (r - rigid,
            s).

    Returns:
        The body with all of its rigid motions and s elastic coordinates.
    """
    still, size = body.rigid, body.size
    inner = body.stiffness[still:, still:]
    level, turn = np.linalg.eigh(elastic.T @ inner @ elastic)
    whole = np.zeros((size, still + level.size))
    whole[:still, :still] = np.eye(still)
    whole[still:, still:] = elastic @ turn
    residual = body.residual
    if residual is not None:
        root = residual.root
        parts = [root[:, :size] @ whole, root[:, size : 2 * size] @ whole]
        root = np.concatenate([*parts, root[:, 2 * size :]], axis=1)
        residual = replace(residual, root=root)
    return replace(
        body,
        stiffness=np.diag(np.concatenate([np.zeros(still), level])),
        loss=whole.T @ body.loss @ whole,
        damping=whole.T @ body.damping @ whole,
        rows={name: rows @ whole for name, rows in body.rows.items()},
        basis=body.basis @ whole,
        residual=residual,
    )
