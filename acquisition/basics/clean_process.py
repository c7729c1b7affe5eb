# SPDX-License-Identifier: MIT
"""Processes that begin without the main module of the program that starts them."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

_ONE_AT_A_TIME = Lock()
"""Processes start from several threads; each restores the module as it found it."""


@contextmanager
def without_main() -> Iterator[None]:
    """Hide the main module from a process that starts meanwhile.

    `multiprocessing` would import it there again: all modules of the caller, and a
    script that measures without a guard would measure twice.
    """
    with _ONE_AT_A_TIME:
        main = sys.modules["__main__"]
        hidden: dict[str, object] = {
            name: vars(main).pop(name)
            for name in ("__file__", "__spec__")
            if name in vars(main)
        }
        vars(main)["__spec__"] = None
        try:
            yield
        finally:
            vars(main).update(hidden)
