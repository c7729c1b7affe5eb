# SPDX-License-Identifier: MIT
"""Views of the residual of a surface: by wavelength, and by kind of row."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.diagnosis_record import View
from jointbench.analysis.gap.surface_bench.shape_rows import WORDS
from jointbench.analysis.gap.surface_bench.surface_rows import SurfaceRows

_DECADE_PARTS = 2


def wave_labels(rows: SurfaceRows) -> list[str]:
    """Return the word of each row: its range of wavelengths, or its shape.

    Args:
        rows: of the surface.
    """
    unit = 1e6 * rows.sample.pitch
    omega, found = rows.omega, []
    for one in omega[np.isfinite(omega)]:
        part = np.floor(_DECADE_PARTS * np.log10(unit * 2 * np.pi / one))
        low, high = (10 ** ((part + k) / _DECADE_PARTS) for k in (0, 1))
        found.append(f"{low:.3g} to {high:.3g} um")
    if rows.marks is not None:
        found.append("marks that repeat")
    return found + [w for w, used in zip(WORDS, rows.used, strict=True) if used]


def surface_views(rows: SurfaceRows, residual: FloatArray) -> tuple[View, ...]:
    """Divide a residual by wavelength and by kind of row.

    Args:
        rows: of the surface.
        residual: of a fit, shape (n_rows,).
    """
    labels = wave_labels(rows)
    waves = int(np.isfinite(rows.omega).sum())
    kinds = ["spectrum"] * waves + labels[waves:]
    return _view("wavelength", residual**2, labels), _view("kind", residual**2, kinds)


def _view(name: str, power: FloatArray, labels: list[str]) -> View:
    own = np.array(labels)
    slices = {x: power[own == x] for x in dict.fromkeys(labels)}
    excess = {x: max(float(np.sum(p - 1.0)), 0.0) for x, p in slices.items()}
    total = sum(excess.values()) or 1.0
    return View(
        name,
        {x: float(np.mean(p)) for x, p in slices.items()},
        {x: e / total for x, e in excess.items()},
    )
