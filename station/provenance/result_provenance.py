# SPDX-License-Identifier: MIT
"""Where a result comes from: inputs, recipe, build, versions, sensors, uncertainty."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.netcdf_read import read_array, read_texts
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.station.provenance.uncertainty_budget import (
    LEFT_OUT,
    BudgetRow,
    uncertainty_budget,
)
from jointbench.station.results.processed_file import SENSOR_FACTS
from jointbench.station.results.results_read import (
    StoredResult,
    open_result,
    read_result,
)


@dataclass(frozen=True, slots=True, eq=False)
class ResultProvenance:
    """All that a reviewer asks of a result.

    Attributes:
        result: facts, recipe, keys of the stages, quantities.
        digest: SHA-256 of the results file.
        environment: build, versions and kind of computer; empty for results of
            earlier versions.
        sensors: facts of each sensor; empty where the session states none.
        budget: contributions to each standard deviation.
        session: the input, where it lies beside the result unchanged, or None.
    """

    result: StoredResult
    digest: str
    environment: Mapping[str, str]
    sensors: tuple[Mapping[str, str | float], ...]
    budget: tuple[BudgetRow, ...]
    session: Path | None

    def as_json(self) -> dict[str, Any]:
        """Return the provenance as plain data."""
        result = self.result
        return {
            "schema": "jointbench-provenance/1",
            "result": {"file": result.path.name, "sha256": self.digest},
            "key": result.key,
            "facts": dict(result.facts),
            "torque_n_m": result.torque,
            "preload_n": result.preload,
            "recipe": dict(result.recipe),
            "stages": dict(result.stages),
            "environment": dict(self.environment),
            "sensors": [dict(one) for one in self.sensors],
            "uncertainty_budget": [asdict(row) for row in self.budget],
            "not_in_the_budget": list(LEFT_OUT),
            "session_found": self.session is not None,
        }


def result_provenance(path: Path) -> ResultProvenance:
    """Read where a result comes from.

    Args:
        path: of a results file of `modal`, `process` or `reprocess`.

    Raises:
        BadData: it is no whole results file.
    """
    result = read_result(path)
    with open_result(path) as file:
        environment = _environment(file)
        sensors = _sensors(file)
    return ResultProvenance(
        result=result,
        digest=file_digest(path),
        environment=environment,
        sensors=sensors,
        budget=uncertainty_budget(result),
        session=_input(path, result),
    )


def _environment(file: h5py.File) -> dict[str, str]:
    found = file.get("environment")
    return {} if found is None else {k: _text(v) for k, v in found.attrs.items()}


def _text(value: object) -> str:
    return value.decode("utf-8") if isinstance(value, bytes) else str(value)


def _sensors(file: h5py.File) -> tuple[dict[str, str | float], ...]:
    group = file.get("sensors")
    if group is None:
        return ()
    columns = [read_texts(group[name]) for name in SENSOR_FACTS]
    known = read_array(group["sensitivity_sd"])
    rows = [
        dict(zip(SENSOR_FACTS, row, strict=True)) for row in zip(*columns, strict=True)
    ]
    return tuple(
        {k: v for k, v in row.items() if v}
        | ({} if np.isnan(sd) else {"sensitivity_sd": float(sd)})
        for row, sd in zip(rows, known, strict=True)
    )


def _input(path: Path, result: StoredResult) -> Path | None:
    """Return the session beside the result if its content is what was processed."""
    beside = path.parent / Path(result.facts["input_file"].splitlines()[0]).name
    try:
        same = file_digest(beside) == result.facts["input_sha256"].splitlines()[0]
    except (OSError, BadData, IndexError):
        return None
    return beside if same else None
