# SPDX-License-Identifier: MIT
"""Results as one table of quantities: what archives, trends and comparisons read.

One row a number: which part of the result, of what, which quantity, its value with its
standard deviation, or a word in place of a number.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Verdict
from jointbench.signal.amplitude.amplitude_curve import AmplitudeMode, Dependence
from jointbench.station.pipeline.process_session import PreloadModes, ProcessedSession
from jointbench.station.pipeline.surface_stages import SurfaceChain
from jointbench.station.results.result_rows import NAN, ResultQuantity
from jointbench.station.roughness.texture_words import parameter_names

# A 95 % interval of a normal quantity is this many standard deviations wide.
_WIDTH_95 = 3.919927969080108


def quantities_of(result: ProcessedSession) -> tuple[ResultQuantity, ...]:
    """Return all numbers of a result, in the order of the chain."""
    return (
        *_hits(result),
        *(
            q
            for modes in result.modal
            for q in _modes(modes, _preload(result, modes.preload))
        ),
        *(q for chain in result.surfaces for q in _surface(chain)),
        *_contact(result.contact or {}),
        *(
            q
            for preload, page in result.joints
            for q in _joint(page, _preload(result, preload))
        ),
        *_gap(result.gap or {}),
    )


def _preload(result: ProcessedSession, own: float | None) -> float:
    """Return the preload of a part, else of the session [N]; NaN where not given."""
    joint = result.session.joint
    stored = None if joint is None else joint.preload
    preload = own if own is not None else stored
    return NAN if preload is None else preload


def _hits(result: ProcessedSession) -> Iterator[ResultQuantity]:
    hits = [hit for own in result.hits for hit in own]
    if not hits:
        return
    good = sum(hit.verdict is Verdict.OK for hit in hits)
    for name, count in (
        ("found", len(hits)),
        ("accepted", good),
        ("verdicts_changed", len(result.changes)),
    ):
        yield ResultQuantity("hits", "", name, "1", float(count))


def _modes(modes: PreloadModes, preload: float) -> Iterator[ResultQuantity]:
    model = modes.chain.result.model
    for index in range(model.natural_frequency.size):
        for name, unit, values, sds in (
            ("natural_frequency", "Hz", model.natural_frequency, model.frequency_sd),
            ("damping_ratio", "1", model.damping_ratio, model.damping_ratio_sd),
        ):
            numbers = float(values[index]), float(sds[index])
            item = str(index + 1)
            yield ResultQuantity("modes", item, name, unit, *numbers, preload=preload)
    yield from amplitude_quantities(
        modes.chain.amplitude, model.natural_frequency, preload
    )


def amplitude_quantities(
    found: Sequence[AmplitudeMode], frequency: FloatArray, preload: float = NAN
) -> Iterator[ResultQuantity]:
    """Yield what amplitude does to each mode, where it does anything.

    Changes are those from soft to hard; the exponent is that of the best law, where it
    has one of its own.

    Args:
        found: modes over amplitude.
        frequency: natural frequencies of the modes of the result [Hz], whose numbers
            are the items.
        preload: [N].
    """
    for mode in found:
        if mode.dependence is not Dependence.DEPENDS:
            continue
        item = str(int(np.argmin(np.abs(frequency - mode.soft.frequency))) + 1)
        rows = [
            ("frequency_change", mode.frequency_change, mode.frequency_change_sd),
            ("damping_change", mode.damping_change, mode.damping_change_sd),
        ]
        if mode.laws and mode.laws[0].exponent_sd > 0:
            law = mode.laws[0]
            rows.append(("amplitude_exponent", law.exponent, law.exponent_sd))
        for name, value, sd in rows:
            yield ResultQuantity("modes", item, name, "1", value, sd, preload=preload)


def _surface(chain: SurfaceChain) -> Iterator[ResultQuantity]:
    fit, name = chain.fit, chain.surface.name
    yield ResultQuantity("surface", name, "verdict", "", word=fit.verdict.value)
    yield from _texture(chain)
    if fit.scaling is None:
        return
    dimension, sd = fit.scaling.dimension, fit.scaling.dimension_sd
    yield ResultQuantity("surface", name, "dimension", "1", dimension, sd)
    # G spans decades: its logarithm is what is normal, and what has a deviation.
    low, high = np.log(fit.scaling.roughness_interval)
    ln_sd = float(high - low) / _WIDTH_95
    value = float(np.log(fit.scaling.roughness))
    yield ResultQuantity("surface", name, "ln_roughness_in_m", "1", value, ln_sd)


def _texture(chain: SurfaceChain) -> Iterator[ResultQuantity]:
    """Yield the standard parameters of a surface that has some."""
    answer = chain.texture
    if answer is None or answer.measured is None:
        return
    measured, item = answer.measured, chain.surface.name
    for one in parameter_names(measured):
        found = measured.named(one.name)
        if found.value is not None:
            sd = found.uncertainty or NAN
            yield ResultQuantity("surface", item, one.name, one.unit, found.value, sd)


def _contact(page: Mapping[str, Any]) -> Iterator[ResultQuantity]:
    for model in page.get("models", ()):
        low, high = model["normal_stiffness_interval"]
        where = ("contact", model["name"])
        preload = float(model["preload"])
        value, sd = float(model["normal_stiffness"]), (high - low) / _WIDTH_95
        yield ResultQuantity(
            *where, "normal_stiffness", "N/m", value, sd, preload=preload
        )
        value = float(model["tangential_stiffness"])
        yield ResultQuantity(
            *where, "tangential_stiffness", "N/m", value, preload=preload
        )


def _joint(page: Mapping[str, Any], preload: float) -> Iterator[ResultQuantity]:
    verdict = str(page["verdict"])
    yield ResultQuantity("joint", "", "verdict", "", word=verdict, preload=preload)
    for name, one in page["parameters"].items():
        link, _, quantity = name.rpartition(".")
        sd = NAN if one["sd"] is None else float(one["sd"])
        numbers = float(one["value"]), sd
        yield ResultQuantity(
            "joint", link, quantity, one["unit"], *numbers, preload=preload
        )


def _gap(page: Mapping[str, Any]) -> Iterator[ResultQuantity]:
    if not page:
        return
    yield ResultQuantity("gap", "", "verdict", "", word=str(page["verdict"]))
    for name in ("gap_before", "gap_after"):
        yield ResultQuantity("gap", "", name, "1", float(page[name]))
    for effect in page["effects"]:
        item = f"{effect['name']} on {effect['site']}"
        for name, one in effect["parameters"].items():
            sd = NAN if one["sd"] is None else float(one["sd"])
            value = float(one["value"])
            yield ResultQuantity("gap", item, name, str(one["unit"]), value, sd)
