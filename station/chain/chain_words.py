# SPDX-License-Identifier: MIT
"""What ``jointbench gap --surface`` shows on a terminal, and its JSON."""

import textwrap
from collections.abc import Mapping
from typing import Any

from jointbench.analysis.gap.chain.chain_records import ChainLink, LinkTest
from jointbench.analysis.gap.model.diagnosis_record import Finding, diagnosis_json
from jointbench.station.chain.examine_chain import ExaminedChain
from jointbench.station.screen.terminal import console, table
from jointbench.station.screen.value_text import engineering

_WIDEST = 110
_NAMES = {
    ChainLink.SURFACE: "surface",
    ChainLink.CONTACT: "contact law",
    ChainLink.STRUCTURE: "structure",
}


def chain_headline(done: ExaminedChain) -> str:
    """Return the finding in one sentence."""
    found = done.found
    links = " and ".join(_NAMES[one] for one in found.links)
    if found.finding is Finding.NONE:
        return "Nothing is missing: surfaces, contact law and structure agree"
    if not links:
        return "The chain disagrees, and no single link accounts for it"
    names = cause_words(done)
    where = f"The disagreement enters at the {links}"
    if len(found.location.places) > 1:
        words = " or ".join(place.words for place in found.location.places)
        return f"The disagreement enters at {words}; these data cannot separate them"
    return f"{where}: {names}" if names else f"{where}; no effect explains it"


def cause_words(done: ExaminedChain) -> str:
    """Return what was named in words; sets that fit equally well joined by "or"."""
    several = done.found.several
    if done.found.links == (ChainLink.CONTACT,) and several is not None:
        own = " with ".join(_plain(cause.name) for cause in several.causes)
        others = [" with ".join(map(_plain, one)) for one in several.rivals]
        return own + (f" (or {'; '.join(others)})" if others else "")
    names = [name.partition("@") for name in done.found.names]
    return ", ".join(
        f"{name.replace('_', ' ')} ({site.partition(':')[2] or site})"
        for name, _, site in names
    )


def _plain(name: str) -> str:
    return name.replace("_", " ")


def show_chain(done: ExaminedChain, json_target: str | None) -> None:
    """Print verdict, hypotheses, causes and what moves.

    Args:
        done: the chain.
        json_target: where the JSON goes; ``-`` moves the words to standard error.
    """
    screen, found = console(json_target), done.found
    screen.print(f"verdict: {found.finding.value}", style="bold")
    for text in (f"{chain_headline(done)}.", found.reason):
        for line in textwrap.wrap(
            text,
            min(screen.width, _WIDEST),
            initial_indent="  ",
            subsequent_indent="  ",
        ):
            screen.print(line, markup=False)
    columns = ("free discrepancy at", *_NAMES.values(), "restored")
    screen.print(
        table(
            "chi2 / degrees of freedom of each link (! its limit is exceeded)",
            columns,
            hypothesis_rows(done),
            words={0, 4},
        )
    )
    if cause_rows(done):
        content = ("cause", "factor on the stiffness", "95 %")
        screen.print(table(factor_title(done), content, cause_rows(done), words={0}))
        screen.print(f"  {product_words(done)}", markup=False)
    heads = ("preload", "law alone", "predicted", "measured", "within 95 %")
    screen.print(
        table(
            "Stiffness of the joint, each preload predicted from the others",
            heads,
            stiffness_rows(done),
        )
    )
    screen.print(
        table(
            "Natural frequencies [Hz]",
            ("preload", "law alone", "predicted", "measured"),
            mode_rows(done),
        )
    )
    if done.response is not None:
        before, after = done.response.errors
        screen.print(
            f"  ring-down at {engineering(done.response.preload, 'N')}: residual over "
            f"response {before:.3g} before, {after:.3g} after",
            markup=False,
        )
    if found.experiment:
        for line in textwrap.wrap(
            f"next: {found.experiment}",
            min(screen.width, _WIDEST),
            subsequent_indent="      ",
        ):
            screen.print(line, markup=False)


def hypothesis_rows(done: ExaminedChain) -> list[tuple[str, ...]]:
    """Return one row for each place of a free discrepancy."""
    return [
        (one.words, *map(_test, one.tests), "yes" if one.restored else "no")
        for one in done.found.location.hypotheses
    ]


def _test(test: LinkTest) -> str:
    if not test.dof:
        return "not tested"
    return f"{test.cost / test.dof:.3g}" + ("" if test.passed else " !")


def factor_title(done: ExaminedChain) -> str:
    """Return the title of the table of causes."""
    several = done.found.several
    at = (
        ""
        if several is None
        else engineering(float(done.stiffness.preload[several.reference]), "N")
    )
    return f"Causes at the joint, at {at}"


def cause_rows(done: ExaminedChain) -> list[tuple[str, ...]]:
    """Return name, factor and interval of each cause at the joint."""
    several = done.found.several
    if several is None or ChainLink.CONTACT not in done.found.links:
        return []
    return [
        (
            one.name.replace("_", " "),
            f"{one.factor:.3g}",
            f"{one.low:.3g} to {one.high:.3g}",
        )
        for one in several.causes
    ]


def product_words(done: ExaminedChain) -> str:
    """Return product of the factors beside the ratio between joint and law."""
    several = done.found.several
    if several is None:
        return ""
    return (
        f"product {several.product:.3g}; measured over law {several.measured:.3g}; "
        f"not named {several.measured / several.product:.2f}"
    )


def stiffness_rows(done: ExaminedChain) -> list[tuple[str, ...]]:
    """Return one row for each state."""
    s = done.stiffness
    rows = []
    for k in range(len(s.preload)):
        off = abs(float(s.measured[k] / s.after[k]) - 1.0)
        inside = off <= 1.96 * float(s.after_sd[k])
        rows.append(
            (
                engineering(float(s.preload[k]), "N"),
                f"{s.before[k]:.3g}",
                f"{s.after[k]:.4g} ± {100 * s.after_sd[k]:.2g} %",
                f"{s.measured[k]:.4g}",
                "yes" if inside else "no",
            )
        )
    return rows


def mode_rows(done: ExaminedChain) -> list[tuple[str, ...]]:
    """Return one row for each state."""
    return [
        (
            engineering(one.preload, "N"),
            *(
                ", ".join(f"{f:.1f}" for f in values)
                for values in (one.before, one.after, one.measured)
            ),
        )
        for one in done.modes
    ]


def chain_json(done: ExaminedChain) -> Mapping[str, Any]:
    """Return the verdict and all numbers as plain data."""
    found, s = done.found, done.stiffness
    several = found.several
    return {
        "verdict": found.finding.value,
        "links": [link.value for link in found.links],
        "places": [[x.value for x in one.links] for one in found.location.places],
        "effects": list(found.names),
        "reason": found.reason,
        "experiment": found.experiment,
        "hypotheses": [
            {
                "links": [link.value for link in one.links],
                "restored": one.restored,
                "score": one.score,
                "tests": {
                    link.value: {
                        "chi2": test.cost,
                        "dof": test.dof,
                        "passed": test.passed,
                        "reason": test.reason,
                    }
                    for link, test in zip(ChainLink, one.tests, strict=True)
                },
            }
            for one in found.location.hypotheses
        ],
        "causes": None
        if several is None
        else {
            "factors": [
                {"name": c.name, "factor": c.factor, "interval_95": [c.low, c.high]}
                for c in several.causes
            ],
            "product": several.product,
            "measured_over_law": several.measured,
            "rivals": [list(one) for one in several.rivals],
            "preload": float(s.preload[several.reference]),
        },
        "stiffness": {
            "preload": s.preload.tolist(),
            "measured": s.measured.tolist(),
            "law": s.before.tolist(),
            "predicted": s.after.tolist(),
            "predicted_log_sd": s.after_sd.tolist(),
        },
        "modes": [
            {
                "preload": one.preload,
                "measured_hz": one.measured.tolist(),
                "law_hz": one.before.tolist(),
                "predicted_hz": one.after.tolist(),
            }
            for one in done.modes
        ],
        "joint": diagnosis_json(found.contact.found),
        "remarks": list(done.remarks),
    }
