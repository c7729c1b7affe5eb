# SPDX-License-Identifier: MIT
"""The files of the front end, as they are in the package."""

from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable

_TYPES = {
    "css": "text/css; charset=utf-8",
    "js": "text/javascript; charset=utf-8",
    "svg": "image/svg+xml",
}


COLOUR_STYLES = ("palette.css", "screen_roles.css")
"""Colours of reports and screens, and the roles that only screens have."""


@dataclass(frozen=True, slots=True)
class Asset:
    """One file.

    Attributes:
        name: below ``/assets/``.
        type: as in the header Content-Type.
        content: bytes.
    """

    name: str
    type: str
    content: bytes


def screen_assets() -> tuple[Asset, ...]:
    """Return the files that a browser may ask for, colours included."""
    drawing = files("jointbench.station.drawing")
    colours = (
        Asset(name, _TYPES["css"], drawing.joinpath(name).read_bytes())
        for name in COLOUR_STYLES
    )
    room = files("jointbench.station.browser").joinpath("assets")
    return (*colours, *_below(room, ""))


def _below(folder: Traversable, prefix: str) -> Iterator[Asset]:
    for entry in folder.iterdir():
        kind = _TYPES.get(entry.name.rpartition(".")[2])
        if entry.is_dir():
            yield from _below(entry, f"{prefix}{entry.name}/")
        elif kind is not None:
            yield Asset(prefix + entry.name, kind, entry.read_bytes())
