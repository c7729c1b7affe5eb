# SPDX-License-Identifier: MIT
"""Colours, legend and lower limits that all pictures of a gap share."""

MEASURED, BEFORE, AFTER = "#1c2733", "#d1495b", "#0b5cab"
LEGEND = {"orientation": "h", "x": 0, "yanchor": "bottom", "traceorder": "normal"}
LOWEST_BAR = 0.5
"""Where the bars of chi2/dof start: below 1, so that noise is seen as a short bar."""
SMALLEST_TOP = 10.0
