# SPDX-License-Identifier: MIT
"""Matrices and frequency response of rigid bodies joined by springs and dashpots."""

import math
from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.provenance import step
from jointbench.analysis.lumped.lumped_model import LumpedModel
from jointbench.signal.frf.frf import Frf, FrfKind


def incidence(model: LumpedModel) -> FloatArray:
    """Return the elongation of each link per displacement of each body [-].

    Returns:
        Shape (n_links, n_bodies): 1 at the positive end, -1 at the negative one; the
        ground has no column. Stiffness matrix = incidence^T diag(stiffness) incidence.
    """
    rows = np.zeros((len(model.links), len(model.bodies)))
    for link, row in enumerate(rows):
        first, second = model.ends(link)
        row[second] = 1.0
        if first >= 0:
            row[first] = -1.0
    return rows


def mass_matrix(model: LumpedModel) -> FloatArray:
    """Return M [kg], shape (n_bodies, n_bodies), diagonal."""
    return np.diag([body.mass for body in model.bodies])


def damping_matrix(model: LumpedModel) -> FloatArray:
    """Return C [N s/m], shape (n_bodies, n_bodies)."""
    rows = incidence(model)
    return np.asarray((rows.T * [link.damping for link in model.links]) @ rows)


def stiffness_matrix(model: LumpedModel) -> FloatArray:
    """Return K [N/m], shape (n_bodies, n_bodies)."""
    rows = incidence(model)
    return np.asarray((rows.T * [link.stiffness for link in model.links]) @ rows)


def predict_frf(
    model: LumpedModel,
    frequency: FloatArray,
    *,
    kind: FrfKind = FrfKind.ACCELERANCE,
    outputs: Sequence[str] | None = None,
    inputs: Sequence[str] | None = None,
) -> Frf:
    """Predict the FRF of a hammer test.

    Args:
        model: bodies and links, all stiffnesses known.
        frequency: lines [Hz], shape (n_lines,), ascending.
        kind: receptance, mobility or accelerance.
        outputs: bodies with a response; default all.
        inputs: bodies that are struck; default all.

    Returns:
        (K + j omega C - omega^2 M)^-1 times (j omega)^derivatives.

    Raises:
        UsageError: a body that the model does not have.

    Source:
        Appl. Sci. 2023, 13, 11680, eq. (4), for several bodies.
    """
    names = tuple(body.name for body in model.bodies)
    rows, columns = tuple(outputs or names), tuple(inputs or names)
    s = 2j * math.pi * np.asarray(frequency, dtype=float)[:, None, None]
    dynamic = (
        s**2 * mass_matrix(model) + s * damping_matrix(model) + stiffness_matrix(model)
    )
    struck = np.eye(len(names))[:, [model.index(name) for name in columns]]
    response = np.linalg.solve(dynamic, struck) * s**kind.derivatives
    chosen = response[:, [model.index(name) for name in rows], :]
    return Frf(
        frequency=np.asarray(frequency, dtype=float),
        response=np.moveaxis(chosen, 0, -1),
        kind=kind,
        outputs=rows,
        inputs=columns,
        provenance=(step("predict_frf", links=", ".join(_links(model))),),
    )


def _links(model: LumpedModel) -> list[str]:
    return [
        f"{link.name}: {link.stiffness:.6g} N/m, {link.damping:.6g} N s/m"
        for link in model.links
    ]
