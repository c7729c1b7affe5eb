# SPDX-License-Identifier: MIT
"""What moves in a mode, and where its strain energy is."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.analysis.structures.machine.lean_machine import LeanMachine, Variant

_AXES = "xyz"
# Parts of the motion below this share are not named in the text of a shape.
_NAMED = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class EnergyShares:
    """Where the strain energy of each mode is.

    Attributes:
        regions: bodies, then joints.
        share: of the strain energy [-], shape (n_modes, n_regions).
    """

    regions: tuple[str, ...]
    share: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "share")

    def weakest(self, mode: int) -> tuple[str, float]:
        """Return the region with most of the energy of a mode, and its share."""
        at = int(np.argmax(self.share[mode]))
        return self.regions[at], float(self.share[mode, at])


def strain_shares(
    lean: LeanMachine, variant: Variant, motions: FloatArray
) -> EnergyShares:
    """Return the shares of strain energy of bodies and joints.

    Args:
        lean: the machine.
        variant: its values.
        motions: of any scale, in the coordinates of `lean`, shape (r, n).

    Returns:
        Shares that add up to one for each motion. A rigid joint takes none.
    """
    machine = lean.machine
    moved = lean.turn @ motions
    bodies = [
        np.einsum("rn,rs,sn->n", moved[one.place], one.stiffness, moved[one.place])
        for one in machine.bodies
    ]
    held = np.isin(machine.joint_of, variant.rigid)
    values = np.where(held, 0.0, variant.stiffness)
    each = values[:, None] * lean.model.spread.diagonal(motions)[: values.size]
    joints = [
        each[machine.joint_of == at].sum(axis=0) for at in range(len(machine.joints))
    ]
    energy = np.array([*bodies, *joints]).T
    names = [*(b.name for b in machine.bodies), *(j.name for j in machine.joints)]
    whole = energy.sum(axis=1, keepdims=True)
    return EnergyShares(tuple(names), energy / np.where(whole > 0.0, whole, 1.0))


@dataclass(frozen=True, slots=True, eq=False)
class MotionShares:
    """How the bodies move in each mode.

    Attributes:
        bodies: their names.
        share: of the kinetic energy: displacement x, y, z, rotation x, y, z, and
            deformation, shape (n_modes, n_bodies, 7) [-].
    """

    bodies: tuple[str, ...]
    share: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "share")

    def text(self, mode: int) -> str:
        """Return the largest motions of a mode in words."""
        own = self.share[mode]
        words = [f"moves along {axis}" for axis in _AXES]
        words += [f"turns about {axis}" for axis in _AXES]
        words.append("deforms")
        order = np.dstack(np.unravel_index(np.argsort(-own, axis=None), own.shape))[0]
        parts = [
            f"{self.bodies[body]} {words[kind]} {100 * own[body, kind]:.0f} %"
            for body, kind in order.tolist()
            if own[body, kind] >= _NAMED
        ]
        return ", ".join(parts[:4]) or "all bodies move a little"

    def turning(self, mode: int) -> float:
        """Return the share of rotation of all bodies [-]."""
        return float(self.share[mode, :, 3:6].sum())

    def moving(self, mode: int) -> float:
        """Return the share of displacement of all bodies [-]."""
        return float(self.share[mode, :, :3].sum())


def motion_shares(lean: LeanMachine, motions: FloatArray) -> MotionShares:
    """Return the shares of kinetic energy of bodies that move, turn and deform.

    Args:
        lean: the machine.
        motions: of any scale, in the coordinates of `lean`, shape (r, n).
    """
    found = []
    moved = lean.turn @ motions
    for body in lean.machine.bodies:
        own = moved[body.place]
        rigid = (body.rigid @ own) ** 2
        rest = np.maximum((own**2).sum(axis=0) - rigid.sum(axis=0), 0.0)
        found.append(np.concatenate([rigid, rest[None]]))
    share = np.array(found).transpose(2, 0, 1)
    whole = share.sum(axis=(1, 2), keepdims=True)
    names = tuple(body.name for body in lean.machine.bodies)
    return MotionShares(names, share / np.where(whole > 0.0, whole, 1.0))


def modal_assurance(
    first: FloatArray | ComplexArray, second: FloatArray | ComplexArray
) -> FloatArray:
    """Return the MAC with the mass as weight; both in coordinates of unit mass.

    Args:
        first: shapes as columns, shape (r, n).
        second: shape (r, m).

    Returns:
        Shape (n, m) [-].

    Source:
        Allemang 2003, Sound Vib. 37, 14-23.
    """
    one = first / np.linalg.norm(first, axis=0)
    other = second / np.linalg.norm(second, axis=0)
    return np.asarray(np.abs(one.conj().T @ other) ** 2)
