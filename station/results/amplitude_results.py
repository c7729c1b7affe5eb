# SPDX-License-Identifier: MIT
"""Modes over amplitude in a results file: a group for each mode, with its curve."""

from collections.abc import Sequence
from dataclasses import fields

import h5py
import numpy as np

from jointbench.acquisition.file_access.netcdf_encodings import write_texts
from jointbench.acquisition.file_access.netcdf_read import (
    read_array,
    read_attribute,
    read_texts,
)
from jointbench.acquisition.file_access.netcdf_write import (
    write_attributes,
    write_variable,
)
from jointbench.signal.amplitude.amplitude_curve import (
    CURVE_ARRAYS,
    AmplitudeCurve,
    AmplitudeMode,
    Dependence,
    LawFit,
    SoftLimit,
)

_NUMBERS = (
    "significance",
    "residual_ratio",
    "linear_residual_ratio",
    "frequency_change",
    "frequency_change_sd",
    "damping_change",
    "damping_change_sd",
    "ratio",
)
_LAW_NUMBERS = ("exponent", "exponent_sd", "chi2", "criterion")
_SOFT = tuple(one.name for one in fields(SoftLimit))


def write_amplitude(group: h5py.Group, found: Sequence[AmplitudeMode]) -> None:
    """Write modes over amplitude into a group, one group each."""
    for number, mode in enumerate(found):
        _write_mode(group.create_group(str(number)), mode)


def _write_mode(group: h5py.Group, mode: AmplitudeMode) -> None:
    write_attributes(
        group,
        {
            "dependence": mode.dependence.value,
            "reason": mode.reason,
            "family": mode.family,
            **{name: float(getattr(mode, name)) for name in _NUMBERS},
            **{f"soft_{name}": float(getattr(mode.soft, name)) for name in _SOFT},
        },
    )
    if mode.replaces:
        words = "linear poles that the mode stands for"
        write_variable(
            group, "pole", mode.replaces, ("pole",), units="Hz", long_name=words
        )
    if mode.laws:
        names = [law.name for law in mode.laws]
        write_texts(group, "law", names, "law_number", long_name="law of the joint")
        for name in _LAW_NUMBERS:
            values = [getattr(law, name) for law in mode.laws]
            write_variable(group, f"law_{name}", values, ("law_number",), units="1")
    if mode.curve is not None:
        _write_curve(group, mode.curve)


def _write_curve(group: h5py.Group, curve: AmplitudeCurve) -> None:
    words = f"amplitude of the response at {curve.channel}"
    write_variable(
        group,
        "amplitude",
        curve.amplitude,
        ("amplitude",),
        units=curve.unit,
        long_name=words,
    )
    for name in CURVE_ARRAYS:
        units = "Hz" if name.startswith("frequency") else "1"
        words = name.replace("_", " ")
        write_variable(
            group,
            name,
            getattr(curve, name),
            ("amplitude",),
            units=units,
            long_name=words,
        )
    write_attributes(group, {"channel": curve.channel, "unit": curve.unit})


def read_amplitude(group: h5py.Group) -> tuple[AmplitudeMode, ...]:
    """Return the modes over amplitude of a group, as they were written."""
    return tuple(_mode(group[name]) for name in sorted(group, key=int))


def _mode(group: h5py.Group) -> AmplitudeMode:
    return AmplitudeMode(
        dependence=Dependence(_text(group, "dependence")),
        reason=_text(group, "reason"),
        curve=_curve(group) if "amplitude" in group else None,
        soft=SoftLimit(*(_number(group, f"soft_{name}") for name in _SOFT)),
        family=_text(group, "family"),
        laws=_laws(group) if "law" in group else (),
        replaces=tuple(read_array(group["pole"])) if "pole" in group else (),
        **{name: _number(group, name) for name in _NUMBERS},
    )


def _curve(group: h5py.Group) -> AmplitudeCurve:
    return AmplitudeCurve(
        amplitude=read_array(group["amplitude"]),
        channel=_text(group, "channel"),
        unit=_text(group, "unit"),
        **{name: read_array(group[name]) for name in CURVE_ARRAYS},
    )


def _laws(group: h5py.Group) -> tuple[LawFit, ...]:
    columns = [read_array(group[f"law_{name}"]) for name in _LAW_NUMBERS]
    return tuple(
        LawFit(name, *(float(value) for value in row))
        for name, row in zip(read_texts(group["law"]), np.array(columns).T, strict=True)
    )


def _text(group: h5py.Group, name: str) -> str:
    return str(read_attribute(group, name) or "")


def _number(group: h5py.Group, name: str) -> float:
    value = read_attribute(group, name)
    return float(value) if isinstance(value, int | float) else float("nan")
