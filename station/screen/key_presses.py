# SPDX-License-Identifier: MIT
"""Keys from a terminal, without waiting and without Enter."""

import codecs
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

Poll = Callable[[], str]
"""Returns the keys pressed since the last call; empty without any."""
# Arrow and function keys: ESC, [ or O, parameters, a letter.
_SEQUENCE = re.compile("\x1b[\\[O][0-9;]*[A-Za-z~]")

if sys.platform == "win32":
    import msvcrt

    _LEADS = ("\x00", "\xe0")  # of arrow and function keys

    @contextmanager
    def keyboard() -> Iterator[Poll]:
        """Yield a function that polls the keyboard."""
        yield _pressed

    def _pressed() -> str:
        found = ""
        while msvcrt.kbhit():
            key = msvcrt.getwch()
            if key in _LEADS:
                msvcrt.getwch()
            else:
                found += key
        return found
else:
    import select
    import termios
    import tty

    _MOST = 1024  # bytes of one look

    @contextmanager
    def keyboard() -> Iterator[Poll]:
        """Yield a function that polls the keyboard; restore the terminal afterwards."""
        if not sys.stdin.isatty():
            yield lambda: ""
            return
        number = sys.stdin.fileno()
        before = termios.tcgetattr(number)
        tty.setcbreak(number)
        try:
            yield _poll(number)
        finally:
            with suppress(termios.error):  # a closed terminal
                termios.tcsetattr(number, termios.TCSADRAIN, before)

    def _poll(number: int) -> Poll:
        # A letter outside ASCII is several bytes, which may come apart.
        decoder = codecs.getincrementaldecoder("utf-8")("replace")

        def pressed() -> str:
            ready, _, _ = select.select([number], [], [], 0)
            with suppress(OSError):  # a closed terminal is always ready
                text = decoder.decode(os.read(number, _MOST)) if ready else ""
                return _SEQUENCE.sub("", text)
            return ""

        return pressed
