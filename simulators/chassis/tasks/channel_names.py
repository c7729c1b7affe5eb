# SPDX-License-Identifier: MIT
"""Lists of names of virtual channels, as NI's client writes them."""

import re
from collections.abc import Collection

# "ai0:2"; a number of more digits is part of a name.
_SPAN = re.compile(r"(?P<base>.*?)(?P<first>\d{1,9}):(?P<last>\d{1,9})", re.ASCII)


def listed_names(text: str, *, at_most: int, known: Collection[str] = ()) -> list[str]:
    """Return the names in a list; ``ai0:2`` stands for three, unless it is a name.

    Args:
        text: names and spans, joined by commas.
        at_most: names of one span; the rest of a longer one is left out.
        known: names that are no spans, in lower case.
    """
    found: list[str] = []
    for word in (part.strip() for part in text.split(",")):
        match = None if word.lower() in known else _SPAN.fullmatch(word)
        if match is None:
            found.append(word)
            continue
        first, last = int(match["first"]), int(match["last"])
        step = 1 if last >= first else -1
        span = range(first, last + step, step)[:at_most]
        found += [f"{match['base']}{n}" for n in span]
    return found
