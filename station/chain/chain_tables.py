# SPDX-License-Identifier: MIT
"""Rows of the tables of a chain, for terminal and report."""

from jointbench.analysis.gap.chain.chain_records import ChainLink, LinkTest
from jointbench.station.chain.examine_chain import ExaminedChain
from jointbench.station.screen.value_text import engineering


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
        for one in (*several.causes, *several.known)
    ]


def product_words(done: ExaminedChain) -> str:
    """Return product of the factors beside the ratio between joint and law."""
    several = done.found.several
    if several is None:
        return ""
    product = several.product
    return (
        f"product {product.factor:.3g} ({product.low:.3g} to {product.high:.3g}); "
        f"measured over law {several.measured:.3g}; "
        f"not named {several.measured / product.factor:.2f}"
    )


def stiffness_rows(done: ExaminedChain) -> list[tuple[str, ...]]:
    """Return one row for each state."""
    s = done.stiffness
    rows: list[tuple[str, ...]] = []
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
