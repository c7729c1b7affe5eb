# SPDX-License-Identifier: MIT
"""The later stages of a recipe: surfaces, contact, links, gap."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from jointbench.acquisition.errors import JointbenchError
from jointbench.acquisition.records import Recording
from jointbench.acquisition.session import Session
from jointbench.acquisition.surfaces import Surface
from jointbench.analysis.gap.catalogue import CATALOGUE
from jointbench.analysis.gap.diagnose import diagnose
from jointbench.analysis.gap.records import diagnosis_json
from jointbench.analysis.gap.session_campaign import session_campaign
from jointbench.analysis.identification import identification_json
from jointbench.signal.fractal import fit_fractal
from jointbench.signal.structure_constant import DEFAULT_GAMMA
from jointbench.signal.structure_function import StructureFunction, structure_function
from jointbench.signal.surface_verdict import FractalFit
from jointbench.station.bench_model import ContactTable
from jointbench.station.chain import ModalChain
from jointbench.station.contact import contact_json
from jointbench.station.gap_model import gap_sheet
from jointbench.station.identify import identify_joint
from jointbench.station.joint import predict_joint
from jointbench.station.recipe import Recipe
from jointbench.station.stage_store import StageStore, stage_key
from jointbench.station.surface import SurfaceChain

Page = dict[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class PreloadModes:
    """Modes at one preload of the joint.

    Attributes:
        preload: [N], None where nobody said.
        recordings: names of those behind them.
        chain: hits, FRF and modes.
        key: of the stage that the modes came from.
    """

    preload: float | None
    recordings: tuple[str, ...]
    chain: ModalChain
    key: str


def at_words(preload: float | None) -> str:
    """Say at which preload, with a blank before it; nothing where nobody knows."""
    return "" if preload is None else f" at {preload:g} N"


def surface_stage(
    session: Session, digest: str, recipe: Recipe, stages: StageStore
) -> tuple[SurfaceChain, ...]:
    """Fit every surface of a session, or none where the recipe says so."""
    if not recipe.surface.use:
        return ()
    gamma = recipe.surface.gamma or DEFAULT_GAMMA
    return tuple(
        _surface(surface, digest, gamma, stages) for surface in session.surfaces
    )


def _surface(
    surface: Surface, digest: str, gamma: float, stages: StageStore
) -> SurfaceChain:
    first = stage_key("structure", None, digest, surface.name)
    structure = stages.run(
        f"structure of {surface.name}",
        first,
        StructureFunction,
        lambda: structure_function(surface),
    )
    name = f"surface {surface.name}"
    key = stage_key("surface", gamma, first)
    fit = stages.run(name, key, FractalFit, lambda: fit_fractal(structure, gamma=gamma))
    return SurfaceChain(surface, structure, fit)


def contact_stage(
    session: Session,
    surfaces: Sequence[SurfaceChain],
    recipe: Recipe,
    stages: StageStore,
    remarks: list[str],
) -> Page | None:
    """Predict the joint from the session's faces, if the recipe has a contact."""
    part = recipe.contact
    if part is None:
        return None
    if not surfaces:
        remarks.append("No contact prediction: no surface in the session is fitted")
        return None
    stored = None if session.joint is None else session.joint.preload
    preload = part.preload or stored
    if preload is None:
        remarks.append("No contact prediction: no preload in the recipe or the session")
        return None
    given = part.model_dump() | {"preload": preload}
    # Read as a table its numbers would need units again; they were checked there.
    table = ContactTable.model_construct(link="joint", **given)

    def make() -> Page:
        prediction = predict_joint([s.structure for s in surfaces], table)
        return contact_json([prediction.at], prediction.surface)

    inputs = [stages.keys[f"surface {s.surface.name}"] for s in surfaces]
    key = stage_key("contact", given, *inputs)
    return _page("contact", "contact prediction", key, make, stages, remarks)


def joint_stage(
    modes: PreloadModes, recipe: Recipe, stages: StageStore, remarks: list[str]
) -> Page | None:
    """Identify the links of the recipe's model from the modes at a preload."""
    if recipe.identification is None:
        return None
    bench = recipe.models[recipe.identification.model]
    key = stage_key("joint", bench.model_dump(mode="json"), modes.key)
    at, model = at_words(modes.preload), modes.chain.result.model
    return _page(
        f"joint{at}",
        f"joint identification{at}",
        key,
        lambda: identification_json(identify_joint(bench, model)),
        stages,
        remarks,
    )


def gap_stage(
    session: Session,
    judged: Sequence[Recording],
    recipe: Recipe,
    stages: StageStore,
    remarks: list[str],
) -> Page | None:
    """Ask what the recipe's model lacks, as `jointbench gap` does."""
    if recipe.gap is None or not judged:
        return None
    part = recipe.gap
    bench = recipe.models[part.model]
    of_session = None if session.joint is None else session.joint.preload
    recordings = [
        r if r.preload is not None else replace(r, preload=of_session) for r in judged
    ]

    def make() -> Page:
        campaign, left_out = session_campaign("session", recordings, gap_sheet(bench))
        found = diagnose(campaign, without=frozenset(part.without), entries=CATALOGUE)
        return diagnosis_json(found) | {"left_out": list(left_out)}

    settings = [bench.model_dump(mode="json"), sorted(part.without)]
    key = stage_key("gap", settings, stages.keys["hits"])
    return _page("gap", "gap", key, make, stages, remarks)


def _page(
    name: str,
    words: str,
    key: str,
    make: Callable[[], Page],
    stages: StageStore,
    remarks: list[str],
) -> Page | None:
    try:
        return stages.run(name, key, Page, make)
    except JointbenchError as error:
        remarks.append(f"No {words}: {error}")
        return None
