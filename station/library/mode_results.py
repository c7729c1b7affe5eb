# SPDX-License-Identifier: MIT
"""Modes of a measurement or of FRFs, with intervals."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.signal.modal.mode_ranking import rate_modes
from jointbench.station.files.frf_files import read_frf
from jointbench.station.library.argument_checks import (
    checked_band,
    require_lists,
    require_texts,
)
from jointbench.station.library.frf_results import (
    FRF_UNITS,
    MeasuredFrfs,
    excited_lines,
)
from jointbench.station.library.hit_results import (
    JudgedHits,
    Source,
    hits,
    require_one_preload,
)
from jointbench.station.library.labelled_arrays import Variable, dataset
from jointbench.station.library.line_plot import AxisView, Curve, line_plot
from jointbench.station.library.measurements import (
    Measurement,
    paths_of,
)
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.pipeline.chain import (
    ModalChain,
    frf_chain,
    judged_modes,
)
from jointbench.station.pipeline.modal_notes import modal_notes
from jointbench.station.pipeline.modal_options import modal_settings
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.screen.value_text import with_sd

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class IdentifiedModes(Shown):
    """Modes with intervals at one preload.

    Attributes:
        chain: hits, FRF, stabilisation, modes and their curves over amplitude.
    """

    chain: ModalChain

    def to_xarray(self) -> "Dataset":
        """Return natural frequencies, damping ratios and shapes with their sd."""
        model = self.chain.result.model
        rated = rate_modes(model, self.chain.result.stabilisation.orders.size)
        per = ("mode",)
        shape = ("mode", "output")
        variables: dict[str, Variable] = {
            "frequency": (per, model.natural_frequency, "Hz", "natural frequency"),
            "frequency_sd": (per, model.frequency_sd, "Hz", "its standard uncertainty"),
            "damping_ratio": (per, model.damping_ratio, "1", "damping ratio"),
            "damping_ratio_sd": (per, model.damping_ratio_sd, "1", "its sd"),
            "confidence": (per, rated.confidence, "1", "0 doubtful, 1 reliable"),
            "shape": (shape, model.shapes, "1", "shape, largest component 1"),
        }
        coordinates: dict[str, Variable] = {
            "mode": (
                per,
                np.arange(1, model.natural_frequency.size + 1),
                "1",
                "number",
            ),
            "output": (("output",), list(model.outputs), "", "response channel@point"),
        }
        low, high = self.chain.result.band
        return dataset(variables, coordinates, {"band_hz": [low, high]})

    @property
    def view(self) -> ResultView:
        """One row a mode, the remarks, and the FRF beside its synthesis."""
        result = self.chain.result
        model = result.model
        rated = rate_modes(model, result.stabilisation.orders.size)
        rows = [
            (
                str(i + 1),
                with_sd(model.natural_frequency[i], model.frequency_sd[i]),
                with_sd(100 * model.damping_ratio[i], 100 * model.damping_ratio_sd[i]),
                rated.grades[i].value,
            )
            for i in range(model.natural_frequency.size)
        ]
        notes = modal_notes(self.chain)
        low, high = result.band
        title = f"Modes between {low:.4g} and {high:.4g} Hz (± one standard deviation)"
        columns = ("mode", "natural frequency [Hz]", "damping ratio [%]", "confidence")
        said = (*notes.limits, *notes.remarks())
        return ResultView(title, columns, tuple(rows), said, (self._plot(),))

    def _plot(self) -> str:
        frf, synthesis = self.chain.frf, self.chain.result.synthesis
        seen = excited_lines(frf)
        curves = [
            Curve("measured", frf.frequency[seen], np.abs(frf.response[0, 0, seen])),
            Curve("synthesis", synthesis.frequency, np.abs(synthesis.response[0, 0])),
        ]
        unit = f"|H| {frf.outputs[0]} / {frf.inputs[0]} [{FRF_UNITS[frf.kind]}]"
        return line_plot(curves, AxisView("frequency [Hz]"), AxisView(unit, log=True))


def modes(
    source: Source | JudgedHits | MeasuredFrfs,
    *,
    band: tuple[float, float] | None = None,
    order: int | None = None,
    estimator: str = "H1",
    keep: Sequence[float] = (),
    drop: Sequence[float] = (),
    columns: str | None = None,
) -> IdentifiedModes:
    """Identify the modes of a measurement or of FRFs.

    Args:
        source: a measurement at one preload, judged hits, FRFs, or files of either.
        band: lowest and highest frequency [Hz]; None lets the data choose.
        order: highest model order; None lets the data choose.
        estimator: of the FRF: ``"H1"``, ``"H2"`` or ``"Hv"``.
        keep: frequencies of modes to keep [Hz].
        drop: frequencies of modes to drop [Hz].
        columns: of plain tables, with units.

    Returns:
        Natural frequencies, damping ratios and shapes with standard uncertainties.

    Raises:
        NoModeFound: there is none; the message gives possible causes.
        BadData: no accepted hit, or a file cannot be read.
        UsageError: the recordings have several preloads; `Measurement.at` selects one.
    """
    require_texts("'H1'", estimator=estimator, columns=columns)
    require_lists("[420.0]", keep=keep, drop=drop)
    band = checked_band(band)
    asked = None if band is None else f"{band[0]}:{band[1]}"
    settings = modal_settings(asked, order, estimator or "H1", keep, drop)
    found = source
    if not isinstance(found, Measurement | JudgedHits | MeasuredFrfs):
        read = read_frf(paths_of(found), FrfOptions(columns))
        found = found if read is None else MeasuredFrfs(read)
    if isinstance(found, MeasuredFrfs) and found.hits is None:
        return IdentifiedModes(frf_chain(found.frf, settings, StageRun()))
    if isinstance(found, MeasuredFrfs):
        assert found.hits is not None
        found = found.hits
    judged = found if isinstance(found, JudgedHits) else hits(found, columns=columns)
    require_one_preload(judged.recordings)
    return IdentifiedModes(judged_modes(judged.recordings, settings))
