# SPDX-License-Identifier: MIT
"""Mass normalisation: shapes scaled by the residue at the driving point.

Of a structure with real modes the receptance residue is phi_o phi_i / (2 j omega_d):
where response and force are at one point, phi^2 = 2 j omega_d R gives the scale.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import ChannelMissing
from jointbench.signal.modal.modal_model import ModalModel


@dataclass(frozen=True, slots=True, eq=False)
class NormalisedShapes:
    """Shapes of unit modal mass.

    Attributes:
        shapes: [1/sqrt(kg)], shape (n_modes, n_outputs).
        modal_mass: with the largest component scaled to 1 [kg], shape (n_modes,).
        driving_points: the point that scaled each mode, the one where it moves most.
        phase: of 2 j omega R there [rad], shape (n_modes,): 0 for a real mode and a
            well-placed sensor. Beyond a few degrees the mode is complex, or sensor and
            hammer do not share point and direction; beyond 90 one has its sign wrong.
    """

    shapes: ComplexArray
    modal_mass: FloatArray
    driving_points: tuple[str, ...]
    phase: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "shapes", "modal_mass", "phase")


def driving_points(
    outputs: Sequence[str], inputs: Sequence[str]
) -> tuple[tuple[int, int], ...]:
    """Return the pairs of output and input that share a point.

    Args:
        outputs: labels ``"channel@point"``.
        inputs: points.
    """
    return tuple(
        (row, column)
        for row, output in enumerate(outputs)
        for column, point in enumerate(inputs)
        if point and output.rpartition("@")[2] == point
    )


def mass_normalise(
    model: ModalModel, pairs: Sequence[tuple[int, int]] | None = None
) -> NormalisedShapes:
    """Scale the shapes of a model to unit modal mass.

    Args:
        model: with receptance residues.
        pairs: output and input that share point and direction; None for those that
            share a point by name (directions are not in the labels: check `phase`).

    Returns:
        Shapes in the units of the mass matrix.

    Raises:
        ChannelMissing: no driving point.

    Source:
        Ewins, Modal Testing (2000), sec. 2.4.2 and 4.3.
    """
    points = driving_points(model.outputs, model.inputs) if pairs is None else pairs
    if not points:
        raise ChannelMissing(
            "no driving point: none of the responses "
            f"({', '.join(model.outputs)}) is where a force acts "
            f"({', '.join(model.inputs)}); hit once next to a sensor, in its direction"
        )
    rows, columns = (list(side) for side in zip(*points, strict=True))
    damped = model.poles.imag
    squares = 2j * damped[:, None] * model.residues[:, rows, columns]
    best = np.argmax(np.abs(squares), axis=1)
    square = np.take_along_axis(squares, best[:, None], axis=1)[:, 0]
    own = np.sqrt(square)
    column = np.array(columns)[best]
    driven = 2j * damped[:, None] * model.residues[np.arange(best.size), :, column]
    shapes = driven / own[:, None]
    return NormalisedShapes(
        shapes=shapes,
        modal_mass=1.0 / np.max(np.abs(shapes), axis=1) ** 2,
        driving_points=tuple(model.inputs[i] for i in column),
        phase=np.angle(square),
    )
