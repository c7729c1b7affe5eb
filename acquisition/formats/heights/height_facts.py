# SPDX-License-Identifier: MIT
"""Check that the data of a height file are consistent and physically possible.

A length, a number of points, a pitch and the settings of a trace determine each other
more than once. A contradictory file is refused. If a trace or a map is incomplete, its
heights are read at the correct pitch, and the surface has a caution that screen,
reports and JSON repeat.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.formats.heights.number_grids import HIGHEST
from jointbench.acquisition.records.provenance import Provenance, Step, step
from jointbench.acquisition.records.surfaces import Areal, Profile, Surface

LONGEST = 1.0
"""No profilometer scans a metre: a longer trace has a wrong unit [m]."""
LONGEST_TABLE = 100.0
"""Tables come from other instruments too, up to a guideway's straightness [m]."""
_FINEST = 1e-12
"""Least pitch, a hundredth of an atom [m]."""
_RANGE_SHARE = 0.98
"""Share of the stated range from which a height is at its limit [-]."""
# Equal heights at the end and extreme of a profile from which they are no roughness.
_FLAT_END = 8
_CAUTION = "caution"


def caution(text: str) -> Step:
    """Return a provenance step with a caution about heights."""
    return step(_CAUTION, said=text)


def cautions(provenance: Provenance) -> tuple[str, ...]:
    """Return the cautions about heights, in order."""
    return tuple(
        str(dict(one.detail).get("said", ""))
        for one in provenance
        if one.name == _CAUTION
    )


def range_caution(heights: Profile, limit: float) -> tuple[Step, ...]:
    """Return a caution if a trace reaches the limit of its measuring range.

    Args:
        heights: the profile from the file.
        limit: largest height the instrument reaches, to both sides of 0 [m].

    Returns:
        One caution, or none.
    """
    at_limit = (np.abs(heights.heights) >= _RANGE_SHARE * limit) & heights.valid
    if not at_limit.any():
        return ()
    end = float(heights.heights[heights.valid][-1])
    if at_limit[heights.valid][-1]:
        said = (
            f"the trace ends at {1e6 * end:.4g} um, the limit of its range of +/- "
            f"{1e6 * limit:g} um: the stylus has left its range there"
        )
    else:
        said = (
            f"{int(at_limit.sum())} heights lie at the limit of the range of +/- "
            f"{1e6 * limit:g} um: they are cut off there"
        )
    return (caution(f"{said}; level the part, or measure with a larger range"),)


def checked(surface: Surface, path: Path | str, *, longest: float = LONGEST) -> Surface:
    """Refuse impossible heights, and add cautions for implausible ones.

    Args:
        surface: from a reader.
        path: file or line that it came from, for messages.
        longest: largest length of a trace, or side of a map [m].

    Returns:
        The surface, with any cautions in its provenance.

    Raises:
        FormatError: it is longer, its pitch finer or its heights larger than the
            limits.
    """
    extents = _extents(surface)
    for length, pitch, points in extents:
        if not (length <= longest and pitch >= _FINEST):
            raise FormatError(
                f"{named(path)}: {points} points over {length:.3g} m are {pitch:.3g} m "
                f"apart; a length up to {longest:g} m and a pitch from {_FINEST:g} m "
                "on can be measured: the length in the header or its unit is wrong, "
                "correct it or export the file again"
            )
    there = surface.heights[surface.valid]
    span = float(np.ptp(there)) if there.size else 0.0
    if there.size and float(np.abs(there).max()) > HIGHEST:
        raise FormatError(
            f"{named(path)} holds a height of {float(np.abs(there).max()):g} m, beyond "
            f"{HIGHEST:g} m; it is a code for a missing point or a wrong unit: export "
            "it again"
        )
    found = []
    side = max(length for length, _, _ in extents)
    if span > side > 0:
        found.append(
            caution(
                f"heights span {1e6 * span:.4g} um over a length of {1e6 * side:.4g} "
                "um, steeper than any machined surface: is a unit wrong?"
            )
        )
    if isinstance(surface, Profile) and (flat := _flat_end(surface)):
        found.append(
            caution(
                f"the trace ends in {flat} equal heights at its extreme: the "
                "instrument had left its range; cut the end off, or measure again"
            )
        )
    if not found:
        return surface
    return replace(surface, provenance=(*surface.provenance, *found))


def _extents(surface: Surface) -> tuple[tuple[float, float, int], ...]:
    """Return length [m], pitch [m] and points along each direction."""
    if isinstance(surface, Areal):
        pairs = zip(surface.spacing, surface.heights.shape, strict=True)
        return tuple((pitch * n, pitch, n) for pitch, n in pairs)
    return ((surface.length, surface.spacing, surface.heights.size),)


def _flat_end(profile: Profile) -> int:
    """Return how many equal heights end a profile at its extreme; 0 for few."""
    there = profile.heights[profile.valid]
    if there.size < 2 * _FLAT_END or there[-1] not in (there.min(), there.max()):
        return 0
    other = np.flatnonzero(there != there[-1])
    count = there.size - 1 - int(other[-1]) if other.size else 0
    return count if count >= _FLAT_END else 0
