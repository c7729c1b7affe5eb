# SPDX-License-Identifier: MIT
"""Open and record measurements: sessions, files of hits and of surfaces, URLs."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.basics.units import parse_value
from jointbench.acquisition.formats.columns import HITS_EXAMPLE
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.records.surfaces import Surface
from jointbench.acquisition.session_file.open_session import open_session
from jointbench.station.files.input_files import (
    is_session_name,
    read_foreign,
    refuse_twice,
)
from jointbench.station.files.session_place import check_session_name
from jointbench.station.files.typed_values import parse_point, parse_rate
from jointbench.station.library.argument_checks import one_path, require_texts
from jointbench.station.library.labelled_arrays import dataset
from jointbench.station.library.line_plot import AxisView, Curve, line_plot
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.sources.recorded_session import record_session_file

if TYPE_CHECKING:
    from xarray import Dataset

Files = str | Path | Sequence[str | Path]
_PLOTTED = 3
"""Recordings drawn in a notebook."""
_LISTED = 12
"""Recordings and surfaces listed."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Measurement(Shown):
    """Recordings and surfaces of one or several files.

    Attributes:
        files: that were read.
        recordings: samples in SI units; large ones stay in their file.
        surfaces: profiles and maps.
        session: the session file, or None for other files.
        model: bench model that a recorded campaign brought, or None.
    """

    files: tuple[Path, ...]
    recordings: tuple[Recording, ...] = ()
    surfaces: tuple[Surface, ...] = ()
    session: Session | None = None
    model: Path | None = None

    @property
    def preloads(self) -> tuple[float | None, ...]:
        """Preloads of the recordings [N], in the order met; None where unknown."""
        return tuple(dict.fromkeys(one.preload for one in self.recordings))

    def at(self, preload: str | float | None) -> "Measurement":
        """Return the measurement at one preload.

        Args:
            preload: [N], or a text with unit such as ``"2 kN"``.

        Raises:
            UsageError: there is no recording at this preload.
        """
        wanted = parse_value(preload, "force") if isinstance(preload, str) else preload
        kept = tuple(r for r in self.recordings if r.preload == wanted)
        if not kept:
            known = ", ".join(
                "none" if p is None else f"{p:g} N" for p in self.preloads
            )
            raise UsageError(f"no recording at {preload!r}; preloads are {known}")
        return Measurement(self.files, kept, self.surfaces, self.session, self.model)

    def to_xarray(self, name: str | None = None) -> "Dataset":
        """Return the samples of one recording, labelled.

        Args:
            name: of the recording; None where there is only one.

        Raises:
            UsageError: no recording of that name, or several and none named.
        """
        one = self._recording(name)
        time = one.start_time + np.arange(one.samples.shape[1]) / one.sample_rate
        variables = {
            channel.name: (
                ("time",),
                one.samples[i],
                _UNITS[channel.quantity.value],
                words,
            )
            for i, channel in enumerate(one.channels)
            for words in [f"{channel.quantity.value} at {channel.point or 'no point'}"]
        }
        facts = {"recording": one.name, "sample_rate_hz": one.sample_rate}
        facts |= {} if one.preload is None else {"preload_n": one.preload}
        if one.preload_sd is not None:
            facts |= {"preload_sd_n": one.preload_sd}
        return dataset(variables, {"time": (("time",), time, "s", "time")}, facts)

    def _recording(self, name: str | None) -> Recording:
        found = [r for r in self.recordings if name in {None, r.name}]
        if len(found) != 1:
            names = ", ".join(repr(r.name) for r in self.recordings) or "none"
            raise UsageError(f"name one recording of {names}; got {name!r}")
        return found[0]

    @property
    def view(self) -> ResultView:
        """Recordings and surfaces, one row each, and the first recordings drawn."""
        rows = [
            (
                r.name,
                ", ".join(f"{c.name} ({c.quantity.value})" for c in r.channels),
                f"{r.samples.shape[1] / r.sample_rate:.4g} s at {r.sample_rate:g} Hz",
                "-" if r.preload is None else f"{r.preload:g} N",
            )
            for r in self.recordings
        ]
        rows += [
            (s.name, type(s).__name__.lower(), "surface", "-") for s in self.surfaces
        ]
        title = f"{', '.join(path.name for path in self.files)}: {_counted(self)}"
        rest = len(rows) - _LISTED
        said = (f"and {rest} more",) if rest > 0 else ()
        plots = tuple(_plot(one) for one in self.recordings[:_PLOTTED])
        columns = ("name", "channels", "length", "preload")
        return ResultView(title, columns, tuple(rows[:_LISTED]), said, plots)


_UNITS = {
    "force": "N",
    "acceleration": "m s-2",
    "velocity": "m s-1",
    "displacement": "m",
}


def open_measurement(
    files: Files,
    *,
    columns: str | None = None,
    point: str = "1",
    rate: str | float | None = None,
) -> Measurement:
    """Open sessions, files of hits, or surfaces.

    Args:
        files: one or several; formats are recognised by content.
        columns: what the columns of plain tables hold, with units, for example
            ``"time:s,force:N,acceleration:m/s^2"`` or ``"x:um,z:um"``.
        point: where the hammer struck, for files that do not say.
        rate: sample rate of files without times: [Hz], or a text such as
            ``"25.6 kHz"``.

    Returns:
        Recordings and surfaces of all files.

    Raises:
        BadData: a file cannot be read, or its units are missing.
        UsageError: the same data twice, or an empty point.
    """
    paths = paths_of(files)
    require_texts(f"{HITS_EXAMPLE!r}", columns=columns, point=point)
    refuse_twice(paths)
    options = SampleOptions(columns, parse_point(point), rate=parse_rate(rate))
    recordings: list[Recording] = []
    surfaces: list[Surface] = []
    sessions: list[Session] = []
    for path in paths:
        if is_session_name(path):
            sessions.append(open_session(path))
            recordings += sessions[-1].recordings
            surfaces += sessions[-1].surfaces
            continue
        for one in read_foreign(path, options):
            if isinstance(one, Recording):
                recordings.append(one)
            else:
                surfaces.append(one)
    alone = sessions[0] if len(sessions) == len(paths) == 1 else None
    return Measurement(paths, tuple(recordings), tuple(surfaces), alone)


def record(url: str, out: str | Path, *, overwrite: bool = False) -> Measurement:
    """Record a bench into a session file.

    Args:
        url: of the source, for example ``"sim:two-body?seed=1&hits=10"``.
        out: session file to write (.h5).
        overwrite: replace an earlier session.

    Returns:
        The measurement; `Measurement.model` is the bench model of a campaign.

    Raises:
        UsageError: the URL is unknown, or the file is there already.
    """
    if not isinstance(url, str):
        raise UsageError(
            f"{url!r} is no source; give the URL of a bench, for example "
            "'sim:two-body?seed=1&hits=10'"
        )
    path = one_path(out, "the session to write")
    check_session_name(path)
    if path.exists() and not overwrite:
        raise UsageError(f"'{path}' is there already; overwrite=True replaces it")
    written = record_session_file(url, path, overwrite=overwrite)
    session = written.session
    return Measurement(
        (written.path,), session.recordings, session.surfaces, session, written.model
    )


def paths_of(files: Files) -> tuple[Path, ...]:
    """Return one or several files as paths.

    Raises:
        UsageError: none is given.
    """
    given = [files] if isinstance(files, str | Path) else files
    if not isinstance(given, Sequence) or not all(
        isinstance(one, str | Path) for one in given
    ):
        raise UsageError(f"{files!r} is no file name; give a path, or a list of paths")
    if not given:
        raise UsageError("no file is given; name at least one")
    return tuple(Path(one) for one in given)


def _counted(found: Measurement) -> str:
    return f"{len(found.recordings)} recordings, {len(found.surfaces)} surfaces"


def _plot(one: Recording) -> str:
    time = np.arange(one.samples.shape[1]) / one.sample_rate
    curves = []
    for i, channel in enumerate(one.channels):
        values = np.asarray(one.samples[i], dtype=float)
        curves.append(Curve(channel.name, time, values / (np.abs(values).max() or 1.0)))
    return line_plot(curves, AxisView("time [s]"), AxisView(f"{one.name} / peak [-]"))
