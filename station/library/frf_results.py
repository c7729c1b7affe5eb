# SPDX-License-Identifier: MIT
"""FRFs of the accepted hits, or of files of FRFs."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.frf.measured_frf import measure_frf
from jointbench.signal.hits.windows import requested_window
from jointbench.station.files.frf_files import read_frf
from jointbench.station.library.argument_checks import require_texts
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
from jointbench.station.pipeline.modal_options import modal_settings

if TYPE_CHECKING:
    from xarray import Dataset

_PLOTTED = 5
"""FRFs drawn in a notebook."""
FRF_UNITS = {
    FrfKind.RECEPTANCE: "m N-1",
    FrfKind.MOBILITY: "m s-1 N-1",
    FrfKind.ACCELERANCE: "m s-2 N-1",
}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class MeasuredFrfs(Shown):
    """FRFs with coherence and variance.

    Attributes:
        frf: the record.
        hits: they are averaged from; None for files of FRFs.
    """

    frf: Frf
    hits: JudgedHits | None = None

    def to_xarray(self) -> "Dataset":
        """Return FRF, coherence and variance over output, input and frequency."""
        frf, unit = self.frf, FRF_UNITS[self.frf.kind]
        dims = ("output", "input", "frequency")
        variables: dict[str, Variable] = {
            frf.kind.value: (dims, frf.response, unit, f"{frf.kind.value} H")
        }
        if frf.coherence is not None:
            variables["coherence"] = dims, frf.coherence, "1", "ordinary coherence"
        if frf.variance is not None:
            squared = " ".join(_squared(word) for word in unit.split())
            variables["variance"] = dims, frf.variance, squared, "variance of H"
        coordinates: dict[str, Variable] = {
            "output": (("output",), list(frf.outputs), "", "response channel@point"),
            "input": (("input",), list(frf.inputs), "", "hit point"),
            "frequency": (("frequency",), frf.frequency, "Hz", "frequency"),
        }
        return dataset(variables, coordinates, {"averages": frf.averages})

    @property
    def view(self) -> ResultView:
        """One row a pair of output and input, and the magnitudes drawn."""
        frf = self.frf
        pairs = [
            (o, i) for o in range(len(frf.outputs)) for i in range(len(frf.inputs))
        ]
        seen = excited_lines(frf)
        rows = [
            (
                f"{frf.outputs[o]} / {frf.inputs[i]}",
                "-"
                if frf.coherence is None
                else f"{np.median(frf.coherence[o, i, seen]):.4f}",
            )
            for o, i in pairs
        ]
        curves = [
            Curve(rows[k][0], frf.frequency[seen], np.abs(frf.response[o, i, seen]))
            for k, (o, i) in enumerate(pairs[:_PLOTTED])
        ]
        unit = f"|H| [{FRF_UNITS[frf.kind]}]"
        plot = line_plot(curves, AxisView("frequency [Hz]"), AxisView(unit, log=True))
        averages = f"{frf.averages} averages" if frf.averages else "averages unknown"
        title = (
            f"{frf.kind.value}, {len(frf.outputs)} outputs x {len(frf.inputs)} inputs, "
            f"{frf.frequency[0]:g} to {frf.frequency[-1]:g} Hz, {averages}"
        )
        columns = ("output / input", "median coherence in the excited band")
        return ResultView(title, columns, tuple(rows), plots=(plot,))


def excited_lines(found: Frf) -> BoolArray:
    """Return which lines lie in the excited band, shape (n_lines,); all if unknown."""
    if found.usable_band is None:
        return np.ones(found.frequency.size, dtype=bool)
    low, high = found.usable_band
    return (found.frequency >= low) & (found.frequency <= high)


def frf(
    source: Source | JudgedHits,
    *,
    estimator: str = "H1",
    columns: str | None = None,
    point: str = "1",
) -> MeasuredFrfs:
    """Estimate the FRFs of the accepted hits, or read files of FRFs.

    Args:
        source: a measurement at one preload, judged hits, files of hits or of FRFs.
        estimator: ``"H1"``, ``"H2"`` or ``"Hv"``.
        columns: of plain tables, with units.
        point: where the hammer struck, for files that do not say.

    Returns:
        FRFs with coherence and variance.

    Raises:
        BadData: no accepted hit, or a file cannot be read.
        UsageError: the recordings have several preloads.
    """
    require_texts("'H1'", estimator=estimator, columns=columns)
    settings = modal_settings(None, None, estimator or "H1", (), ())
    if not isinstance(source, Measurement | JudgedHits):
        read = read_frf(paths_of(source), FrfOptions(columns, point))
        if read is not None:
            return MeasuredFrfs(read)
    judged = (
        source
        if isinstance(source, JudgedHits)
        else hits(source, columns=columns, point=point)
    )
    require_one_preload(judged.recordings)
    window = requested_window(judged.recordings, settings.window)
    found = measure_frf(judged.recordings, window=window, estimator=settings.estimator)
    return MeasuredFrfs(found.frf, judged)


def _squared(word: str) -> str:
    name = word.rstrip("-0123456789")
    power = int(word[len(name) :] or 1)
    return f"{name}{2 * power}"
