# SPDX-License-Identifier: MIT
"""Tables of standard parameters on the screen."""

from collections.abc import Sequence
from typing import Protocol

from rich.console import Console

from jointbench.acquisition.records.surfaces import Surface
from jointbench.signal.roughness.uncertain_parameters import MeasuredTexture
from jointbench.station.roughness.texture_request import TextureAnswer
from jointbench.station.roughness.texture_words import (
    COLUMNS,
    answer_lines,
    parameter_rows,
    pooled_rows,
    title_words,
)
from jointbench.station.screen.terminal import table


class WithTexture(Protocol):
    """A surface that may have standard parameters."""

    @property
    def surface(self) -> Surface:
        """Heights."""

    @property
    def texture(self) -> TextureAnswer | None:
        """Standard parameters; None where they are not asked for."""


def show_textures(
    screen: Console, chains: Sequence[WithTexture], *, pool: bool = False
) -> None:
    """Print a table of parameters for each surface, and of all as one if asked."""
    for chain in chains:
        answer = chain.texture
        if answer is None:
            continue
        if answer.measured is not None:
            rows = parameter_rows(answer.measured)
            screen.print(table(title_words(answer.measured), COLUMNS, rows))
        for line in answer_lines(answer):
            screen.print(f"  {chain.surface.name}: {line}", markup=False)
    several = measured_of(chains)
    if pool and len(several) > 1:
        title = f"mean of {len(several)} profiles"
        screen.print(table(title, COLUMNS, pooled_rows(several)))


def measured_of(chains: Sequence[WithTexture]) -> list[MeasuredTexture]:
    """Return the textures of the surfaces that have one."""
    answers = [one.texture for one in chains if one.texture is not None]
    return [one.measured for one in answers if one.measured is not None]
