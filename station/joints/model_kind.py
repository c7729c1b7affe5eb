# SPDX-License-Identifier: MIT
"""Which kind of bench a model file describes."""

from pathlib import Path

from jointbench.acquisition.basics.errors import BadData
from jointbench.station.files.toml_text import load_toml


def describes_structure(model: Path) -> bool:
    """Return whether a model file has meshed bodies; False if it cannot be read."""
    try:
        content = load_toml(model)
    except (BadData, OSError, ValueError, RecursionError):
        return False  # the reader of lumped benches reports the error
    return "joints" in content
