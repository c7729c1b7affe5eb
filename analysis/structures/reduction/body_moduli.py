# SPDX-License-Identifier: MIT
"""Young's moduli and support springs of bodies as parameters of a reduced structure.

A factor on the modulus of a body multiplies its stiffness matrix, as a joint's value
multiplies that of the joint; a factor on its supports multiplies that of their springs.
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
_SUPPORT = "support"


def modulus_name(body: str) -> str:
    """Return the name of the parameter of a body: factor on its nominal modulus."""
    return f"{body}.{MODULUS}"


def is_modulus(name: str) -> bool:
    """Return whether a parameter is a factor on a modulus."""
    return name.endswith(f".{MODULUS}")


def is_factor(name: str) -> bool:
    """Return whether a parameter is a factor, on a modulus or on supports."""
    return is_modulus(name) or name.endswith(f".{_SUPPORT}")


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
    residual = model.residual
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
    whole = _with_blocks(model, stiffness, blocks, list(map(modulus_name, bodies)))
    return replace(whole, residual=replace(residual, factors=tuple(numbers)))


def bodies_on_springs(structure: Structure) -> tuple[str, ...]:
    """Return the bodies whose supports are springs; glued ones have one name."""
    springs = structure.springs
    return tuple(
        one.name
        for one in body_ranges(structure)
        if springs[one.low : one.high, one.low : one.high].nnz
    )


def with_support_factor(
    model: ReducedModel, structure: Structure, body: str
) -> ReducedModel:
    """Add a factor on the support springs of a body to the parameters of a model.

    Args:
        model: reduced structure; its basis is that of the stated springs.
        structure: the same on its meshes.
        body: one of `bodies_on_springs`.

    Returns:
        The model with the parameter ``"<body>.support"`` last, 1 as stated.

    Raises:
        UsageError: the body stands on no springs.
    """
    known = bodies_on_springs(structure)
    if body not in known:
        raise UsageError(f"no body {body!r} on springs; there are {list(known)}")
    ranges = {one.name: (at, one) for at, one in enumerate(body_ranges(structure))}
    number, own = ranges[body]
    residual = model.residual
    basis = residual.components[number].basis
    springs = structure.springs[own.low : own.high, own.low : own.high]
    turn = residual.turn[residual.places[number]]
    block = turn.T @ (basis.T @ (springs @ basis)) @ turn
    block = 0.5 * (block + block.T)
    return _with_blocks(model, model.stiffness - block, [block], [f"{body}.{_SUPPORT}"])


def _with_blocks(
    model: ReducedModel,
    stiffness: FloatArray,
    blocks: list[FloatArray],
    names: list[str],
) -> ReducedModel:
    """Return the model with parameters that multiply full matrices."""
    still = model.strains.shape[1]
    spread = JointSpread(
        model.size,
        (*model.spread.columns, np.arange(model.size)),
        (*model.spread.blocks, np.array(blocks)),
    )
    return replace(
        model,
        stiffness=0.5 * (stiffness + stiffness.T),
        spread=spread,
        strains=np.concatenate([model.strains, np.zeros((len(blocks), still, still))]),
        names=(*model.names, *names),
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
