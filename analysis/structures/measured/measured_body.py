# SPDX-License-Identifier: MIT
"""A body from its modes measured free-free: no mesh, with uncertainty."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.array_checks import require_positive, require_shape
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.reduction.component import BodySource, Component

# Residual flexibility acts as modes at this multiple of the band: high enough to be
# static in it, low enough to keep digits.
_RESIDUAL_AT = 20.0
# The lowest mode above the table cannot be in the band.
_RESIDUAL_FROM = 1.05
# Eigenvalues of the residual flexibility below this share of the largest are noise.
_NO_FLEXIBILITY = 1e-9
# A rotation and a translation: what a free body has.
_RIGID_MOTIONS = 6


@dataclass(frozen=True, slots=True, eq=False)
class ModalTable:
    """Modes of a free body at the rows where it is joined, loaded and measured.

    Attributes:
        name: of the body.
        frequency: elastic natural frequencies [Hz], ascending, shape (n_modes,).
        frequency_sd: [Hz], shape (n_modes,).
        damping_ratio: [-], shape (n_modes,).
        damping_sd: [-], shape (n_modes,).
        shapes: mass-normalised [kg^-1/2], shape (n_modes, n_rows).
        shape_sd: [kg^-1/2], shape (n_modes, n_rows).
        rigid: mass-normalised rigid motions at the rows, from mass, inertia and
            geometry [kg^-1/2], shape (n_rigid, n_rows); no rows for a held body.
        flexibility: of the modes above the table, static and positive semi-definite
            [m/N], shape (n_rows, n_rows).
        curvature: minus the slope of that flexibility over s^2 [m s^2/N], same shape;
            it places the modes above. Zero places them far above.
        band_hz: highest frequency of the measurement [Hz].
    """

    name: str
    frequency: FloatArray
    frequency_sd: FloatArray
    damping_ratio: FloatArray
    damping_sd: FloatArray
    shapes: FloatArray
    shape_sd: FloatArray
    rigid: FloatArray
    flexibility: FloatArray
    curvature: FloatArray
    band_hz: float

    def __post_init__(self) -> None:
        """Check shapes and signs; make the arrays read-only."""
        modes, rows = self.shapes.shape
        for name in ("frequency", "frequency_sd", "damping_ratio", "damping_sd"):
            require_shape(name, getattr(self, name), (modes,))
        require_shape("shape_sd", self.shape_sd, (modes, rows))
        require_shape("rigid", self.rigid, (None, rows))
        require_shape("flexibility", self.flexibility, (rows, rows))
        require_shape("curvature", self.curvature, (rows, rows))
        require_positive("band_hz", self.band_hz)
        if np.any(self.frequency <= 0) or np.any(np.diff(self.frequency) < 0):
            raise BadData(
                f"modes of {self.name!r} are at {self.frequency.tolist()} Hz; give "
                "elastic ones above 0 Hz in ascending order, rigid motions as `rigid`"
            )
        if self.rigid.shape[0] > _RIGID_MOTIONS:
            raise BadData(
                f"{self.rigid.shape[0]} rigid motions of {self.name!r}; a body has six "
                "at most"
            )
        freeze(self, *(one for one in self.__slots__ if one not in ("name", "band_hz")))


def modal_body(
    table: ModalTable,
    ports: Mapping[str, Sequence[int]],
    source: BodySource = BodySource.MODAL_TABLE,
) -> Component:
    """Return a body in the coordinates of its measured modes.

    Args:
        table: its modes.
        ports: rows of the table that belong to each port, in their order.
        source: of the table; FRF_BLOCK if it was fitted to FRFs.

    Returns:
        The body; `error_bound` is two standard deviations of its frequencies.

    Raises:
        BadData: the residual flexibility is not symmetric and positive.
    """
    omega = 2.0 * np.pi * table.frequency
    value, vector = _flexible(table)
    # Modes at w with the rows f w answer f f' (1 - s^2 / w^2 ...) below w: both terms
    # of the flexibility give their rows and places.
    scaled = vector * np.sqrt(value)
    inverse = vector / np.sqrt(value)
    slow, turn = np.linalg.eigh(_symmetric(inverse.T @ table.curvature @ inverse))
    band = (2.0 * np.pi * table.band_hz) ** 2
    least, most = _RESIDUAL_FROM**2 * band, _RESIDUAL_AT**2 * band
    above = 1.0 / np.clip(slow, 1.0 / most, 1.0 / least)
    high = np.sqrt(above)[:, None] * (scaled @ turn).T
    rows = np.concatenate([table.rigid, table.shapes, high]).T
    still = table.rigid.shape[0]
    level = np.concatenate([np.zeros(still), omega**2, above])
    damping = np.zeros_like(level)
    damping[still : still + omega.size] = 2.0 * table.damping_ratio * omega
    spread = table.frequency_sd / table.frequency
    return Component(
        name=table.name,
        stiffness=np.diag(level),
        loss=np.zeros((level.size,) * 2),
        damping=np.diag(damping),
        rows={name: rows[list(own)] for name, own in ports.items()},
        rigid=still,
        source=source,
        error_bound=float(2.0 * spread.max(initial=0.0)),
    )


def _symmetric(matrix: FloatArray) -> FloatArray:
    return np.asarray(0.5 * (matrix + matrix.T))


def _flexible(table: ModalTable) -> tuple[FloatArray, FloatArray]:
    matrix = table.flexibility
    largest = float(np.abs(matrix).max(initial=0.0))
    if np.abs(matrix - matrix.T).max(initial=0.0) > 1e-6 * largest:
        raise BadData(f"the residual flexibility of {table.name!r} is not symmetric")
    value, vector = np.linalg.eigh(_symmetric(matrix))
    top = float(value.max(initial=0.0))
    if value.min(initial=0.0) < -0.1 * top:
        raise BadData(
            f"the residual flexibility of {table.name!r} has the eigenvalue "
            f"{value.min():.3g} m/N; modes above the table cannot make that: widen the "
            "band of the fit"
        )
    kept = value > _NO_FLEXIBILITY * top
    return value[kept], vector[:, kept]


def drawn_table(table: ModalTable, random: np.random.Generator) -> ModalTable:
    """Return a table drawn from the uncertainty of a measured one.

    Args:
        table: measured.
        random: source of the draw.

    Returns:
        For intervals of what is computed from the table.
    """
    frequency = table.frequency + table.frequency_sd * random.standard_normal(
        table.frequency.size
    )
    ratio = table.damping_ratio + table.damping_sd * random.standard_normal(
        table.damping_ratio.size
    )
    shapes = table.shapes + table.shape_sd * random.standard_normal(table.shapes.shape)
    return replace(
        table,
        frequency=np.sort(np.maximum(frequency, 1e-3 * table.frequency)),
        damping_ratio=np.maximum(ratio, 0.0),
        shapes=shapes,
    )
