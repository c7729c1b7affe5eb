"""Search the sentences about one diagnosis for contradictions."""

import json
import re

from rich.console import Console

from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Finding,
    diagnosis_json,
)
from jointbench.station.gap import gap_output
from jointbench.station.report.gap_report import gap_report
from jointbench.station.report.gap_sentences import next_step
from jointbench.station.screen.page_parts import Text

LINEAR = re.compile(r"(?<!not )proportional to the hit|cause is linear")
BENT = re.compile(
    r"not proportional to the hit|depends on the level|with level|even from odd"
    r"|symmetry:|at high level"
)
UNLIKE = "unlike the named effects"
GUESS = re.compile(
    r"so the cause|check that sensor|not in one sensor|another cause contributes"
    r"|user-defined effect|missing from the model|swap sensor|no effect of the"
)
APART = re.compile(r"distinguish the best two|: (hit|repeat|compare|look|phase|swap)")
NO_LEVEL = ("loosening",)
"""Effects that may resemble either: they depend on the order of the hits."""
BENDING = {e.effect.name for e in CATALOGUE if e.law is not None or e.shape is not None}


def sentences(found: Diagnosis) -> list[str]:
    """Return the texts of terminal, report and JSON about a diagnosis."""
    screen = Console(width=10_000, record=True, highlight=False, markup=False)
    gap_output.show_on(screen, found)
    page = gap_report(found, title="made")
    words = [i.text for s in page.sections for i in s.items if isinstance(i, Text)]
    evidence = diagnosis_json(found)["exhibit"]
    findings = [evidence["localisation"], *evidence["looks_like"]] if evidence else []
    # Paragraphs are indented: a line that begins with a blank continues the last one.
    terminal = re.sub(r"\n +(?!- )", " ", screen.export_text())
    return [
        *terminal.splitlines(),
        page.title,
        page.lead,
        *words,
        *findings,
        diagnosis_json(found)["experiment"],
        found.reason,
    ]


def contradictions(found: Diagnosis, hidden: frozenset[str]) -> list[str]:
    """Return the contradictions, one line each; empty if there are none.

    Args:
        found: the diagnosis.
        hidden: names of the hidden effects, as far as known.
    """
    lines = sentences(found)
    json.dumps(diagnosis_json(found))
    linear = [x for x in lines if LINEAR.search(x) and UNLIKE not in x]
    bent = [x for x in lines if BENT.search(x) and UNLIKE not in x]
    faults = [f"{linear[0]} | {bent[0]}"] if linear and bent else []
    faults += _against(found, hidden, linear, bent)
    if found.verdict is not Finding.UNKNOWN:
        faults += [f"guesses: {x}" for x in lines if GUESS.search(x)]
    if len(found.explanations) < 2:
        advice = [found.experiment, next_step(found)]
        faults += [f"no rival: {x}" for x in advice if APART.search(x)]
    if found.evidence is not None and found.evidence.advice not in (
        "",
        found.experiment,
    ):
        faults.append(f"{found.evidence.advice} | {found.experiment}")
    steps = [x for x in lines if x.startswith(("next:", "Do next:"))]
    faults += [f"{x} | {found.experiment}" for x in steps if found.experiment not in x]
    return faults


def _against(
    found: Diagnosis, hidden: frozenset[str], linear: list[str], bent: list[str]
) -> list[str]:
    """Return the sentences that contradict the named or the hidden effects."""
    faults = []
    for names in ({e.name for e in found.effects}, hidden):
        if not names or names & set(NO_LEVEL):
            continue
        if names <= BENDING:
            faults += [f"{sorted(names)}: {x}" for x in linear]
        elif not names & BENDING:
            faults += [f"{sorted(names)}: {x}" for x in bent]
    return faults
