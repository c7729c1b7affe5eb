# SPDX-License-Identifier: MIT
"""Many figures of one kind: small, beside each other, the rest folded."""

from collections.abc import Sequence

from jointbench.station.screen.page_parts import Item, ItemGroup, Plot

MOST_SHOWN = 6
"""Small figures that are shown; the others open on a click, and when printed."""


def small_multiples(
    title: str, plots: Sequence[Plot], noun: str, *, shown: int = MOST_SHOWN
) -> list[Item]:
    """Return figures as a grid with one legend, and further ones folded.

    Args:
        title: what all of them show.
        plots: the figures, the most informative first; their captions are short.
        noun: of what there are more, in the plural, for example "FRFs".
        shown: how many are not folded.
    """
    if not plots:
        return []
    items: list[Item] = [ItemGroup(title, tuple(plots[:shown]), "grid")]
    if rest := tuple(plots[shown:]):
        more = f"{len(rest)} further {noun}"
        items.append(ItemGroup(more, (ItemGroup("", rest, "grid"),)))
    return items
