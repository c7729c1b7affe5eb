# SPDX-License-Identifier: MIT
"""Remove form and outliers from a surface; its provenance records each step."""

from dataclasses import replace

import numpy as np
import scipy.ndimage

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.surfaces import Profile, Surface
from jointbench.signal.surface.levelling import MINIMUM_VALID_POINTS, SurfaceTooSmall

HIGHEST_DEGREE = 8
"""Highest degree; higher polynomials fit roughness [-]."""
OUTLIER_LIMIT = 6.0
"""Distance from the median of its neighbours that makes an outlier, over the robust
standard deviation of the differences of neighbours [-]."""
NEIGHBOURHOOD = 5
"""Points across the neighbourhood of a point [-]."""
NORMAL_MEDIAN = 1.4826
"""Standard deviation over median absolute deviation of a Gaussian [-]."""


def remove_form(surface: Surface, *, degree: int = 2) -> Surface:
    """Remove the least-squares polynomial of a profile or map.

    Args:
        surface: a profile or a map; missing points are not used.
        degree: total degree of the polynomial [-]; 1 is a line or plane, 2 includes
            cylinders and spheres.

    Returns:
        Residual heights [m] (0 where missing) and one more step ``"remove_form"`` in
        the provenance, with the removed root mean square.

    Raises:
        UsageError: the degree is not 1 to 8.
        SurfaceTooSmall: too few points were measured.
    """
    if not 1 <= degree <= HIGHEST_DEGREE:
        raise UsageError(
            f"degree is {degree!r}, a form has 1 to {HIGHEST_DEGREE}; higher ones "
            "remove roughness"
        )
    terms = _terms(surface, degree)
    count = int(np.count_nonzero(surface.valid))
    if count < max(MINIMUM_VALID_POINTS, 2 * len(terms)):
        raise SurfaceTooSmall(
            f"surface {surface.name!r} has {count} measured points, too few for a form "
            f"of degree {degree}; measure more or lower the degree"
        )
    design = np.stack([term[surface.valid] for term in terms], axis=1)
    known = surface.heights[surface.valid]
    weights = np.linalg.lstsq(design, known, rcond=None)[0]
    form = np.zeros(surface.heights.shape)
    for weight, term in zip(weights, terms, strict=True):
        form += weight * term
    taken = form[surface.valid] - known.mean()
    note = step(
        "remove_form", degree=degree, rms_taken_m=float(np.sqrt(np.mean(taken**2)))
    )
    return replace(
        surface,
        heights=np.where(surface.valid, surface.heights - form, 0.0),
        provenance=(*surface.provenance, note),
    )


def mask_outliers(surface: Surface, *, limit: float = OUTLIER_LIMIT) -> Surface:
    """Mask points that are far from their neighbours.

    Args:
        surface: a profile or a map.
        limit: distance from the median of the neighbours, in robust standard
            deviations of the differences of neighbours [-].

    Returns:
        The surface with outliers no longer valid (height 0), and one more step
        ``"mask_outliers"`` with their number. No height is changed.

    Raises:
        UsageError: the limit is not above 1.
    """
    if not limit > 1:
        raise UsageError(f"limit is {limit!r}, it must be above 1, for example 6")
    filled = _filled(surface)
    others = np.ones((NEIGHBOURHOOD,) * filled.ndim, dtype=np.bool_)
    others[(NEIGHBOURHOOD // 2,) * filled.ndim] = False
    middle = scipy.ndimage.median_filter(filled, footprint=others, mode="nearest")
    apart = np.abs(filled - middle)
    steps = np.abs(np.diff(filled))[surface.valid[..., 1:] & surface.valid[..., :-1]]
    spread = NORMAL_MEDIAN * float(np.median(steps)) if steps.size else 0.0
    far = surface.valid & (apart > limit * spread) & (spread > 0)
    note = step("mask_outliers", limit=limit, masked=int(np.count_nonzero(far)))
    return replace(
        surface,
        heights=np.where(far, 0.0, surface.heights),
        valid=surface.valid & ~far,
        provenance=(*surface.provenance, note),
    )


def _filled(surface: Surface) -> FloatArray:
    """Return heights with missing points replaced by the nearest measured one.

    One height for all gaps would turn their edges into outliers on a tilted surface.
    """
    known = int(np.count_nonzero(surface.valid))
    if known < MINIMUM_VALID_POINTS:
        raise SurfaceTooSmall(
            f"surface {surface.name!r} has {known} measured points, at least "
            f"{MINIMUM_VALID_POINTS} are needed; measure a longer line or a larger map"
        )
    if surface.valid.all():
        return surface.heights
    nearest = scipy.ndimage.distance_transform_edt(
        ~surface.valid, return_distances=False, return_indices=True
    )
    filled: FloatArray = surface.heights[tuple(nearest)]
    return filled


def _terms(surface: Surface, degree: int) -> list[FloatArray]:
    """Return Legendre products up to a total degree, each of the surface's shape."""
    shape = surface.heights.shape
    lines = [
        [np.polynomial.Legendre.basis(k)(np.linspace(-1, 1, n)) for k in range(9)]
        for n in shape
    ]
    if isinstance(surface, Profile):
        return [np.asarray(lines[0][k]) for k in range(degree + 1)]
    return [
        np.asarray(np.outer(lines[0][j], lines[1][i]))
        for j in range(degree + 1)
        for i in range(degree + 1 - j)
    ]
