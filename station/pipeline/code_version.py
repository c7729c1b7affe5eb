# SPDX-License-Identifier: MIT
"""The version of a stage's code: a digest of the sources that it runs.

A stage is named with the modules that do its work. Their sources count, and the sources
of all modules of this package that they import, directly or not; of the modules that
call the stages, their own sources alone. The libraries that compute count by their
versions. Comments count, too: a change that changes no number
costs time, and never a number that is out of date.
"""

import re
from collections.abc import Iterable, Iterator
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

_PACKAGE = "jointbench"
_LIBRARIES = ("filterpy", "numba", "numpy", "scipy")
CALLERS = (
    "acquisition.basics.steady_memory",
    "station.pipeline.chain",
    "station.pipeline.joint_stages",
    "station.pipeline.process_session",
    "station.pipeline.record_codec",
    "station.pipeline.stage_store",
)
"""Part of every stage: what calls it, stores its record and returns its memory, without
their imports."""
STAGE_MODULES = {
    "hits": ("station.pipeline.judge_again",),
    "kalman": ("signal.kalman.smoothing", "signal.hits.windows"),
    "frf": ("signal.frf.measured_frf", "signal.hits.windows"),
    "modes": ("signal.modal.modes",),
    "fill": (
        "signal.frf.measured_frf",
        "signal.kalman.smoothing",
        "signal.modal.modes",
        "signal.kalman.oscillator_bank",
        "signal.hits.windows",
    ),
    "amplitude": (
        "signal.amplitude.amplitude_modes",
        "signal.amplitude.resolved_model",
    ),
    "structure": ("signal.surface.structure_function",),
    "surface": ("signal.fractal.fractal_fit",),
    "contact": (
        "station.pipeline.contact_prediction",
        "station.pipeline.joint_comparison",
    ),
    "measured_contact": (
        "station.contact.measured_words",
        "station.pipeline.joint_comparison",
    ),
    "joint": ("station.pipeline.link_stage",),
    "gap": (
        "analysis.gap.catalogue.catalogue",
        "analysis.gap.diagnosis.diagnose",
        "analysis.gap.model.diagnosis_record",
        "analysis.gap.intake.session_campaign",
        "station.schemas.gap_model",
    ),
    "result": ("station.pipeline.process_session", "station.results.processed_file"),
}
"""Modules that do the work of each stage; `result` is the whole results file."""
_FROM = re.compile(
    rf"^\s*from\s+({_PACKAGE}(?:\.\w+)*)\s+import\s+(\([^)]*\)|[^\n]*)", re.MULTILINE
)
_IMPORT = re.compile(rf"^\s*import\s+({_PACKAGE}(?:\.\w+)*)", re.MULTILINE)


@cache
def stage_version(stage: str) -> str:
    """Return the version of the code of a stage: SHA-256, as hexadecimal text.

    Args:
        stage: name of the stage; one that is not in `STAGE_MODULES` has the code of
            the result as a whole.
    """
    return code_version(stage_sources(stage))


def stage_sources(stage: str) -> frozenset[str]:
    """Return the full names of the modules that the version of a stage is made of."""
    modules = STAGE_MODULES.get(stage, STAGE_MODULES["result"])
    callers = {f"{_PACKAGE}.{name}" for name in CALLERS}
    return sources_of(*(f"{_PACKAGE}.{name}" for name in modules)) | callers


def code_version(modules: Iterable[str]) -> str:
    """Return the SHA-256 of the sources of modules and the versions of libraries.

    Args:
        modules: their full names.
    """
    digest = sha256()
    for name in _LIBRARIES:
        digest.update(f"{name} {_library(name)}\n".encode())
    for name in sorted(modules):
        digest.update(f"{name} {source_digest(name)}\n".encode())
    return digest.hexdigest()


def sources_of(*modules: str) -> frozenset[str]:
    """Return the names of modules and of all station modules that they import."""
    found: set[str] = set()
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        if name not in found and source_of(name) is not None:
            found.add(name)
            waiting += imports_of(name)
    return frozenset(found)


@cache
def imports_of(name: str) -> tuple[str, ...]:
    """Return the station modules that a station module imports, at any depth."""
    return tuple(dict.fromkeys(_imported((source_of(name) or b"").decode())))


def _imported(text: str) -> Iterator[str]:
    yield from _IMPORT.findall(text)
    for base, names in _FROM.findall(text):
        if source_of(base) is not None:
            yield base
            continue
        for word in re.findall(r"(\w+)(?:\s+as\s+\w+)?", re.sub(r"#.*", "", names)):
            yield f"{base}.{word}"


@cache
def source_of(name: str) -> bytes | None:
    """Return the source of a module; None for a folder of modules, and for none."""
    try:
        spec = find_spec(name)
    except ModuleNotFoundError:
        return None
    if spec is None or spec.origin is None or not Path(spec.origin).is_file():
        return None
    return Path(spec.origin).read_bytes()


@cache
def source_digest(name: str) -> str:
    """Return the SHA-256 of the source of a module, as hexadecimal text."""
    return sha256(source_of(name) or b"").hexdigest()


def _library(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:  # vendored or frozen: versioned with the station
        return "-"
