# SPDX-License-Identifier: MIT
"""Draw plates, lap-jointed beams and columns on bolts, with points and sensors."""

from types import MappingProxyType

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.flexible.block_modes import ElasticBlock
from jointbench.simulators.flexible.flexible_specimen import (
    BODY_NAMES,
    BodyPlace,
    BoltedSpecimen,
    ElasticBody,
    Vector,
)

_MATERIALS = MappingProxyType(
    {
        "marble": (55e9, 0.25, 2600.0),
        "steel": (206e9, 0.29, 7850.0),
        "cast iron": (110e9, 0.26, 7200.0),
        "aluminium": (70e9, 0.33, 2700.0),
    }
)
"""Young's modulus [Pa], Poisson's ratio [-], density [kg/m^3]."""


def draw_specimen(kind: str, rng: np.random.Generator) -> BoltedSpecimen:
    """Draw sizes, materials, bolts, points and sensors of a specimen.

    Args:
        kind: one of `SPECIMEN_KINDS`.
        rng: source of the draws.

    Raises:
        UsageError: there is no such kind.
    """
    if kind not in SPECIMEN_KINDS:
        raise UsageError(f"specimen is {kind!r}; there are {', '.join(SPECIMEN_KINDS)}")
    return SPECIMEN_KINDS[kind](rng)


def _rounded(*values: float) -> Vector:
    """Return a place in whole millimetres."""
    x, y, z = (round(1e3 * float(value)) / 1e3 for value in values)
    return x, y, z


def _body(index: int, material: str, size: Vector, corner: Vector) -> ElasticBody:
    e, nu, rho = _MATERIALS[material]
    return ElasticBody(
        BODY_NAMES[index], material, ElasticBlock(size, e, nu, rho), corner
    )


def _on(
    body: ElasticBody, index: int, name: str, side: str, along: tuple[float, float]
) -> BodyPlace:
    """Return a place on a side of a body, its direction out of the body.

    Args:
        body: the body.
        index: of the body.
        name: of the place.
        side: ``+x``, ``-z`` ...
        along: place on the side, as shares of its two edges.
    """
    axis, sign = "xyz".index(side[1]), 1.0 if side[0] == "+" else -1.0
    share = [0.0, 0.0, 0.0]
    share[axis] = 0.5 + 0.5 * sign
    others = [i for i in range(3) if i != axis]
    for i, value in zip(others, along, strict=True):
        share[i] = value
    size, corner = body.block.size, body.corner
    place = _rounded(*(corner[i] + share[i] * size[i] for i in range(3)))
    out = [0.0, 0.0, 0.0]
    out[axis] = sign
    return BodyPlace(name, index, place, (out[0], out[1], out[2]))


def _struck(place: BodyPlace) -> BodyPlace:
    """Return a place with its direction into the body."""
    x, y, z = (-c if c else 0.0 for c in place.direction)
    return BodyPlace(place.name, place.body, place.position, (x, y, z))


def _triaxial(place: BodyPlace) -> tuple[BodyPlace, ...]:
    """Return the three directions of one sensor."""
    units = (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)), ("z", (0.0, 0.0, 1.0)))
    return tuple(
        BodyPlace(place.name + letter, place.body, place.position, unit)
        for letter, unit in units
    )


def _sensors(
    places: list[BodyPlace], rng: np.random.Generator
) -> tuple[BodyPlace, ...]:
    """Return all places with one direction, or four of them with three."""
    if rng.random() < 0.5:
        return tuple(places)
    chosen = [places[i] for i in (0, 1, 3, 4)]
    return tuple(each for place in chosen for each in _triaxial(place))


def _jittered(
    rng: np.random.Generator, along: tuple[float, float]
) -> tuple[float, float]:
    """Return a place on a side moved by up to 4 % of each edge."""
    x, y = np.clip(np.asarray(along) + rng.uniform(-0.04, 0.04, 2), 0.03, 0.97)
    return float(x), float(y)


def _places(
    bodies: tuple[ElasticBody, ElasticBody],
    chosen: list[tuple[int, str, tuple[float, float]]],
    letter: str,
    rng: np.random.Generator,
) -> list[BodyPlace]:
    return [
        _on(bodies[body], body, f"{letter}{n}", side, _jittered(rng, along))
        for n, (body, side, along) in enumerate(chosen, start=1)
    ]


def _feet(body: ElasticBody) -> tuple[Vector, ...]:
    (length, width, _), (x, y, z) = body.block.size, body.corner
    return tuple(
        _rounded(x + a * length, y + b * width, z)
        for a, b in ((0.1, 0.15), (0.9, 0.15), (0.9, 0.85), (0.1, 0.85))
    )


def _plates(rng: np.random.Generator) -> BoltedSpecimen:
    """Draw two plates of different sizes on four to six bolts."""
    material = str(rng.choice(list(_MATERIALS)))
    other = material if rng.random() < 0.5 else str(rng.choice(list(_MATERIALS)))
    length, width = rng.uniform(0.4, 0.6), rng.uniform(0.26, 0.36)
    low, high = rng.uniform(0.032, 0.055), rng.uniform(0.025, 0.045)
    share = rng.uniform(0.7, 0.95, 2)
    bottom = _body(0, material, _rounded(length, width, low), (0.0, 0.0, 0.0))
    size = _rounded(length * share[0], width * share[1], high)
    shift = rng.uniform(0.2, 0.8, 2)
    corner = _rounded(
        shift[0] * (bottom.block.size[0] - size[0]),
        shift[1] * (bottom.block.size[1] - size[1]),
        bottom.block.size[2],
    )
    bodies = (bottom, _body(1, other, size, corner))
    count = int(rng.choice((4, 4, 5, 6)))
    shares = [(0.13, 0.15), (0.87, 0.15), (0.87, 0.85), (0.13, 0.85)]
    shares += [(0.5, 0.15), (0.5, 0.85)]
    bolts = tuple(
        _rounded(corner[0] + a * size[0], corner[1] + b * size[1], corner[2])
        for a, b in shares[:count]
    )
    points = [
        (1, "+z", (0.18, 0.25)),
        (1, "+z", (0.62, 0.7)),
        (1, "+x", (0.37, 0.5)),
        (1, "+y", (0.3, 0.5)),
    ]
    sensors = [
        (1, "+z", (0.06, 0.08)),
        (1, "+z", (0.93, 0.9)),
        (1, "-x", (0.66, 0.5)),
        (0, "-z", (0.07, 0.9)),
        (0, "-z", (0.9, 0.13)),
        (0, "-x", (0.6, 0.4)),
    ]
    return _specimen("plates", bodies, bolts, points, sensors, rng)


def _lap_beam(rng: np.random.Generator) -> BoltedSpecimen:
    """Draw two bars that overlap, on two or four bolts."""
    material = str(rng.choice(("steel", "aluminium")))
    width, low, high = rng.uniform((0.05, 0.014, 0.012), (0.07, 0.022, 0.018))
    lengths = rng.uniform(0.3, 0.45, 2)
    lap = rng.uniform(0.09, 0.13)
    bottom = _body(0, material, _rounded(lengths[0], width, low), (0.0, 0.0, 0.0))
    long, wide, thick = bottom.block.size
    start = _rounded(long - lap, 0.0, thick)
    top = _body(1, material, _rounded(lengths[1], wide, high), start)
    rows = (0.3, 0.7) if rng.random() < 0.5 else (0.5,)
    lap = long - start[0]
    bolts = tuple(
        _rounded(start[0] + a * lap, b * wide, thick)
        for a in (0.18, 0.82)
        for b in rows
    )
    points = [
        (1, "+z", (0.88, 0.3)),
        (0, "+z", (0.3, 0.6)),
        (1, "+x", (0.6, 0.5)),
        (1, "+y", (0.7, 0.5)),
    ]
    sensors = [
        (1, "+z", (0.95, 0.8)),
        (1, "+z", (0.55, 0.25)),
        (1, "-y", (0.8, 0.5)),
        (0, "+z", (0.06, 0.2)),
        (0, "-z", (0.6, 0.7)),
        (0, "-x", (0.6, 0.4)),
    ]
    return _specimen("lap-beam", (bottom, top), bolts, points, sensors, rng)


def _column(rng: np.random.Generator) -> BoltedSpecimen:
    """Draw a column on a bed, on four or six bolts."""
    materials = rng.choice(("steel", "cast iron", "marble"), size=2)
    bed = _rounded(*rng.uniform((0.5, 0.34, 0.06), (0.65, 0.42, 0.09)))
    foot = _rounded(*rng.uniform((0.15, 0.13, 0.34), (0.2, 0.17, 0.5)))
    bottom = _body(0, str(materials[0]), bed, (0.0, 0.0, 0.0))
    shift = rng.uniform(0.3, 0.6, 2)
    corner = _rounded(
        shift[0] * (bed[0] - foot[0]), shift[1] * (bed[1] - foot[1]), bed[2]
    )
    top = _body(1, str(materials[1]), foot, corner)
    shares = [(0.14, 0.14), (0.86, 0.14), (0.86, 0.86), (0.14, 0.86)]
    if rng.random() < 0.4:
        shares += [(0.5, 0.14), (0.5, 0.86)]
    bolts = tuple(
        _rounded(corner[0] + a * foot[0], corner[1] + b * foot[1], corner[2])
        for a, b in shares
    )
    points = [
        (1, "+x", (0.35, 0.85)),
        (1, "+y", (0.6, 0.55)),
        (0, "+z", (0.1, 0.2)),
        (1, "+z", (0.3, 0.7)),
    ]
    sensors = [
        (1, "-x", (0.3, 0.95)),
        (1, "-y", (0.7, 0.9)),
        (1, "+z", (0.8, 0.2)),
        (0, "+z", (0.92, 0.1)),
        (0, "+z", (0.05, 0.9)),
        (1, "-x", (0.7, 0.4)),
    ]
    return _specimen("column", (bottom, top), bolts, points, sensors, rng)


def _specimen(
    kind: str,
    bodies: tuple[ElasticBody, ElasticBody],
    bolts: tuple[Vector, ...],
    points: list[tuple[int, str, tuple[float, float]]],
    sensors: list[tuple[int, str, tuple[float, float]]],
    rng: np.random.Generator,
) -> BoltedSpecimen:
    """Return a specimen with three or four points and its sensors."""
    count = int(rng.choice((3, 3, 4)))
    struck = _places(bodies, points[:count], "P", rng)
    seen = _places(bodies, sensors, "A", rng)
    return BoltedSpecimen(
        kind,
        bodies,
        bolts,
        _feet(bodies[0]),
        tuple(_struck(place) for place in struck),
        _sensors(seen, rng),
    )


SPECIMEN_KINDS = MappingProxyType(
    {"plates": _plates, "lap-beam": _lap_beam, "column": _column}
)
