# SPDX-License-Identifier: MIT
"""Tables of standard parameters on the screen."""

from collections.abc import Sequence
from typing import Protocol

from rich.console import Console

from jointbench.acquisition.records.surfaces import Surface
from jointbench.station.roughness.texture_request import TextureAnswer
from jointbench.station.roughness.texture_words import (
    COLUMNS,
    answer_lines,
    parameter_rows,
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


def show_textures(screen: Console, chains: Sequence[WithTexture]) -> None:
    """Print a table of parameters for each surface that has them."""
    for chain in chains:
        answer = chain.texture
        if answer is None:
            continue
        if answer.measured is not None:
            rows = parameter_rows(answer.measured)
            screen.print(table(title_words(answer.measured), COLUMNS, rows))
        for line in answer_lines(answer):
            screen.print(f"  {chain.surface.name}: {line}", markup=False)
