# SPDX-License-Identifier: MIT
"""Lists of names of virtual channels, as NI's client writes them."""

from collections.abc import Sequence

from jointbench.simulators.chassis.tasks.virtual_channels import VirtualChannel


def listed_names(text: str, channels: Sequence[VirtualChannel]) -> list[str]:
    """Return the names in a list; ``ai0:2`` stands for three, unless it is a name."""
    known = {channel.name.lower() for channel in channels}
    found: list[str] = []
    for word in (part.strip() for part in text.split(",")):
        stem, colon, last = word.rpartition(":")
        digits = len(stem) - len(stem.rstrip("0123456789"))
        if word.lower() in known or not (colon and last.isdigit() and digits):
            found.append(word)
            continue
        base, first = stem[:-digits], int(stem[-digits:])
        step = 1 if int(last) >= first else -1
        # No list is longer than the channels there are.
        span = range(first, int(last) + step, step)[: len(channels) + 1]
        found += [f"{base}{n}" for n in span]
    return found
