# SPDX-License-Identifier: MIT
"""Record everything a source delivers; hits are judged later, none is thrown away."""

from collections.abc import Callable

import numpy as np

from jointbench.acquisition.errors import InstrumentError
from jointbench.acquisition.records import Recording, step
from jointbench.acquisition.source import Source


def record(
    source: Source,
    *,
    name: str = "stream",
    on_block: Callable[[float], object] | None = None,
) -> Recording:
    """Record a source until it ends.

    Args:
        source: an opened source.
        name: of the recording.
        on_block: called after every block with the time recorded so far [s].

    Returns:
        One recording of the whole stream, hits not yet searched.

    Raises:
        InstrumentError: the source delivered nothing.
    """
    blocks = []
    count = 0
    for block in source.blocks():
        blocks.append(block)
        count += block.shape[1]
        if on_block is not None:
            on_block(count / source.sample_rate)
    if not blocks:
        raise InstrumentError(f"source {source.name!r} delivered no sample; check it")
    return Recording(
        name=name,
        samples=np.concatenate(blocks, axis=1),
        sample_rate=source.sample_rate,
        channels=source.channels,
        provenance=(step("record", source=source.name, samples=count),),
    )
