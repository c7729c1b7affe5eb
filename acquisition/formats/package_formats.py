# SPDX-License-Identifier: MIT
"""Which of the registered formats takes a file, and which package it comes from."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.basics.registry import Entry, Named, PluginFault, warn_once
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.acquisition.records.provenance import Step, step

_Format = TypeVar("_Format", bound=Named)


def matching_format(
    entries: Sequence[Entry[_Format]], takes: Callable[[_Format], bool], path: Path
) -> Entry[_Format] | None:
    """Return the format of a file: one of a package, else the first built-in one.

    Args:
        entries: of the registry, in its order.
        takes: whether a format takes the file.
        path: of the file, for messages.

    Returns:
        The entry, None where no format takes the file.

    Raises:
        UsageError: formats of two packages take it.
    """
    foreign = [
        entry for entry in entries if not entry.built_in and _recognised(entry, takes)
    ]
    if len(foreign) > 1:
        claims = " and ".join(f"{e.value.name!r} of {e.package}" for e in foreign)
        raise UsageError(
            f"{named(path)} is taken by the formats {claims}; a file must have one "
            "format: uninstall one of these packages"
        )
    own = (entry for entry in entries if entry.built_in and takes(entry.value))
    return foreign[0] if foreign else next(own, None)


def _recognised(entry: Entry[_Format], takes: Callable[[_Format], bool]) -> bool:
    """Return whether a format of a package takes the file; a failure is a no.

    A file that cannot be read as text, say, is none of a text format; the built-in
    formats look at it next.
    """
    try:
        with entry.running(PluginFault):
            return takes(entry.value)
    except BadData:
        return False
    except PluginFault as error:
        warn_once(str(error))
        return False


def added_by(entry: Entry[_Format], path: Path) -> Step:
    """Return the step of provenance of a file that a package has read."""
    return step(
        "package",
        format=entry.value.name,
        package=entry.package,
        file=path.name,
        sha256=file_digest(path),
    )
