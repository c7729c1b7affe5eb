# SPDX-License-Identifier: MIT
"""``jointbench import --guess``: propose, show, and write only on confirmation."""

import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import typer

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.hits.plausibility import plausibility_words, struck_mass
from jointbench.station.files.input_files import read_foreign
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.guess.picture import block_rows, write_picture
from jointbench.station.guess.propose import ASSUMED, ColumnProposal, propose
from jointbench.station.guess.raw_columns import read_raw_columns
from jointbench.station.screen.terminal import console, table, write_json

_GRAVITY = 9.80665


@dataclass(frozen=True, slots=True)
class GuessRequest:
    """How a proposal is shown and confirmed.

    Attributes:
        yes: write without asking.
        picture: HTML file to write, or None.
    """

    yes: bool = False
    picture: Path | None = None


def run_guess(
    files: Sequence[Path],
    out: Path,
    given: SampleOptions,
    guess: GuessRequest,
    json_target: str | None,
) -> SampleOptions | None:
    """Propose how `files` are read, show the first hit, and have it confirmed.

    Args:
        files: hits of one kind; the first one is looked at.
        out: session file that is to be written.
        given: options as typed; what they state is not guessed.
        guess: how to show and confirm.
        json_target: where the JSON goes.

    Returns:
        The options of the import once they are confirmed, else None.

    Raises:
        BadData: a file cannot be read.
        UsageError: nothing can be proposed; the message has what is missing.
    """
    check_outputs([*files, out], [json_target, guess.picture])
    options, proposal = _proposed(files[0], given)
    found = _read(files, options)
    notes = _notes(found, proposal)
    screen = console(json_target)
    if proposal is not None:
        rows = [(one.name or "-", one.item, one.reason) for one in proposal.items]
        screen.print(table(str(files[0]), ("column", "proposal", "reason"), rows))
        if proposal.rate is not None:
            screen.print(f"rate: {proposal.rate:g} Hz ({proposal.rate_reason})")
    for row in block_rows(found[0]):
        screen.print(row, markup=False, highlight=False, soft_wrap=True)
    for note in notes:
        screen.print(note, markup=False)
    if guess.picture is not None:
        write_picture(guess.picture, found[0], notes)
        screen.print(f"picture: {guess.picture}", soft_wrap=True)
    command = _command(files, out, options)
    screen.print(f"command: {command}", markup=False, soft_wrap=True)
    if not (guess.yes or _confirmed(out)):
        screen.print(f"nothing was written to {out}; add --yes to write it")
        content = {"written": False, "command": command, "notes": notes}
        write_json(json_target, content)
        return None
    return options


def _proposed(
    path: Path, given: SampleOptions
) -> tuple[SampleOptions, ColumnProposal | None]:
    """Return the options of an import, and the proposal where the file needs one."""
    try:
        records = read_foreign(path, given)
    except (UsageError, BadData) as error:
        if given.columns is not None:
            raise
        proposal = _proposal(path, given, error)
        return replace(given, columns=proposal.columns, rate=proposal.rate), proposal
    if not isinstance(records[0], Recording):
        raise UsageError(
            f"'{path}' is a surface, whose file states its units; import it without "
            "--guess"
        )
    return given, None


def _proposal(
    path: Path, given: SampleOptions, error: UsageError | BadData
) -> ColumnProposal:
    try:
        found = propose(read_raw_columns(path), given.rate)
    except (UsageError, BadData):
        raise error from None
    if not any(one.item.startswith("force") for one in found.items):
        raise UsageError(
            f"'{path}': no column is a short pulse, as the force of a hammer is; name "
            f"the columns with --columns ({error})"
        )
    if found.rate is None and found.rate_reason:
        raise UsageError(
            f"'{path}' has no column of times and states no rate; pass it as well, for "
            "example --rate '25.6 kHz'"
        )
    return found


def _read(files: Sequence[Path], options: SampleOptions) -> list[Recording]:
    records = [one for path in files for one in read_foreign(path, options)]
    return [one for one in records if isinstance(one, Recording)]


def _notes(found: Sequence[Recording], proposal: ColumnProposal | None) -> list[str]:
    """Return what to look at before confirming."""
    notes = [f"warning: {words}" for words in plausibility_words(found)]
    mass = struck_mass(found[0])
    if mass is not None:
        notes.append(
            f"check: impulse over velocity at {mass.channel!r} is {mass.mass:.3g} kg, "
            f"at the struck point the mass that moves with the hit (if the numbers "
            f"were g, not m/s^2: {mass.mass / _GRAVITY:.3g} kg)"
        )
    if proposal is not None and any(ASSUMED in one.reason for one in proposal.items):
        notes.append(
            "check: units marked as assumed stand in no file; correct the command "
            "below where they are others"
        )
    return notes


def _command(files: Sequence[Path], out: Path, options: SampleOptions) -> str:
    words = ["jointbench", "import", *map(str, files), "--out", str(out)]
    if options.columns is not None:
        words += ["--columns", options.columns]
    if options.rate is not None:
        words += ["--rate", f"{options.rate:.12g} Hz"]
    if options.point != SampleOptions().point:
        words += ["--point", options.point]
    if options.full_scale is not None:
        words += ["--full-scale", f"{options.full_scale:g}"]
    return shlex.join(words)


def _confirmed(out: Path) -> bool:
    """Ask at a terminal; without one nothing is confirmed."""
    if not sys.stdin.isatty():
        return False
    return typer.confirm(f"Write {out}?", default=False, err=True)
