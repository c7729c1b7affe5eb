# SPDX-License-Identifier: MIT
"""News of a recording, joined until they are asked for."""

from dataclasses import dataclass, field

from jointbench.acquisition.ni.stream_records import Waiting
from jointbench.acquisition.recorder.replies import Item
from jointbench.acquisition.session_file.live_read import LiveSpan


@dataclass(slots=True)
class NewsBox:
    """Items that were not reported yet.

    Its size does not grow with the time between two requests: samples that follow each
    other are one item, however many they are, and so is a time of waiting.
    """

    _items: list[Item] = field(default_factory=list)

    def __bool__(self) -> bool:
        """Return whether there are any."""
        return bool(self._items)

    def add(self, item: Item) -> None:
        """Add an item, joined to the last one where possible."""
        joined = _joined(self._items[-1], item) if self._items else None
        if joined is None:
            self._items.append(item)
        else:
            self._items[-1] = joined

    def take(self) -> tuple[Item, ...]:
        """Return all items, and forget them."""
        items, self._items = tuple(self._items), []
        return items


def _joined(last: Item, item: Item) -> Item | None:
    if isinstance(last, Waiting) and isinstance(item, Waiting):
        return Waiting(last.samples + item.samples)
    if isinstance(last, LiveSpan) and isinstance(item, LiveSpan):
        return last.joined(item)
    return None
