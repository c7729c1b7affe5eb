# SPDX-License-Identifier: MIT
"""A serial instrument without hardware by its URL, ``sim:mark10?torques=20,50``."""

from collections.abc import Callable
from urllib.parse import parse_qsl, urlsplit

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.serial_lines.instruments import SERIAL_INSTRUMENTS
from jointbench.acquisition.serial_lines.serial_instrument import Answer
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile
from jointbench.simulators.twins.dialogue import (
    DiaviteTwin,
    MitutoyoTwin,
    WrenchTwin,
)
from jointbench.simulators.twins.twin import Twin

INSTRUMENTS = ("diavite", "mitutoyo", "mark10")
_WRENCH_ERROR = 0.02  # relative standard deviation of a good wrench
_COUNTS_PER_METRE = 128e6  # of a DH-8
_TRAVERSE = 4.8e-3  # [m]
_DIMENSION, _ROUGHNESS = 1.45, 5e-11  # [-], [m] of the measured ground surface
_KEYS = "seed, torques, bolts, points, unplug"


def twin_from_url(url: str) -> Twin:
    """Connect the instrument of a URL.

    Args:
        url: ``sim:diavite``, ``sim:mitutoyo`` or ``sim:mark10`` and, as a query, any
            of: ``seed``; ``points`` of the profile; ``torques`` [N m] of a wrench that
            tightens ``bolts`` to each of them; ``unplug``, bytes sent after which the
            line breaks. Or an instrument of a package, with keys of its own.

    Raises:
        UsageError: an unknown instrument or key, or an invalid value.
    """
    parts = urlsplit(url)
    values = dict(parse_qsl(parts.query, keep_blank_values=True))
    instrument = parts.path if parts.scheme == "sim" else ""
    if instrument in INSTRUMENTS:
        return _built_in(url, instrument, values)
    return _of_package(url, instrument, values)


def _built_in(url: str, instrument: str, values: dict[str, str]) -> Twin:
    """Plug in one of jointbench's own."""

    def take(key: str, default: str) -> tuple[float, ...]:
        return _numbers(url, key, values.pop(key, default))

    seed, points = int(take("seed", "1")[0]), int(take("points", "4800")[0])
    torques, bolts = take("torques", "20"), int(take("bolts", "4")[0])
    unplug = take("unplug", "")
    if values:
        raise UsageError(
            f"unknown key {next(iter(values))!r} in {url!r}; known: {_KEYS}"
        )
    if points < 16 or bolts < 1 or not torques:
        raise UsageError(
            f"{url!r} is no valid instrument; give 16 points or more, a bolt and a "
            "torque"
        )
    made: dict[str, Callable[[], Answer]] = {
        "diavite": lambda: _diavite(seed, points),
        "mitutoyo": lambda: _mitutoyo(seed, points),
        "mark10": lambda: _wrench(seed, torques, bolts),
    }
    return Twin(made[instrument](), unplug_after=int(unplug[0]) if unplug else None)


def _of_package(url: str, instrument: str, values: dict[str, str]) -> Twin:
    """Plug in the simulator that a package brings along with its instrument."""
    unplug = _numbers(url, "unplug", values.pop("unplug", ""))
    entries = {
        entry.value.name: entry
        for entry in SERIAL_INSTRUMENTS.entries()
        if entry.value.simulate is not None
    }
    if instrument not in entries:
        known = ", ".join(f"sim:{name}" for name in (*INSTRUMENTS, *entries))
        raise UsageError(f"{url!r} is no serial instrument; there are {known}")
    entry = entries[instrument]
    assert entry.value.simulate is not None, "chosen for it"
    with entry.running(UsageError):
        answer = entry.value.simulate(values)
    return Twin(answer, unplug_after=int(unplug[0]) if unplug else None)


def _numbers(url: str, key: str, text: str) -> tuple[float, ...]:
    try:
        return tuple(float(word) for word in text.split(",") if word)
    except ValueError:
        raise UsageError(f"{key} is {text!r} in {url!r}; give a number") from None


def _heights(seed: int, points: int) -> FloatArray:
    """Return the heights of a ground surface along a traverse [m]."""
    face = rough_profile(
        points,
        spacing=_TRAVERSE / points,
        dimension=_DIMENSION,
        roughness=_ROUGHNESS,
        seed=seed,
    )
    centred: FloatArray = face.heights - face.heights.mean()
    return centred


def _diavite(seed: int, points: int) -> Answer:
    counts = np.round(_COUNTS_PER_METRE * _heights(seed, points)).astype(int)
    return DiaviteTwin(tuple(np.clip(counts, -32768, 32767).tolist())).answer


def _mitutoyo(seed: int, points: int) -> Answer:
    heights = 1e6 * _heights(seed, points)
    per_file = max(100, -(-points // 50))
    length = 1e3 * _TRAVERSE
    return MitutoyoTwin(tuple(heights.tolist()), per_file, length).answer


def _wrench(seed: int, torques: tuple[float, ...], bolts: int) -> Answer:
    drawn = np.random.default_rng([seed, 17]).standard_normal(len(torques) * bolts)
    errors = _WRENCH_ERROR * np.clip(drawn, -2.5, 2.5)
    return WrenchTwin(torques, bolts, tuple(errors.tolist())).answer
