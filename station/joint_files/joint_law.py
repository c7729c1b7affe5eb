# SPDX-License-Identifier: MIT
"""The law of slip or damping of a joint from the JSON of ``gap``."""

import json
from pathlib import Path

from jointbench.acquisition.basics.errors import FormatError, UsageError
from jointbench.analysis.structures.exchange.slip_law import (
    SliderLaw,
    SpeedLaw,
    law_of,
)
from jointbench.analysis.structures.matrices.parts import DIRECTIONS


def read_law(words: str) -> tuple[int, SliderLaw | SpeedLaw]:
    """Read ``FILE`` or ``FILE:direction``.

    Args:
        words: as typed; the direction is `tangential_1` without one.

    Returns:
        Number of the direction, and the law of the first effect named.

    Raises:
        FormatError: the file is no JSON of ``gap``.
        UsageError: no effect is named, or it cannot be written.
    """
    name, _, direction = words.rpartition(":")
    if direction not in DIRECTIONS or not name:
        name, direction = words, DIRECTIONS[1]
    path = Path(name)
    if not path.is_file():
        raise UsageError(
            f"--law: no file {name!r}; write the JSON of 'jointbench gap', and "
            f"':' with one of {list(DIRECTIONS)}"
        )
    try:
        effects = json.loads(path.read_text(encoding="utf-8"))["effects"]
        found = [(one["name"], one["site"], one["parameters"]) for one in effects]
    except (ValueError, KeyError, TypeError) as error:
        raise FormatError(f"{path}: no JSON of 'jointbench gap' ({error!r})") from error
    if not found:
        raise UsageError(f"{path}: no effect is named; the joint is linear without one")
    effect, site, parameters = found[0]
    values = {key: float(one["value"]) for key, one in parameters.items()}
    remarks = tuple(
        f"{effect} at {site}: {key} = {one['value']:.6g} +- {one['sd']:.2g} "
        f"{one['unit']}"
        for key, one in parameters.items()
    )
    try:
        return DIRECTIONS.index(direction), law_of(effect, values, remarks)
    except KeyError as error:
        raise FormatError(f"{path}: {effect} lacks its parameter {error}") from error
