# SPDX-License-Identifier: MIT
"""Mode shapes of the desk, as JSON types: to be animated and compared."""

import numpy as np

from jointbench.signal.modal.shape_checks import check_shapes
from jointbench.station.desk.desk_state import DeskState
from jointbench.station.desk.frf_pages import Page
from jointbench.station.schemas.geometry_file import draw_shapes
from jointbench.station.screen.plot_numbers import numbers


def shapes_page(state: DeskState) -> Page:
    """Return points, motion of each mode, AutoMAC, and how real each shape is.

    Raises:
        BadData: the geometry lacks a point.
    """
    model, subject = state.chain.result.model, state.subject
    drawn = draw_shapes(model, subject.geometry, subject.directions)
    roved = len(model.inputs) > len(model.outputs)
    shapes = model.participation if roved else model.shapes
    checks = check_shapes(shapes)
    labels = model.inputs if roved else model.outputs
    size = np.max(np.abs(shapes), axis=1, initial=0.0)[:, None]
    unit = shapes / np.where(size > 0.0, size, 1.0)
    return {
        "measured": drawn.measured,
        "names": list(drawn.names),
        "place": [numbers(row) for row in drawn.place],
        "lines": [list(pair) for pair in drawn.lines],
        "labels": list(labels),
        "mac": [numbers(row) for row in checks.mac],
        "modes": [
            {
                "frequency_hz": float(model.natural_frequency[i]),
                "damping_ratio": float(model.damping_ratio[i]),
                "mpc": float(checks.collinearity[i]),
                "mpd_deg": float(np.degrees(checks.deviation[i])),
                "re": [numbers(row) for row in drawn.motion[i].real],
                "im": [numbers(row) for row in drawn.motion[i].imag],
                "shape_re": numbers(unit[i].real),
                "shape_im": numbers(unit[i].imag),
            }
            for i in range(model.natural_frequency.size)
        ],
    }
