# SPDX-License-Identifier: MIT
"""One FRF record of the functions that files of other programs hold.

Functions become a matrix of outputs and inputs. The noise of their lines is the
variance where a file states it; else it follows from coherence and the number of
averages; else it is estimated from the lines themselves (`line_noise`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import (
    BadData,
    ChannelMissing,
    SamplingError,
    UnitError,
)
from jointbench.acquisition.records.frf_functions import FrfFunction
from jointbench.acquisition.records.provenance import Provenance, step
from jointbench.signal.frf.frf import KIND_OF_RESPONSE, Frf

READ_STEP = "frf_of_files"
"""Name of the step of provenance of FRFs that no hit was averaged for."""
_SCATTER_LINES = 9
"""Lines over which the scatter of a few averages is smoothed, as in `estimate_pair`."""
_LEAST_COHERENCE = 1e-6
_FEWEST_AVERAGES = 2
_ALIKE = 1e-9
Pairs = dict[tuple[str, str], FrfFunction]


@dataclass(frozen=True, slots=True)
class NoiseSource:
    """What the variance of an FRF comes from.

    Attributes:
        word: for the provenance.
        sentence: for a person; empty where a file states the variance.
    """

    word: str
    sentence: str


STATED = NoiseSource("as stated", "")
FROM_COHERENCE = NoiseSource(
    "coherence and averages",
    "the variance of each line comes from coherence and the number of averages",
)
FROM_LINES = NoiseSource(
    "neighbouring lines",
    "the files state no variance: noise is estimated from the differences of "
    "neighbouring lines of the residual",
)


def frf_of_functions(functions: Sequence[FrfFunction]) -> Frf:
    """Return functions as one FRF.

    Args:
        functions: at least one; those without labels are numbered.

    Returns:
        The FRF, outputs and inputs in the order met.

    Raises:
        SamplingError: the functions are on different lines.
        UnitError: they measure different quantities.
        ChannelMissing: a pair of output and input is missing.
        BadData: a pair is there twice, or windows differ.

    Source:
        Bendat and Piersol, Random Data (2010), sec. 9.2 (variance from coherence).
    """
    pairs = _pairs(functions)
    first = functions[0]
    _require_alike(functions)
    outputs = tuple(dict.fromkeys(output for output, _ in pairs))
    inputs = tuple(dict.fromkeys(point for _, point in pairs))
    missing = [(o, i) for o in outputs for i in inputs if (o, i) not in pairs]
    if missing:
        output, point = missing[0]
        raise ChannelMissing(
            f"{len(pairs)} FRFs of {len(outputs)} outputs and {len(inputs)} inputs: "
            f"output {output!r} from input {point!r} is missing ({len(missing)} in "
            "all); a matrix needs every pair: give the files of one input, or add it"
        )
    ordered = [pairs[output, point] for output in outputs for point in inputs]
    shape = (len(outputs), len(inputs), first.frequency.size)
    averages = min(one.averages for one in ordered)
    variance, source = _variance(ordered, averages)
    return Frf(
        frequency=first.frequency,
        response=np.array([one.response for one in ordered]).reshape(shape),
        kind=KIND_OF_RESPONSE[first.quantity],
        coherence=_stack(ordered, "coherence", shape),
        variance=None if variance is None else variance.reshape(shape),
        added_decay_rate=first.added_decay_rate,
        outputs=outputs,
        inputs=inputs,
        averages=averages,
        provenance=_provenance(ordered, averages, source),
        usable_band=first.usable_band,
        innovation_noise=_stack(ordered, "innovation_noise", shape),
        force_noise=_stack(ordered, "force_noise", shape),
        force_width=min(one.force_width for one in ordered),
    )


def noise_source(provenance: Provenance) -> NoiseSource | None:
    """Return what the noise of an FRF from files comes from; None for hits."""
    for done in provenance:
        if done.name == READ_STEP:
            word = dict(done.detail)["noise"]
            known = (STATED, FROM_COHERENCE, FROM_LINES)
            return next(one for one in known if one.word == word)
    return None


def _pairs(functions: Sequence[FrfFunction]) -> Pairs:
    """Return the functions by output and input; those without labels are numbered."""
    pairs: Pairs = {}
    several = len(functions) > 1 and len({(f.output, f.input) for f in functions}) == 1
    for number, one in enumerate(functions, 1):
        output = str(number) if several and not one.output else one.output or "1"
        pair = output, one.input or "1"
        if pair in pairs:
            raise BadData(
                f"output {pair[0]!r} from input {pair[1]!r} is there twice; give one "
                "FRF of each pair, or name the degrees of freedom in --columns"
            )
        pairs[pair] = one
    return pairs


def _require_alike(functions: Sequence[FrfFunction]) -> None:
    """Raise where functions are on other lines, in other units, or windowed apart."""
    first = functions[0]
    for one in functions[1:]:
        pair = f"output {one.output!r} from input {one.input!r}"
        if one.quantity is not first.quantity:
            raise UnitError(
                f"{pair} is an FRF of {one.quantity.value}, the first of "
                f"{first.quantity.value}; give FRFs of one quantity"
            )
        scale = float(first.frequency[-1])
        if one.frequency.shape != first.frequency.shape or not np.allclose(
            one.frequency, first.frequency, rtol=0.0, atol=_ALIKE * scale
        ):
            raise SamplingError(
                f"{pair} has {one.frequency.size} lines from {one.frequency[0]:g} to "
                f"{one.frequency[-1]:g} Hz, the first {first.frequency.size} from "
                f"{first.frequency[0]:g} to {first.frequency[-1]:g} Hz; export all on "
                "the same lines"
            )
        if one.added_decay_rate != first.added_decay_rate:
            raise BadData(
                f"{pair} has an exponential window of {one.added_decay_rate:g} 1/s, "
                f"the first of {first.added_decay_rate:g} 1/s; give FRFs of one window"
            )


def _stack(
    ordered: Sequence[FrfFunction], name: str, shape: tuple[int, int, int]
) -> FloatArray | None:
    """Return an array of noise of all functions, None where one lacks it."""
    rows = [getattr(one, name) for one in ordered]
    if any(row is None for row in rows):
        return None
    return np.array(rows).reshape(shape)


def _variance(
    ordered: Sequence[FrfFunction], averages: int
) -> tuple[FloatArray | None, NoiseSource]:
    """Return the variance of all functions, one row each, and its source."""
    stated = [one.variance for one in ordered if one.variance is not None]
    if len(stated) == len(ordered):
        return np.array(stated), STATED
    known = [one.coherence for one in ordered if one.coherence is not None]
    if len(known) < len(ordered) or averages < _FEWEST_AVERAGES:
        return None, FROM_LINES
    rows = []
    for one, coherence in zip(ordered, known, strict=True):
        share = np.clip(coherence, _LEAST_COHERENCE, 1.0)
        power = np.abs(one.response) ** 2 * (1.0 - share) / share
        rows.append(uniform_filter1d(power, _SCATTER_LINES, mode="nearest"))
    return np.array(rows) / (averages - 1), FROM_COHERENCE


def _provenance(
    ordered: Sequence[FrfFunction], averages: int, source: NoiseSource
) -> Provenance:
    """Return the files of the functions, each once, and where the noise comes from."""
    done = tuple(dict.fromkeys(s for one in ordered for s in one.provenance))
    return (
        *done,
        step(READ_STEP, functions=len(ordered), averages=averages, noise=source.word),
    )
