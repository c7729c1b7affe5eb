# SPDX-License-Identifier: MIT
"""The report on the joints of a structure: parameters, likelihoods, mode shapes."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.records.session import software_version
from jointbench.analysis.lumped.identified import JointParameter
from jointbench.analysis.structures.identification.joint_result import (
    StateFit,
    StructureIdentification,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.meshes.elements import ELEMENTS
from jointbench.analysis.structures.meshes.mesh import outer_faces
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    motion_of,
    solve_reduced,
)
from jointbench.station.drawing.palette import GUIDE
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.joint_text import interval_text
from jointbench.station.screen.page import write_report
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    Plot,
    Report,
    Section,
    Text,
    Tile,
)
from jointbench.station.screen.plot_numbers import numbers
from jointbench.station.screen.traces import line
from jointbench.station.screen.value_text import with_sd

SHAPES_SHOWN = 6
SHARE_OF_SIZE = 0.06
"""Largest displacement drawn, as a share of the structure's size."""


def write_structure_report(
    path: Path,
    name: str,
    structure: Structure,
    model: ReducedModel,
    result: StructureIdentification,
    more: Sequence[Section | None] = (),
    *,
    simulated: bool = False,
) -> None:
    """Write one offline HTML report about identified joints.

    Args:
        path: of the HTML file.
        name: of the model.
        structure: bodies and joints.
        model: the same, reduced.
        result: of the identification.
        more: further sections, after the parameters; None are left out.
        simulated: whether a session was.
    """
    sections = [
        Section("parameters", "Joints", (_parameters(result), *_reasons(result))),
        *(one for one in more if one is not None),
        Section("states", "Modes", tuple(_state(one, model) for one in result.states)),
        Section("profiles", "Profile likelihood", tuple(_profiles(result))),
        Section("solutions", "Distinct solutions", (_solutions(result),)),
        Section("shapes", "Mode shapes", tuple(_shapes(structure, model, result))),
    ]
    report = Report(
        title=f"Joints of {name}",
        lead=f"{structure.size} degrees of freedom, reduced to {model.size}.",
        software=software_version(),
        simulated=simulated,
        tiles=tuple(
            Tile(
                one.name,
                f"{_tile(one)} {one.unit}",
                _identifiable_words(one.identifiable),
            )
            for one in result.parameters[:6]
        ),
        sections=tuple(section for section in sections if section.items),
    )
    write_report(report, path)


def _tile(one: JointParameter) -> str:
    return f"{one.value:.4g}" if one.identifiable else interval_text(one.interval)


def _identifiable_words(identifiable: bool) -> str:
    return "identifiable" if identifiable else "not identifiable"


def _parameters(result: StructureIdentification) -> DataTable:
    rows = tuple(
        (
            one.name,
            with_sd(one.value, one.sd) if one.identifiable else "-",
            one.unit,
            interval_text(one.interval),
            _identifiable_words(one.identifiable),
        )
        for one in result.parameters
    )
    columns = ("parameter", "value ± sd", "unit", "95 % interval", "verdict")
    return DataTable(
        f"Identification {result.verdict.value}; standard deviations from the measured "
        "covariance. The interval of a parameter that is not identifiable covers all "
        "admissible solutions.",
        columns,
        rows,
        frozenset({"not identifiable"}),
    )


def _reasons(result: StructureIdentification) -> tuple[Item, ...]:
    return tuple(Text(reason, "notice") for reason in result.reasons)


def _state(state: StateFit, model: ReducedModel) -> DataTable:
    shares = state.energy_share
    rows = tuple(
        (
            f"{state.measured[at]:.5g}" if at < state.measured.size else "-",
            f"{frequency:.5g}",
            f"{100 * state.damping_ratio[at]:.3g}",
            f"{state.mac[at]:.3f}" if at < state.mac.size else "-",
            *(f"{100 * share:.1f}" for share in shares[at]),
        )
        for at, frequency in enumerate(state.predicted)
    )
    columns = (
        "measured [Hz]",
        "predicted [Hz]",
        "damping [%]",
        "MAC",
        *(f"energy in {name} [%]" for name in model.names),
    )
    return DataTable(f"State {state.label}", columns, rows)


def _profiles(result: StructureIdentification) -> list[Item]:
    found: list[Item] = []
    for number, (name, profile) in enumerate(result.profiles.items()):
        rise = profile.chi2 - profile.chi2.min()
        limit = np.full(profile.value.size, 3.84)
        curves = [
            line(profile.value, rise, "delta chi2"),
            line(profile.value, limit, "95 %", color=GUIDE, dash="dash"),
        ]
        plot = figure(curves, axis(name, log=True), axis("delta chi2 [-]"))
        found.append(Plot(f"profile-{number}", f"Profile of {name}", plot, 280))
    return found


def _solutions(result: StructureIdentification) -> DataTable:
    names = tuple(one.name for one in result.parameters)
    rows = tuple(
        (
            f"{one.chi2:.4g}",
            "admissible" if one.admissible else "excluded",
            *(f"{one.parameters[name]:.4g}" for name in names),
        )
        for one in result.solutions
    )
    return DataTable(
        "Solutions of all starts, best first.", ("chi2", "verdict", *names), rows
    )


def _shapes(
    structure: Structure, model: ReducedModel, result: StructureIdentification
) -> list[Item]:
    """Return the lowest elastic shapes of the best solution as 3-D plots."""
    found = solve_reduced(model, result.states[0].stiffness)
    elastic = np.flatnonzero(found.natural_frequency > 0)[:SHAPES_SHOWN]
    items: list[Item] = []
    for at in elastic:
        motion = np.zeros(3 * structure.nodes.shape[0])
        motion[structure.free] = motion_of(model, found.shapes[:, at : at + 1])[:, 0]
        frequency = float(found.natural_frequency[at])
        plot = shape_figure(structure, motion.reshape(-1, 3))
        items.append(
            Plot(f"shape-{at}", f"{frequency:.1f} Hz; drag to rotate", plot, 420)
        )
    return items


def shape_figure(structure: Structure, motion: FloatArray) -> Figure:
    """Return bodies deformed by a shape, coloured by displacement.

    Args:
        structure: bodies and joints.
        motion: of all nodes, of any scale, shape (n_nodes, 3).
    """
    size = float(np.linalg.norm(np.ptp(structure.nodes, axis=0)))
    largest = float(np.linalg.norm(motion, axis=1).max())
    place = structure.nodes + motion * (SHARE_OF_SIZE * size / max(largest, 1e-300))
    moved = np.linalg.norm(motion, axis=1) / max(largest, 1e-300)
    traces: list[dict[str, object]] = []
    for at, body in enumerate(structure.bodies):
        begin = int(structure.first_node[at])
        triangles = _triangles(structure, at)
        used, corner = np.unique(triangles, return_inverse=True)
        corner = corner.reshape(triangles.shape)
        traces.append(
            {
                "type": "mesh3d",
                "name": body.name,
                **{key: numbers(place[begin + used, k]) for k, key in enumerate("xyz")},
                **{key: corner[:, k].tolist() for k, key in enumerate("ijk")},
                "intensity": numbers(moved[begin + used]),
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


def _triangles(structure: Structure, at: int) -> IntArray:
    mesh = structure.bodies[at].mesh
    corners = outer_faces(mesh).nodes[:, : ELEMENTS[mesh.kind].face_corners]
    halves = [corners[:, [0, 1, 2]]]
    if corners.shape[1] > 3:
        halves.append(corners[:, [0, 2, 3]])
    return np.concatenate(halves)
