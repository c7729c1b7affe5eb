# SPDX-License-Identifier: MIT
"""The reduced machine of a model file, read from a cache where it is there.

The key is the description of bodies, materials, supports and interfaces, and the
content of the files that it names: meshes are neither made nor assembled to find it.
"""

import hashlib
import json
from pathlib import Path
from typing import Any

from jointbench.analysis.structures.machine.machine_store import (
    read_machine,
    write_machine,
)
from jointbench.analysis.structures.machine.reduce_machine import (
    ReducedMachine,
    reduce_machine,
)
from jointbench.analysis.structures.reduction.reduction_cache import CACHE_VERSION
from jointbench.station.machine.machine_file import (
    MachineModel,
    machine_of,
    settings_of,
    speeds_of,
    springs_of,
)

# Tables of the model that a reduction depends on, whole.
_WHOLE = ("materials", "supports", "masses", "points")
# What of joints, springs and turning bodies only multiplies their matrices.
_VALUES = {
    "speed",
    "stiffness",
    "damping",
    "rotational_stiffness",
    "rotational_damping",
    "stiffness_sd",
    "damping_sd",
}
_FILES = ("mesh", "stiffness", "mass")


def reduced_machine_of(
    model: MachineModel, folder: Path, cache: Path | None
) -> ReducedMachine:
    """Reduce the machine of a model file, or read it from the cache.

    With measured bodies only its meshed bodies are kept.

    Args:
        model: the file.
        folder: of the files that it names.
        cache: folder of reduced machines and bodies; None keeps none.

    Returns:
        The machine, with the values of its joints.
    """
    band = model.analysis.band
    if cache is None or model.measured:
        return reduce_machine(machine_of(model, folder), band, cache=cache)
    key = machine_key(model, folder)
    found = read_machine(
        cache, key, settings_of(model), springs_of(model), speeds_of(model)
    )
    if found is None:
        found = reduce_machine(machine_of(model, folder), band, cache=cache)
        write_machine(cache, key, found)
    return found


def machine_key(model: MachineModel, folder: Path) -> str:
    """Return the SHA-256 of all that the reduction of a machine depends on.

    Args:
        model: the file.
        folder: of the files that it names.
    """
    every = model.model_dump(mode="json")
    parts: dict[str, Any] = {name: every[name] for name in _WHOLE}
    parts["bodies"] = {
        name: table | {one: _content(folder, table[one]) for one in _FILES}
        for name, table in every["bodies"].items()
    }
    for kind in ("joints", "springs", "beams", "rigid"):
        parts[kind] = {
            name: {key: one for key, one in table.items() if key not in _VALUES}
            for name, table in every[kind].items()
        }
    patterns = {name: one["pattern"] for name, one in every["joints"].items()}
    parts["patterns"] = {
        name: _content(folder, one) for name, one in patterns.items() if one
    }
    parts["band"] = model.analysis.band
    text = json.dumps([CACHE_VERSION, parts], sort_keys=False)
    return "machine-" + hashlib.sha256(text.encode()).hexdigest()


def _content(folder: Path, file: str | None) -> str | None:
    """Return the SHA-256 of a file; its name where it cannot be read."""
    if file is None:
        return None
    try:
        return hashlib.sha256((folder / file).read_bytes()).hexdigest()
    except OSError:
        return file  # the reader of the file refuses it
