# SPDX-License-Identifier: MIT
"""The report of a chain as one HTML file."""

from jointbench.acquisition.records.session import software_version
from jointbench.analysis.gap.chain.chain_diagnosis import structure_holds
from jointbench.station.chain.chain_figure import HEIGHT, chain_figure
from jointbench.station.chain.chain_tables import (
    cause_rows,
    factor_title,
    hypothesis_rows,
    mode_rows,
    product_words,
    stiffness_rows,
)
from jointbench.station.chain.chain_words import chain_headline
from jointbench.station.chain.examine_chain import ExaminedChain
from jointbench.station.gap.contact_section import contact_sections
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    Plot,
    Report,
    Section,
    Text,
    Tile,
)

_SAVE = "Save as SVG writes it for a talk."
_CAPTION = (
    "Surfaces, stiffness of the joint over the preload, FRF and ring-down: measured, "
    "by the law of the surfaces alone, and with what was named. Each preload is "
    f"predicted from the others. {_SAVE}"
)


def chain_report(done: ExaminedChain) -> Report:
    """Arrange a chain as a report."""
    return Report(
        title=chain_headline(done),
        lead=f"Chain of {done.title}: surfaces, contact law, structure, hits.",
        software=f"{software_version()}: gap",
        simulated=done.simulated,
        tiles=_tiles(done),
        sections=chain_sections(done),
        findings=(f"{done.found.reason[:1].upper()}{done.found.reason[1:]}",),
    )


def chain_sections(done: ExaminedChain) -> tuple[Section, ...]:
    """Return the sections of a chain: figure, location, causes, what moves."""
    found = done.found
    tests = DataTable(
        "chi2 over degrees of freedom of each link with one free discrepancy at one "
        "interface; ! marks a link that does not explain its data. The law takes the "
        "spectrum as measured: surfaces are marked for faults of the instrument alone.",
        ("free discrepancy at", "surface", "contact law", "structure", "restored"),
        tuple(hypothesis_rows(done)),
    )
    return (
        Section(
            "chain",
            "The chain",
            (Plot("chain_figure", _CAPTION, chain_figure(done), HEIGHT),),
        ),
        Section("links", "Where the disagreement enters", (tests,)),
        Section("causes", "Causes at the joint", _causes(done)),
        Section("moved", "Every later quantity", _moved(done)),
        *(contact_sections(found.joint) if structure_holds(found.chain) else ()),
    )


def _tiles(done: ExaminedChain) -> tuple[Tile, ...]:
    found, s = done.found, done.stiffness
    links = " and ".join(one.value for one in found.links) or "none"
    tiles = [
        Tile("verdict", found.finding.value),
        Tile("enters at", links),
        Tile(
            "predicted within 95 %",
            f"{100 * s.inside:.0f} %",
            "of the preloads, each from the others",
        ),
    ]
    if found.several is not None:
        ratio = 1.0 / found.several.measured
        tiles.append(Tile("law over joint", f"{ratio:.3g}", "before"))
    if done.response is not None:
        before, after = done.response.errors
        tiles.append(
            Tile("ring-down residual", f"{before:.2g} → {after:.2g}", "over response")
        )
    return tuple(tiles)


def _causes(done: ExaminedChain) -> tuple[Item, ...]:
    rows = cause_rows(done)
    if not structure_holds(done.found.chain):
        return (Text("Not judged: the structure does not explain its own hits."),)
    if not rows:
        return (Text("No cause at the joint was named."),)
    columns = ("cause", "factor on the stiffness", "95 %")
    return (
        DataTable(f"{factor_title(done)}.", columns, tuple(rows)),
        Text(f"{product_words(done)}."),
    )


def _moved(done: ExaminedChain) -> tuple[Item, ...]:
    heads = ("preload", "law alone", "predicted", "measured", "within 95 %")
    modes = ("preload", "law alone", "predicted", "measured")
    return (
        DataTable("Stiffness of the joint [N/m].", heads, tuple(stiffness_rows(done))),
        DataTable("Natural frequencies [Hz].", modes, tuple(mode_rows(done))),
    )
