# SPDX-License-Identifier: MIT
"""Effects of the catalogue at the ports of a modal base, each with its own scales.

Linear effects are left out: a base that is itself identified from records absorbs them.
"""

from dataclasses import replace

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.modal_bench.level_records import RecordSet
from jointbench.analysis.gap.modal_bench.modal_base import UnitModes, port_shapes
from jointbench.analysis.gap.modal_bench.port_response import Shaken, modal_receptance
from jointbench.analysis.gap.model.effect import Candidate, Effect, Site
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect

_COMMON = ("one", "sample", "peak", "noise")
"""Scale words without a port."""


def port_candidates(
    entries: tuple[LumpedEffect, ...], given: RecordSet
) -> tuple[Candidate, ...]:
    """Return every law of joints at every port.

    Args:
        entries: a catalogue.
        given: records with their ports.
    """
    return tuple(
        Candidate(_scaled(entry.effect, port.name), Site("link", port.name))
        for entry in entries
        if entry.law is not None and "link" in entry.sites
        for port in given.ports
    )


def _scaled(effect: Effect, port: str) -> Effect:
    """Return an effect whose scale words refer to a port."""
    parameters = tuple(
        replace(p, scale=_word_at(p.scale, port)) for p in effect.parameters
    )
    return replace(effect, parameters=parameters)


def _word_at(word: str, port: str) -> str:
    """Return ``stiffness@bolt/travel@bolt^2`` of ``stiffness/travel^2``."""
    parts = []
    for part in word.split("/"):
        base, caret, power = part.partition("^")
        fixed = base in _COMMON or base == "1"
        parts.append(base + ("" if fixed else f"@{port}") + caret + power)
    return "/".join(parts)


def port_scales(given: RecordSet, modes: UnitModes, data: Shaken) -> dict[str, float]:
    """Return characteristic sizes at each port, which scale starts and bounds.

    The stiffness of a port is the inverse of its static compliance in these modes,
    which is the stiffness that a law at the port competes with.

    Args:
        given: records with their ports.
        modes: of the base.
        data: the transformed records.
    """
    scales = {
        "one": 1.0,
        "sample": 1.0 / given.sample_rate,
        "peak": float(np.abs(data.measured).max()),
    }
    push = modes.shapes[:, [given.points.index(p) for p in given.inputs]]
    modal = np.einsum("mi,ril->rml", push, data.spectrum)
    modal = modal * modal_receptance(modes, data.excitation.s)
    for port in given.ports:
        across = port_shapes(modes, given.points, port)
        motion = np.einsum("m,rml->rl", across, modal)
        own = _port_scales(modes, across, data, motion)
        scales |= {f"{word}@{port.name}": value for word, value in own.items()}
    return scales


def _port_scales(
    modes: UnitModes, across: FloatArray, data: Shaken, motion: ComplexArray
) -> dict[str, float]:
    share = across**2 / modes.omega**2
    stiffness = 1.0 / max(float(share.sum()), 1e-300)
    main = int(np.argmax(share))
    omega, frequency = float(modes.omega[main]), float(modes.frequency[main])
    travel = _largest(data, motion)
    return {
        "mass": stiffness / omega**2,
        "stiffness": stiffness,
        "damping": 2.0 * float(modes.damping[main]) * stiffness / omega,
        "travel": travel,
        "force": stiffness * travel,
        "speed": _largest(data, motion * data.excitation.s),
        "frequency": frequency,
        "period": 1.0 / frequency,
    }


def _largest(data: Shaken, spectra: ComplexArray) -> float:
    """Return the largest magnitude in time of damped spectra."""
    excitation = data.excitation
    rows = scipy.fft.irfft(spectra, excitation.padded, axis=-1)
    rows = rows[..., : excitation.growth.size] * excitation.growth
    return max(float(np.abs(rows).max()), 1e-300)
