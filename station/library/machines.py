# SPDX-License-Identifier: MIT
"""A machine of many bodies and joints, glued and jointed."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from jointbench.analysis.structures.machine.analyse_machine import analyse_machine
from jointbench.analysis.structures.machine.machine_result import MachineResult
from jointbench.station.files.toml_file import read_toml
from jointbench.station.library.argument_checks import one_path
from jointbench.station.library.labelled_arrays import dataset
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.machine.machine_cache import reduced_machine_of
from jointbench.station.machine.machine_file import MachineModel
from jointbench.station.machine.machine_json import machine_json
from jointbench.station.machine.machine_text import mode_table, sentences
from jointbench.station.machine.run_machine import request_of

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ComputedMachine(Shown):
    """A machine, glued beside jointed.

    Attributes:
        result: modes, tool receptance, costs of the joints and motion.
    """

    result: MachineResult

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain data, as ``machine --json`` writes it."""
        return dict(machine_json(self.result))

    def to_xarray(self) -> "Dataset":
        """Return the natural frequencies of the jointed and of the glued machine."""
        soft, rigid = self.result.jointed.modes, self.result.glued.modes
        per, other = ("mode",), ("glued_mode",)
        return dataset(
            {
                "jointed": (per, soft.natural_frequency, "Hz", "natural frequency"),
                "glued": (other, rigid.natural_frequency, "Hz", "natural frequency"),
            },
            {
                "mode": (
                    per,
                    np.arange(1, soft.natural_frequency.size + 1),
                    "1",
                    "mode",
                ),
                "glued_mode": (
                    other,
                    np.arange(1, rigid.natural_frequency.size + 1),
                    "1",
                    "mode of the glued machine",
                ),
            },
            {"freedoms": self.result.freedoms},
        )

    @property
    def view(self) -> ResultView:
        """Modes with their weakest regions, and the sentences of the report."""
        modes = mode_table(self.result)
        said = tuple(sentences(self.result))
        return ResultView(modes.title, modes.columns, modes.rows, said)


def machine(model: str | Path, *, cache: str | Path | None = None) -> ComputedMachine:
    """Compute a machine with rigid joints and with the given ones.

    Args:
        model: the machine as TOML.
        cache: folder that keeps reduced bodies.

    Returns:
        Modes, weakest regions, tool receptance, costs of the joints and motion.

    Raises:
        BadData: the model cannot be used.
        UsageError: a file name is none.
    """
    path = one_path(model, "a machine")
    settings = read_toml(path, MachineModel)
    kept = None if cache is None else one_path(cache, "a folder")
    reduced = reduced_machine_of(settings, path.parent, kept)
    return ComputedMachine(analyse_machine(reduced, request_of(settings, path.parent)))
