# SPDX-License-Identifier: MIT
"""Young's moduli of bodies as parameters of a reduced structure.

A factor on the modulus of a body multiplies its stiffness matrix, as a joint's value
multiplies that of the joint.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.joint_spread import JointSpread
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel
from jointbench.analysis.structures.reduction.structure_bodies import body_ranges

MODULUS = "modulus"


def modulus_name(body: str) -> str:
    """Return the name of the parameter of a body: factor on its nominal modulus."""
    return f"{body}.{MODULUS}"


def is_modulus(name: str) -> bool:
    """Return whether a parameter is a factor on a modulus."""
    return name.endswith(f".{MODULUS}")


def with_moduli(model: ReducedModel, bodies: Sequence[str]) -> ReducedModel:
    """Add factors on the moduli of bodies to the parameters of a model.

    Args:
        model: reduced structure; its loss keeps the nominal moduli.
        bodies: names; bodies that are glued together have one name and one factor.

    Returns:
        The model with parameters `modulus_name` after those of the joints, 1 where the
        modulus is nominal. Springs of a body's supports are multiplied as well.

    Raises:
        UsageError: there is no such body.
    """
    residual, size = model.residual, model.size
    names = [one.name for one in residual.components]
    stiffness, blocks, numbers = model.stiffness.copy(), [], []
    for body in bodies:
        if body not in names:
            raise UsageError(f"no body {body!r} with a modulus; there are {names}")
        number = names.index(body)
        turn = residual.turn[residual.places[number]]
        own = turn.T @ residual.components[number].stiffness @ turn
        stiffness -= own
        blocks.append(0.5 * (own + own.T))
        numbers.append(number)
    if not blocks:
        return model
    still = model.strains.shape[1]
    spread = JointSpread(
        size,
        (*model.spread.columns, np.arange(size)),
        (*model.spread.blocks, np.array(blocks)),
    )
    return replace(
        model,
        stiffness=0.5 * (stiffness + stiffness.T),
        spread=spread,
        residual=replace(residual, factors=tuple(numbers)),
        strains=np.concatenate([model.strains, np.zeros((len(blocks), still, still))]),
        names=(*model.names, *map(modulus_name, bodies)),
        guess=None,
    )


def scaled_structure(structure: Structure, factors: Mapping[str, float]) -> Structure:
    """Return a structure with the moduli of some bodies multiplied.

    Args:
        structure: bodies and joints.
        factors: by the name of the body; glued ones are joined by ``"+"``.
    """
    scale = np.ones(structure.size)
    for one in body_ranges(structure):
        scale[one.low : one.high] = factors.get(one.name, 1.0)
    return replace(
        structure,
        stiffness=_rows_times(structure.stiffness, scale),
        springs=_rows_times(structure.springs, scale),
        glue=_rows_times(structure.glue, scale),
    )


def _rows_times(matrix: Sparse, scale: FloatArray) -> Sparse:
    """Multiply the rows; bodies are blocks, so that the matrix stays symmetric."""
    whole = matrix.tocsr(copy=True)
    whole.data *= np.repeat(scale, np.diff(whole.indptr))
    return Sparse(whole)
