# SPDX-License-Identifier: MIT
"""The values of joints from the JSON of ``identify`` and from the model file."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, FormatError, UsageError
from jointbench.analysis.lumped.identified import JointParameter
from jointbench.analysis.structures.identification.sensor_masses import is_mass
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import is_modulus
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.station.joints.structure_tables import IdentifyTable

_MOST_BYTES = 50_000_000


@dataclass(frozen=True, slots=True, eq=False)
class StateValues:
    """All values of one state.

    Attributes:
        label: of the state; empty where the parameters name none.
        joints: totals of every joint and direction.
        moduli: factors by the name of the body.
        masses: factors by the name of the sensor.
        parameters: of the joints of this state, as identified or known.
        covariance: of ln stiffness, then ln damping of every joint and direction, shape
            (2 n_parameters, 2 n_parameters); zero where it is not known.
    """

    label: str
    joints: JointValues
    moduli: Mapping[str, float]
    masses: Mapping[str, float]
    parameters: tuple[JointParameter, ...]
    covariance: FloatArray

    def of_joint(self, name: str) -> tuple[JointParameter, ...]:
        """Return the parameters of one joint."""
        return tuple(
            one
            for one in self.parameters
            if one.name.rpartition(":")[2].partition(".")[0] == name
        )


@dataclass(frozen=True, slots=True, eq=False)
class IdentifiedFile:
    """What the JSON of ``identify`` holds of joints.

    Attributes:
        parameters: by name.
        covariance: of their logarithms, in their order; None in a file without it.
    """

    parameters: Mapping[str, JointParameter]
    covariance: FloatArray | None


def read_identified(path: Path) -> IdentifiedFile:
    """Read the parameters of the JSON of ``identify``.

    Raises:
        FormatError: the file is no such JSON.
    """
    if not path.is_file():
        raise FormatError(f"{path}: no such file; run 'jointbench identify --json'")
    if path.stat().st_size > _MOST_BYTES:
        raise FormatError(f"{path}: larger than {_MOST_BYTES} bytes")
    try:
        return identified_of(json.loads(path.read_text(encoding="utf-8")))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise FormatError(
            f"{path}: {_fault(error)}; give the file that "
            "'jointbench identify --json' wrote"
        ) from error


def identified_of(content: Mapping[str, Any]) -> IdentifiedFile:
    """Return the parameters in what ``identify`` writes.

    Args:
        content: plain data, as in its JSON.
    """
    found = {name: _parameter(name, one) for name, one in content["parameters"].items()}
    return IdentifiedFile(found, _covariance(content, len(found)))


def _fault(error: Exception) -> str:
    """Return what a file lacks, in words."""
    if isinstance(error, KeyError):
        return f"no key {str(error.args[0])!r}"
    if isinstance(error, json.JSONDecodeError):
        return f"no JSON from line {error.lineno} on"
    if isinstance(error, TypeError | AttributeError):
        return "no table of identified parameters"
    return f"no identified parameters: {error}"


def state_values(
    file: IdentifiedFile,
    structure: Structure,
    table: IdentifyTable,
    label: str | None = None,
) -> StateValues:
    """Return the values of one state.

    Args:
        file: parameters by name.
        structure: that they belong to.
        table: of the model, with the stiffnesses that were not sought.
        label: of the state; None where there is one only.

    Raises:
        BadData: the JSON belongs to another model.
        UsageError: there are several states, or none of that name.
    """
    found = file.parameters
    label = _label(file, label)
    stiffness, damping = [], []
    parameters: list[JointParameter] = []
    for name in structure.parameter_names:
        one = _own(found, label, f"{name}_stiffness")
        if one is None:
            one = _known(name, table)
        loss = _own(found, label, f"{name}_damping")
        stiffness.append(one.value)
        damping.append(0.0 if loss is None else loss.value)
        parameters += [one] if loss is None else [one, loss]
    names = [
        f"{one}_{kind}"
        for kind in ("stiffness", "damping")
        for one in structure.parameter_names
    ]
    return StateValues(
        label,
        JointValues(np.array(stiffness), np.array(damping)),
        {n.rpartition(".")[0]: p.value for n, p in found.items() if is_modulus(n)},
        {n.rpartition(".")[0]: p.value for n, p in found.items() if is_mass(n)},
        tuple(parameters),
        _placed_covariance(file, label, names),
    )


def _placed_covariance(
    file: IdentifiedFile, label: str, names: list[str]
) -> FloatArray:
    """Return the covariance in the order of `names`; zero for what is not there."""
    whole = np.zeros((len(names), len(names)))
    if file.covariance is None:
        return whole
    order = list(file.parameters)
    keys = [f"{label}:{n}" if f"{label}:{n}" in order else n for n in names]
    # What is not identifiable has no useful linear interval.
    known = [
        (at, order.index(key))
        for at, key in enumerate(keys)
        if key in order and file.parameters[key].identifiable
    ]
    place, source = [a for a, _ in known], [b for _, b in known]
    whole[np.ix_(place, place)] = file.covariance[np.ix_(source, source)]
    return whole


def _covariance(content: Mapping[str, Any], count: int) -> FloatArray | None:
    if "log_covariance" not in content:
        return None
    found = np.array(content["log_covariance"], float)
    if found.shape != (count, count) or not np.isfinite(found).all():
        raise ValueError(f"log_covariance has shape {found.shape}")
    return found


def state_labels(file: IdentifiedFile) -> list[str]:
    """Return the labels of the states in a file; none where its parameters name none.

    Args:
        file: parameters by name.
    """
    names = file.parameters
    return list(dict.fromkeys(n.rpartition(":")[0] for n in names if ":" in n))


def label_parts(label: str) -> tuple[str, float | None]:
    """Return the name in the label of a state, ``session@25000N``, and its preload [N].

    Args:
        label: of a state; without a preload it is the name.
    """
    found = re.fullmatch(r"(.*)@([0-9.eE+-]+)N", label)
    return (found[1], float(found[2])) if found else (label, None)


def _label(file: IdentifiedFile, label: str | None) -> str:
    labels = state_labels(file)
    if label is None and len(labels) > 1:
        raise UsageError(f"the file holds the states {labels}; choose one with --state")
    if label is not None and label not in labels:
        raise UsageError(f"no state {label!r}; the file holds {labels or 'one only'}")
    return label or (labels[0] if labels else "")


def _own(
    found: Mapping[str, JointParameter], label: str, name: str
) -> JointParameter | None:
    return found.get(f"{label}:{name}", found.get(name))


def _known(name: str, table: IdentifyTable) -> JointParameter:
    value = table.known.get(name)
    if value is None:
        raise BadData(
            f"the file of parameters holds no {name}_stiffness, and identify.known of "
            "the model neither; identify this model, and give the JSON of that run"
        )
    return JointParameter(
        f"{name}_stiffness", value, None, "N/m", True, "known, not identified"
    )


def _parameter(name: str, one: Mapping[str, Any]) -> JointParameter:
    low, high = one["interval_95"]
    value = float(one["value"])
    if not (np.isfinite(value) and value >= 0):
        raise ValueError(f"{name} is {value}")
    return JointParameter(
        name,
        value,
        None if one["sd"] is None else float(one["sd"]),
        str(one["unit"]),
        bool(one["identifiable"]),
        str(one.get("reason", "")),
        (None if low is None else float(low), None if high is None else float(high)),
    )
