# SPDX-License-Identifier: MIT
"""One published claim, what became of it, and how it was computed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import contact_model

REPRODUCES = "reproduces"
CORRECTED = "reproduces with a correction"
DOES_NOT = "does not"
CANNOT = "cannot be checked"


@dataclass(frozen=True, slots=True)
class Claim:
    """A claim of a paper.

    Attributes:
        paper: year.
        where: figure, table, equation or section.
        says: what is claimed.
        mark: one of the four above.
        evidence: the correction, the reason with its size, or what is missing.
    """

    paper: str
    where: str
    says: str
    mark: str
    evidence: str


def stiffness(
    name: str,
    dimension: ArrayLike,
    roughness: ArrayLike,
    material: ContactMaterial,
    preload: ArrayLike,
    *,
    mode: str = "corrected",
) -> FloatArray:
    """Return the normal stiffness of a model by name [N/m]."""
    sums = contact_curve(
        contact_model(name, mode),
        dimension=dimension,
        roughness=roughness,
        material=material,
        preload=preload,
    )
    return sums.stiffness.sum(axis=0)


def between(values: Sequence[float]) -> str:
    """Write the range of some numbers."""
    low, high = float(np.min(values)), float(np.max(values))
    if f"{low:.4g}" == f"{high:.4g}":
        return f"{low:.4g}"
    return f"{low:.4g} to {high:.4g}"
