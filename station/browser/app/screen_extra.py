# SPDX-License-Identifier: MIT
"""The packages that a screen in the browser needs beyond the others."""

from importlib.util import find_spec

from jointbench.acquisition.basics.errors import UsageError

_NEEDED = ("starlette", "uvicorn", "websockets")


def require_screen_extra() -> None:
    """Do nothing where the packages are installed.

    Raises:
        UsageError: one is missing; the message states how to install it.
    """
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        raise UsageError(
            f"the screen in the browser needs {', '.join(missing)}; install with "
            "pip install 'jointbench[screen]'"
        )
