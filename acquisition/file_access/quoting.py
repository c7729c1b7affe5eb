# SPDX-License-Identifier: MIT
"""Foreign texts and paths quoted in messages: one line, every character visible."""

import re
from pathlib import Path

_SHOWN = 60
_SHOWN_PATH = 160
# Letters and marks that Unicode counts as printable although they are invisible:
# joiner, fillers of Hangul, inherent vowels of Khmer, selectors of a variant.
_NO_WIDTH = re.compile(
    "[\u034f\u115f\u1160\u17b4\u17b5\u3164\uffa0\ufe00-\ufe0f\U000e0100-\U000e01ef]"
)


def shown(text: object) -> str:
    """Return `text` in quotes on one line, cut short, for a message."""
    plain = str(text)
    return visible(repr(plain if len(plain) <= _SHOWN else plain[:_SHOWN] + "..."))


def named(path: Path | str) -> str:
    """Return a path in quotes on one line for a message; a long one keeps its end."""
    plain = str(path)
    cut = plain if len(plain) <= _SHOWN_PATH else "..." + plain[-_SHOWN_PATH:]
    return visible(repr(cut))


def visible(text: str) -> str:
    r"""Return `text` with every invisible character as its escape.

    Names in files may contain line ends, terminal control sequences, marks that reverse
    the direction of writing, letters of zero width, or bytes that are no text. All
    output of texts from files (terminal, message, CSV, HTML, universal file) passes
    through this function; JSON escapes by itself, binary formats keep it.

    >>> visible("a1\x1b[2J")
    'a1\\x1b[2J'
    """
    if text.isprintable() and not _NO_WIDTH.search(text):
        return text
    return "".join(
        one if one.isprintable() and not _NO_WIDTH.match(one) else _escape(one)
        for one in text
    )


def _escape(character: str) -> str:
    """Return the Python escape of a character, visible or not."""
    written = repr(character)[1:-1]
    return written if written != character else f"\\u{ord(character):04x}"
