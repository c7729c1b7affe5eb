# SPDX-License-Identifier: MIT
"""Channels of a file that come again: each time they do is a further hit.

Foreign files list the histories of several hits one after the other, either hit by hit
(force, response, force, response) or channel by channel (force, force, response,
response), and the hammer may strike another point each time.
"""

from collections import Counter
from collections.abc import Sequence

from jointbench.acquisition.formats.stated_channels import StatedChannel
from jointbench.acquisition.records.recordings import Quantity

_TWICE = 2
Key = tuple[str, str, str, str]


def hits_of_channels(
    channels: Sequence[StatedChannel], keys: Sequence[str]
) -> list[list[int]]:
    """Return the channels of each hit.

    Args:
        channels: of a file, in its order.
        keys: what the file calls each; empty where it has no name.

    Returns:
        Indices of the channels, one list for each hit; a single one where no channel
        comes again, or not all of them equally often.
    """
    force = [one.quantity is Quantity.FORCE for one in channels]
    whole = list(range(len(channels)))
    named = [
        (one.point, one.direction, str(one.quantity or one.unit), key)
        for one, key in zip(channels, keys, strict=True)
    ]
    responses = Counter(k for k, f in zip(named, force, strict=True) if not f)
    counts = set(responses.values())
    hits = sum(force)
    if len(counts) == 1 and (count := counts.pop()) >= _TWICE:
        # Without a force only names distinguish sensors from hits.
        if hits == 0 and all(key[0] or key[3] for key in responses):
            return _by_occurrence(named, count)
        if hits == count:
            return _with_forces(named, force, count)
        if {c for k, c in Counter(named).items()} == {count}:
            return _by_occurrence(named, count)
    if hits >= _TWICE and len(channels) % hits == 0:
        width = len(channels) // hits
        blocks = [whole[i : i + width] for i in range(0, len(whole), width)]
        alike = {tuple(sorted(named[i] for i in b if not force[i])) for b in blocks}
        if len(alike) == 1 and all(sum(force[i] for i in b) == 1 for b in blocks):
            return blocks if width > 1 else [whole]
    return [whole]


def _by_occurrence(named: Sequence[Key], count: int) -> list[list[int]]:
    """Put the k-th channel of every name into hit k."""
    seen: Counter[Key] = Counter()
    hits: list[list[int]] = [[] for _ in range(count)]
    for index, key in enumerate(named):
        hits[seen[key]].append(index)
        seen[key] += 1
    return hits


def _with_forces(
    named: Sequence[Key], force: Sequence[bool], count: int
) -> list[list[int]]:
    """Put the k-th force into hit k, wherever the hammer struck."""
    alike = [
        ("", "", "force", "") if is_force else key
        for key, is_force in zip(named, force, strict=True)
    ]
    return _by_occurrence(alike, count)
