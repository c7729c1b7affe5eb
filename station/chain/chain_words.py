# SPDX-License-Identifier: MIT
"""What ``jointbench gap --surface`` shows on a terminal, and its JSON."""

import textwrap

from jointbench.analysis.gap.chain.chain_records import ChainLink
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.station.chain.chain_tables import (
    cause_rows,
    factor_title,
    hypothesis_rows,
    mode_rows,
    product_words,
    stiffness_rows,
)
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
    if family := found.chain.structure.family:
        return f"{where}: {family.replace(':', ' ')} explains most of it"
    return f"{where}: {names}" if names else f"{where}; no effect explains it"


def cause_words(done: ExaminedChain) -> str:
    """Return what was named in words; sets that fit equally well joined by "or"."""
    several = done.found.several
    if done.found.links == (ChainLink.CONTACT,) and several is not None:
        own = " with ".join(_plain(cause.name) for cause in several.causes)
        count = len(several.rivals)
        if not count:
            return own
        others = (
            f"{count} other sets that fit" if count > 1 else "another set that fits"
        )
        return f"{own}, or {others} equally well"
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
