# SPDX-License-Identifier: MIT
"""Single keys from a terminal, without waiting and without Enter."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

Poll = Callable[[], str]
"""Returns the key pressed since the last call; empty without one."""

if sys.platform == "win32":
    import msvcrt

    @contextmanager
    def keyboard() -> Iterator[Poll]:
        """Yield a function that polls the keyboard."""
        yield lambda: msvcrt.getwch() if msvcrt.kbhit() else ""
else:
    import select
    import termios
    import tty

    @contextmanager
    def keyboard() -> Iterator[Poll]:
        """Yield a function that polls the keyboard; restore the terminal afterwards."""
        if not sys.stdin.isatty():
            yield lambda: ""
            return
        before = termios.tcgetattr(sys.stdin)
        tty.setcbreak(sys.stdin)
        try:
            yield _pressed
        finally:
            with suppress(termios.error):  # a closed terminal
                termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)

    def _pressed() -> str:
        ready, _, _ = select.select([sys.stdin], [], [], 0)
        with suppress(OSError):  # a closed terminal is always ready
            return sys.stdin.read(1) if ready else ""
        return ""
