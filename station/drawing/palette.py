# SPDX-License-Identifier: MIT
"""Colours of reports and screens by meaning; `palette.css` beside this file has values.

A figure names a role, never a value, so that one colour has one meaning in every
report, light, dark or printed. Figures of other packages may name values.
"""

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
