# SPDX-License-Identifier: MIT
"""The report on an exported joint: where its pieces are, and along which axes."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.session import software_version
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.meshes.elements import ELEMENTS
from jointbench.analysis.structures.meshes.mesh import outer_faces
from jointbench.station.drawing.palette import GUIDE, MEMBERS, MODEL
from jointbench.station.joint_files.export_files import WrittenFile
from jointbench.station.joint_files.export_run import JointExport
from jointbench.station.screen.figures import Figure
from jointbench.station.screen.joint_text import interval_text
from jointbench.station.screen.page import write_report
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    Plot,
    Report,
    Section,
    Tile,
)
from jointbench.station.screen.plot_numbers import numbers
from jointbench.station.screen.value_text import with_sd

# Length of the drawn axes, as a share of the size of the structure.
_AXIS_SHARE = 0.12
_AXES = tuple(zip(("normal", "t1", "t2"), MEMBERS, strict=False))


def write_joint_page(
    path: Path, joint: JointExport, files: Sequence[WrittenFile], checks: DataTable
) -> None:
    """Write the drawing, the values, the pieces and the files of a joint.

    Args:
        path: to write.
        joint: exported.
        files: that were written.
        checks: frequencies beside each other.
    """
    drawing: tuple[Item, ...] = (
        Plot(
            "frame",
            "The pieces of the joint and their axes; drag to rotate",
            joint_figure(joint),
            520,
        ),
    )
    sections = (
        Section("frame", "Pieces and axes", drawing),
        Section("values", "Values", (_values(joint),)),
        Section("pieces", "Pieces", (_pieces(joint),)),
        Section("checks", "Frequencies", (checks,)),
        Section("files", "Files", (_files(files),)),
    )
    report = Report(
        title=f"Joint {joint.name}",
        lead=f"{len(joint.pieces)} pieces, {joint.pieces[0].area:.4g} m^2 the first; "
        f"state {joint.values.label or 'of the file'}.",
        software=software_version(),
        simulated=False,
        tiles=tuple(
            Tile(one.name, f"{one.value:.4g} {one.unit}", interval_text(one.interval))
            for one in joint.values.of_joint(joint.name)[:6]
        ),
        sections=sections,
    )
    write_report(report, path)


def joint_figure(joint: JointExport) -> Figure:
    """Return the bodies, translucent, with the axes of each piece."""
    structure = joint.structure
    traces = [_body(structure, at) for at in range(len(structure.bodies))]
    size = float(np.linalg.norm(np.ptp(structure.nodes, axis=0)))
    face = structure.faces[structure.joints.index(joint.name)]
    traces.append(
        {
            "type": "scatter3d",
            "mode": "markers",
            "name": "area of the joint",
            **_places(face.points.position),
            "marker": {"size": 2, "color": MODEL},
        }
    )
    traces += _arrows(joint, _AXIS_SHARE * size)
    scene = {
        "aspectmode": "data",
        "camera": {"eye": {"x": 0.9, "y": -1.7, "z": 1.2}},
        **{f"{key}axis": {"title": {"text": f"{key} [m]"}} for key in "xyz"},
    }
    legend = {"orientation": "h", "x": 0, "y": 0, "yanchor": "bottom"}
    layout = {
        "scene": scene,
        "margin": dict.fromkeys("lrtb", 0),
        "showlegend": True,
        "legend": legend,
    }
    return {"data": traces, "layout": layout}


def _body(structure: Structure, at: int) -> dict[str, object]:
    mesh = structure.bodies[at].mesh
    corners = outer_faces(mesh).nodes[:, : ELEMENTS[mesh.kind].face_corners]
    halves = [corners[:, [0, 1, 2]]]
    if corners.shape[1] > 3:
        halves.append(corners[:, [0, 2, 3]])
    used, corner = np.unique(np.concatenate(halves), return_inverse=True)
    corner = corner.reshape(-1, 3)
    return {
        "type": "mesh3d",
        "name": structure.bodies[at].name,
        **_places(mesh.nodes[used]),
        **{key: corner[:, k].tolist() for k, key in enumerate("ijk")},
        "color": GUIDE,
        "opacity": 0.25,
        "hoverinfo": "name",
        "flatshading": True,
    }


def _arrows(joint: JointExport, length: float) -> list[dict[str, object]]:
    """Return a line with its name at the end for each axis of each piece."""
    traces: list[dict[str, object]] = []
    for axis, (name, color) in enumerate(_AXES):
        ends = [one.centre + length * one.frame[axis] for one in joint.pieces]
        gap = np.full(3, np.nan)
        pairs = zip(joint.pieces, ends, strict=True)
        rows = [row for one, end in pairs for row in (one.centre, end, gap)]
        traces.append(
            {
                "type": "scatter3d",
                "mode": "lines",
                "name": name,
                **_places(np.array(rows)),
                "line": {"color": color, "width": 6},
            }
        )
        traces.append(
            {
                "type": "scatter3d",
                "mode": "markers+text",
                "name": name,
                "showlegend": False,
                **_places(np.array(ends)),
                "text": [name] * len(ends),
                "textposition": "top center",
                "textfont": {"color": color, "size": 12},
                "marker": {"size": 4, "color": color, "symbol": "diamond"},
            }
        )
    return traces


def _places(points: FloatArray) -> dict[str, object]:
    return {key: numbers(points[:, k]) for k, key in enumerate("xyz")}


def _values(joint: JointExport) -> DataTable:
    rows = tuple(
        (
            one.name,
            with_sd(one.value, one.sd) if one.sd is not None else f"{one.value:.5g}",
            one.unit,
            interval_text(one.interval),
            "identifiable" if one.identifiable else "not identifiable",
        )
        for one in joint.values.of_joint(joint.name)
    )
    columns = ("parameter", "value ± sd", "unit", "95 % interval", "verdict")
    caption = "Totals over the whole joint."
    return DataTable(caption, columns, rows, frozenset({"not identifiable"}))


def _pieces(joint: JointExport) -> DataTable:
    rows = tuple(
        (
            one.name,
            ", ".join(f"{x:.4g}" for x in one.centre),
            f"{one.area:.4g}",
            *(f"{one.stiffness[k, k]:.4g}" for k in range(6)),
        )
        for one in joint.pieces
    )
    columns = (
        "piece",
        "centre [m]",
        "area [m^2]",
        "k normal [N/m]",
        "k t1 [N/m]",
        "k t2 [N/m]",
        "about normal [N m/rad]",
        "about t1 [N m/rad]",
        "about t2 [N m/rad]",
    )
    return DataTable("Each piece as one spring of six components.", columns, rows)


def _files(files: Sequence[WrittenFile]) -> DataTable:
    rows = tuple(
        (
            one.path.name,
            one.content,
            "-" if one.difference is None else f"{one.difference:.0e}",
        )
        for one in files
    )
    caption = "Files, and the largest relative difference when read back."
    return DataTable(caption, ("file", "content", "read back"), rows)
