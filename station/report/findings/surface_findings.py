# SPDX-License-Identifier: MIT
"""What was found of surfaces, in words and numbers for the head of a report."""

from collections.abc import Sequence

from jointbench.station.pipeline.roughness_words import roughness_words
from jointbench.station.pipeline.surface_stages import SurfaceChain
from jointbench.station.report.findings.interval_words import value_and_interval
from jointbench.station.screen.page_parts import Tile


def surface_sentence(chain: SurfaceChain) -> str:
    """Return the verdict on a surface and what it rests on, in one sentence."""
    name, fit = chain.surface.name, chain.fit
    if fit.scaling is None:
        return f"{name}: {fit.verdict.value}; {fit.reason}."
    value, interval = value_and_interval(
        fit.scaling.dimension, fit.scaling.dimension_sd, "", prefix=False
    )
    return f"{name}: {fit.verdict.value}, with D = {value} ({interval})."


def surface_tiles(chains: Sequence[SurfaceChain]) -> tuple[Tile, ...]:
    """Return D of each surface, then G of each, with their intervals."""
    first, second = [], []
    for chain in chains:
        name, scaling = chain.surface.name, chain.fit.scaling
        if scaling is None:
            first.append(Tile(f"D of {name}", "-", chain.fit.verdict.value))
            continue
        value, interval = value_and_interval(
            scaling.dimension, scaling.dimension_sd, "", prefix=False
        )
        note = f"{interval}; {chain.fit.verdict.value}"
        first.append(Tile(f"D of {name}", value, note))
        words = roughness_words(scaling)
        at = words.find("(")
        level = f"G of {name}" if scaling.roughness_known else f"S of {name}"
        second.append(Tile(level, words[:at].strip(), words[at:].strip("()")))
    return (*first, *second)
