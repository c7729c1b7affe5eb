# SPDX-License-Identifier: MIT
"""Where results may go: never over an input, never over a file of another kind."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.replace_file import replace_file

_HEAD_BYTES = 512
_HDF5_MAGIC = b"\x89HDF\r\n\x1a\n"
_TABLE_HEADS: dict[str, tuple[bytes, ...]] = {
    ".csv": (b"file,input_sha256,", b"lag_x [um],"),
    ".parquet": (b"PAR1",),
    ".mat": (b"MATLAB",),
}
"""How tables of an archive and structure maps begin."""


def check_outputs(inputs: Sequence[Path], outputs: Sequence[Path | str | None]) -> None:
    """Refuse outputs that would destroy something, before any work is done.

    Args:
        inputs: files that the command reads.
        outputs: files it will write; None and ``-`` (standard output) are left out.

    Raises:
        UsageError: an output is an input or another output, lies in no folder, or is
            an existing file of another kind than the one that would replace it.
    """
    taken = {path.resolve(): "an input" for path in inputs}
    for output in outputs:
        if output is None or str(output) == "-":
            continue
        path = Path(output)
        place = path.resolve()
        if place in taken:
            raise UsageError(f"'{path}' is {taken[place]}; write to another file")
        if not place.parent.is_dir():
            raise UsageError(
                f"'{path}': there is no folder '{path.parent}'; make it first"
            )
        if place.is_dir():
            raise UsageError(f"'{path}' is a folder; name a file in it")
        if place.exists() and not _of_its_kind(place):
            raise UsageError(
                f"'{path}' is there already and no earlier result of this kind; "
                "choose another name or remove it"
            )
        taken[place] = "another output"


def require_mark(path: Path, mark: bytes, whose: str) -> None:
    """Refuse to replace a file that is there, unless its head holds a mark.

    Args:
        path: of the file to be.
        mark: by which an earlier one is known, within its first 512 bytes.
        whose: who made the earlier one, for the message.

    Raises:
        UsageError: the file is there and does not hold it.
    """
    if not path.is_file():
        return
    with path.open("rb") as file:
        head = file.read(max(_HEAD_BYTES, len(mark)))
    if mark not in head:
        raise UsageError(
            f"{named(path)} is there already and was made by no {whose}; choose "
            "another name, or move it away"
        )


def check_folder(folder: Path, own: Sequence[str]) -> None:
    """Refuse a folder that holds anything else than earlier results.

    Args:
        folder: that will be filled.
        own: names of the files that the command itself makes.

    Raises:
        UsageError: `folder` is a file, or holds a file of another name.
    """
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"'{folder}' is a file; name a folder")
    names = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    foreign = sorted(names - set(own))
    if foreign:
        raise UsageError(
            f"'{folder}' holds {foreign[0]!r}, which this demo does not make; name "
            "another folder with --out"
        )


def require_folder(path: Path | None, option: str) -> None:
    """Raise `UsageError` where something else than a folder has its name."""
    if path is not None and path.exists() and not path.is_dir():
        raise UsageError(f"{option} is '{path}', a file; name a folder")


def make_folder(path: Path) -> None:
    """Make a folder and those above it, where they are not there.

    Raises:
        UsageError: there can be none.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(
            f"folder {named(path)} cannot be made: {error.strerror}; choose another "
            "place"
        ) from error


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Let a file be written so that it is there whole or not at all.

    Args:
        path: of the file to be.

    Yields:
        Where to write: a file beside it that takes its name when all went well.

    Raises:
        UsageError: it cannot be written there.
    """
    part = path.with_name(path.name + ".part")
    try:
        yield part
        replace_file(part, path)
    except OSError as error:
        raise UsageError(
            f"{named(path)} cannot be written: {error.strerror or error}; choose "
            "another place"
        ) from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text so that it is there whole or not at all.

    A device or a pipe (``/dev/null``) is written to: replacing it would destroy it.

    Raises:
        UsageError: it cannot be written there.
    """
    if path.exists() and not path.is_file():
        path.write_text(text, encoding="utf-8")
        return
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8")


def _of_its_kind(path: Path) -> bool:
    """Return whether an existing file is a result that may be replaced."""
    with path.open("rb") as file:
        head = file.read(_HEAD_BYTES)
    suffix = path.suffix.lower()
    if suffix in {".h5", ".hdf5"}:
        return head.startswith(_HDF5_MAGIC) and _has_schema(path, "jointbench-results/")
    if suffix == ".nc":
        return head.startswith(_HDF5_MAGIC) and _has_schema(path, "jointbench-archive/")
    if suffix in _TABLE_HEADS:
        return not head or head.startswith(_TABLE_HEADS[suffix])
    if suffix in {".html", ".htm"}:
        return head.lower().startswith(b"<!doctype html>")
    return not head or head.lstrip().startswith(b"{")


def _has_schema(path: Path, family: str) -> bool:
    import h5py

    try:
        with h5py.File(path, "r") as file:
            schema = file.attrs.get("schema", b"")
    except OSError:
        return False
    text = schema if isinstance(schema, bytes) else str(schema).encode()
    return text.startswith(family.encode())
