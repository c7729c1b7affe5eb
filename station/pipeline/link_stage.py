# SPDX-License-Identifier: MIT
"""Links of a lumped bench from its modes: the bench model meets the modal model."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.lumped.identified import (
    Identification,
    IdentificationVerdict,
)
from jointbench.analysis.lumped.identify_links import identify_links
from jointbench.analysis.lumped.lumped_model import LumpedModel
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.station.schemas.bench_model import BenchModel, lumped_model

SENSITIVITY_SD = 0.02
"""Relative sd of a shape component [-]: accelerometers of one batch differ by 2 %."""


def fits(result: Identification) -> bool:
    """Return whether the model can reproduce the measured modes at all."""
    return result.verdict is not IdentificationVerdict.INCONSISTENT


def identify_joint(bench: BenchModel, modes: ModalModel) -> Identification:
    """Identify every link of a bench whose channels sit on its bodies.

    Raises:
        BadData: a body's channel is not among the outputs, or there are more modes
            than bodies.
    """
    return identify_links(mode_model(bench), measured_modes(bench, modes))


def mode_model(bench: BenchModel) -> LumpedModel:
    """Return the lumped model of a bench without the priors of its dampings.

    Only the measured damping ratios determine the damping: a stated damping is a
    start of the search. Only `gap` weighs it by its standard deviation.
    """
    model = lumped_model(bench)
    links = tuple(replace(link, damping_spread=None) for link in model.links)
    return replace(model, links=links)


def measured_modes(bench: BenchModel, modes: ModalModel) -> MeasuredModes:
    """Return measured modes, with the shape at each body that has a channel.

    Raises:
        BadData: there are more modes than bodies: above, bodies bend.
    """
    count, most = modes.natural_frequency.size, len(bench.bodies)
    if count > most:
        found = ", ".join(f"{f:.1f}" for f in modes.natural_frequency)
        raise BadData(
            f"{count} modes ({found} Hz) for {most} rigid bodies; add bodies to the "
            "model, or give a --band that holds the rigid-body modes only"
        )
    seen = {
        name: b.channel for name, b in bench.bodies.items() if b.channel is not None
    }
    shapes = modes.shapes[:, [_output(modes, c) for c in seen.values()]]
    return MeasuredModes(
        natural_frequency=modes.natural_frequency,
        frequency_sd=modes.frequency_sd,
        damping_ratio=modes.damping_ratio,
        damping_ratio_sd=modes.damping_ratio_sd,
        shapes=shapes if len(seen) > 1 else None,
        shape_sd=_shape_sd(shapes) if len(seen) > 1 else None,
        outputs=tuple(seen),
    )


def _shape_sd(
    shapes: ComplexArray,
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    largest = np.abs(shapes).max(axis=1, keepdims=True)
    return np.asarray(SENSITIVITY_SD * np.broadcast_to(largest, shapes.shape))


def _output(modes: ModalModel, channel: str) -> int:
    names = [label.partition("@")[0] for label in modes.outputs]
    if channel not in names:
        raise BadData(
            f"the model's channel {channel!r} is not measured; the channels are "
            f"{', '.join(names)}"
        )
    return names.index(channel)
