# SPDX-License-Identifier: MIT
"""Colours of traces as class and style of the report, and nothing else."""

import re

from jointbench.station.drawing.palette import MEANINGS, MEASURED

_ROLE = re.compile(r"var\(--([a-z]+)\)")
_VALUE = re.compile(r"#[0-9a-fA-F]{3,8}|rgba?\([0-9., %]{1,40}\)")


def colour_attributes(color: object, *, otherwise: str = MEASURED) -> tuple[str, str]:
    """Return class and style that draw in a colour; anything else gives `otherwise`.

    Args:
        color: a role, or a value of another package: #rgb, #rrggbb, rgb() or rgba().
        otherwise: role for a colour that is none.

    >>> colour_attributes("var(--model)"), colour_attributes("#0b5cab")
    (('c-model', ''), ('', '--c:#0b5cab'))
    >>> colour_attributes("red;} body {")
    ('c-measured', '')
    """
    text = color if isinstance(color, str) else otherwise
    role = _ROLE.fullmatch(text)
    if role and text in MEANINGS:
        return f"c-{role[1]}", ""
    if _VALUE.fullmatch(text):
        return "", f"--c:{text}"
    return colour_attributes(otherwise)
