# SPDX-License-Identifier: MIT
"""Deformed bodies of a machine as 3-D plots."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.machine.reduce_machine import ReducedMachine
from jointbench.station.screen.figures import Figure
from jointbench.station.screen.plot_numbers import numbers

SHARE_OF_MACHINE = 0.06
"""Largest displacement drawn, as a share of the machine's size."""


def shape_plots(machine: ReducedMachine, shape: FloatArray, turn: FloatArray) -> Figure:
    """Return all bodies deformed by a shape, coloured by displacement.

    Args:
        machine: with the surfaces of its bodies.
        shape: in the few coordinates, shape (r,).
        turn: from these to those of the machine, shape (n, r).
    """
    moved = turn @ shape
    parts = [
        (name, surface, (rows @ moved[body.place]).reshape(-1, 3))
        for body in machine.bodies
        for (name, surface), rows in zip(body.surfaces, body.motions, strict=True)
    ]
    nodes = np.concatenate([surface.nodes for _, surface, _ in parts])
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    largest = max(float(np.linalg.norm(one, axis=1).max()) for _, _, one in parts)
    traces: list[dict[str, object]] = []
    for name, surface, motion in parts:
        place = surface.nodes + motion * (
            SHARE_OF_MACHINE * size / max(largest, 1e-300)
        )
        traces.append(
            {
                "type": "mesh3d",
                "name": name,
                "hoverinfo": "name",
                **{key: numbers(place[:, k]) for k, key in enumerate("xyz")},
                **{
                    key: surface.triangles[:, k].tolist() for k, key in enumerate("ijk")
                },
                "intensity": numbers(
                    np.linalg.norm(motion, axis=1) / max(largest, 1e-300)
                ),
                "cmin": 0,
                "cmax": 1,
                "colorscale": "Viridis",
                "showscale": False,
                "flatshading": True,
            }
        )
    scene = {
        "aspectmode": "data",
        **{f"{key}axis": {"title": {"text": f"{key} [m]"}} for key in "xyz"},
    }
    return {
        "data": traces,
        "layout": {"scene": scene, "margin": dict.fromkeys("lrtb", 0)},
    }
