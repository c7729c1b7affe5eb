# SPDX-License-Identifier: MIT
"""Arguments of the library, checked where they come in: one line each."""

from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError

_BAND = 2


def one_path(name: str | Path, what: str) -> Path:
    """Return the name of one file or folder as a path.

    Args:
        name: as given.
        what: what the file is, for the message: ``"a model"``.

    Raises:
        UsageError: it is no file name.
    """
    if not isinstance(name, str | Path) or not str(name):
        raise UsageError(f"{name!r} is no file name; give the path of {what}")
    return Path(name)


def require_texts(example: str, **given: object) -> None:
    """Refuse arguments that are neither a text nor None.

    Args:
        example: of such a text, for the message.
        given: the arguments by name.

    Raises:
        UsageError: one is of another type.
    """
    for name, value in given.items():
        if value is not None and not isinstance(value, str):
            raise UsageError(f"{name} is {value!r}; give a text, for example {example}")


def require_lists(example: str, **given: object) -> None:
    """Refuse arguments that are no list or tuple; a text is none.

    Args:
        example: of such a list, for the message.
        given: the arguments by name.

    Raises:
        UsageError: one is of another type.
    """
    for name, value in given.items():
        if isinstance(value, str) or not isinstance(value, Sequence):
            raise UsageError(f"{name} is {value!r}; give a list, for example {example}")


def checked_band(band: tuple[float, float] | None) -> tuple[float, float] | None:
    """Return a band as two numbers [Hz].

    Raises:
        UsageError: it is not a pair of numbers.
    """
    if band is None:
        return None
    pair = isinstance(band, Sequence) and len(band) == _BAND
    if not pair or not all(isinstance(one, int | float) for one in band):
        raise UsageError(
            f"band is {band!r}; give lowest and highest frequency in Hz, for example "
            "(50, 5000)"
        )
    return band
