# SPDX-License-Identifier: MIT
"""TOML of unknown origin: checked before it is parsed.

``tomllib`` takes time and memory with the square of the parts of a dotted key: 100 kB
of ``a.a.a. ... = 1`` took 100 s and 4 GB. No file of the station nests so deep,
so depth is bounded before the parser begins.
"""

import re
import tomllib
from pathlib import Path
from typing import Any

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.text_files import file_size

MOST_BYTES = 1_000_000
MOST_PARTS = 16
"""Of a dotted key."""
DEEPEST = 64
"""Brackets and braces inside each other."""
# Strings and comments; one without its end takes the rest, which the parser refuses.
_QUOTED = re.compile(
    r'"""(?:[^\\]|\\.)*?(?:"""|\Z)|' + r"'''.*?(?:'''|\Z)|"
    r'"(?:[^"\\\n]|\\.)*+"?|' + r"'[^'\n]*+'?|#[^\n]*+",
    re.DOTALL,
)
_DOTTED = re.compile(rf"(?<![\w-])[\w-]++(?:[ \t]*+\.[ \t]*+[\w-]++){{{MOST_PARTS},}}")
_BRACKET = re.compile(r"[\[\]{}]")


def load_toml(path: Path) -> dict[str, Any]:
    """Return the content of a TOML file.

    Args:
        path: of the file.

    Raises:
        BadData: it is too large, or nests deeper than any file of the station.
        OSError: it cannot be read.
        ValueError: it is not TOML, or not UTF-8.
        RecursionError: it is not TOML, in a way that the parser does not foresee.
    """
    # Python's own words for a path that cannot be; a device has no end to read.
    if path.exists() and file_size(path) > MOST_BYTES:
        raise BadData(f"{named(path)} is larger than {MOST_BYTES} bytes, no model file")
    text = path.read_text(encoding="utf-8-sig")
    _require_flat(text, path)
    return tomllib.loads(text)


def _require_flat(text: str, path: Path) -> None:
    plain = _QUOTED.sub("s", text)
    dotted = _DOTTED.search(plain)
    if dotted:
        raise BadData(
            f"{named(path)}: line {plain.count(chr(10), 0, dotted.start()) + 1}: a key "
            f"has more than {MOST_PARTS} parts; no table nests so deep"
        )
    depth = 0
    for bracket in _BRACKET.finditer(plain):
        depth += 1 if bracket[0] in "[{" else -1
        if depth > DEEPEST:
            raise BadData(
                f"{named(path)}: more than {DEEPEST} brackets stand inside each other; "
                "no value nests so deep"
            )
