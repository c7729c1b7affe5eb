# SPDX-License-Identifier: MIT
"""Colours of reports by what they mean; `palette.css` beside this file has the values.

A figure names a role, never a value, so that one colour has one meaning in every
report, light, dark or printed. Figures of other packages may name values.
"""

import re

MEASURED, MODEL = "var(--measured)", "var(--model)"
REFUSED, GOOD = "var(--refused)", "var(--good)"
GUIDE, LAW = "var(--guide)", "var(--law)"
MEMBERS = ("var(--second)", "var(--third)", "var(--fourth)", "var(--fifth)")
"""Members of a set that are drawn in one figure: surfaces, laws, modes."""
MEANINGS = {
    MEASURED: "measured: samples, FRFs, surfaces, accepted hits",
    MODEL: "fitted to the measurement: synthesis, identified values, the model with "
    "what was named",
    REFUSED: "does not hold: rejected hits, the model before a correction, exceeded "
    "limits",
    GOOD: "accepted by a criterion: stable poles, noise bands",
    GUIDE: "guides: limits, noise floors, reference lines",
    LAW: "predicted without this measurement: contact laws",
    **dict.fromkeys(MEMBERS, "members of a set in one figure, named in its legend"),
}
"""What each colour means, in the order of the legend of a report."""

_ROLE = re.compile(r"var\(--([a-z]+)\)")
_VALUE = re.compile(r"#[0-9a-fA-F]{3,8}|rgba?\([0-9., %]{1,40}\)")


def colour_attributes(color: object, *, otherwise: str = MEASURED) -> tuple[str, str]:
    """Return class and style that draw in a colour; anything else gives `otherwise`.

    Args:
        color: a role, or a value of another package: #rgb, #rrggbb, rgb() or rgba().
        otherwise: role for a colour that is none.

    >>> colour_attributes(MODEL), colour_attributes("#0b5cab")
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
