# SPDX-License-Identifier: MIT
"""Stages kept by content: a stage is run again only if what it depends on changed.

The key of a stage is the SHA-256 of its name, its settings, the version of its code
(`code_version`) and the keys of the stages before it. A file begins with its key and
the SHA-256 of the rest: one that is damaged, or lies under another's name, is run
again.

Three stores run the same stages: `StageStore` keeps them in a folder, `MemoryStore` as
long as it lives, `NoStore` not at all, and needs no digest of anything.
"""

import json
import os
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, is_dataclass
from enum import Enum
from hashlib import file_digest, sha256
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryFile
from typing import Any, TypeVar, cast

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.records.session import software_version
from jointbench.signal.modal.lscf import Progress
from jointbench.station.pipeline.code_version import stage_version
from jointbench.station.pipeline.record_codec import (
    decode_record,
    encode_record,
    write_record,
)

_Record = TypeVar("_Record")
_SUFFIX, _PART = ".stage", ".part"
_KEY = 64
"""Characters of a key."""
_ABANDONED = 3600.0
"""Age at which a half-written stage counts as abandoned [s]."""


def stage_key(name: str, settings: object, *inputs: str) -> str:
    """Return the key of a stage.

    Args:
        name: of the stage; names its code, see `code_version`.
        settings: all it depends on besides its inputs: records and plain data.
        inputs: keys of the stages before it, or digests of files.
    """
    content = [stage_version(name), software_version(), name, _text(settings), *inputs]
    return sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _text(settings: object) -> Any:
    plain: Any = settings
    if is_dataclass(settings) and not isinstance(settings, type):
        plain = asdict(settings)
    return json.loads(json.dumps(plain, default=_plain, sort_keys=True))


def _plain(value: object) -> Any:
    if isinstance(value, Enum):
        return value.value
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    raise TypeError(f"no key can be made of a {type(value).__name__}")


@dataclass(slots=True)
class StageStore:
    """Runs stages, and keeps what they give in a folder.

    Attributes:
        folder: where stages are kept; None to keep none, but to name what each of them
            depends on.
        computed: names of the stages that were run, in order.
        reused: names of the stages that were taken as kept.
        keys: key of every stage that was asked for, by its name.
    """

    folder: Path | None = None
    computed: list[str] = field(default_factory=list)
    reused: list[str] = field(default_factory=list)
    keys: dict[str, str] = field(default_factory=dict)

    def key(self, name: str, settings: object, *inputs: str) -> str:
        """Return the key of a stage, see `stage_key`."""
        return stage_key(name, settings, *inputs)

    def digest(self, records: object) -> str:
        """Return the SHA-256 of records, by which a stage knows its inputs.

        Args:
            records: what `encode_record` takes.
        """
        return sha256(encode_record(records)).hexdigest()

    def run(
        self, name: str, key: str, kind: type[_Record], make: Callable[[], _Record]
    ) -> _Record:
        """Return the record of a stage, kept or made now.

        Args:
            name: of the stage, for people.
            key: of this store's `key`.
            kind: type of the record.
            make: runs the stage; what it raises passes through and is not kept.
        """
        self.keys[name] = key
        kept = self._kept(key, kind)
        if kept is not None:
            self.reused.append(name)
            return kept
        record = make()
        self.computed.append(name)
        self._keep(key, record)
        return record

    def _path(self, key: str) -> Path:
        assert self.folder is not None
        return self.folder / key[:2] / f"{key}{_SUFFIX}"

    def _kept(self, key: str, kind: type[_Record]) -> _Record | None:
        if self.folder is None:
            return None
        path = self._path(key)
        try:
            record = decode_record(_unsealed(key, path), kind)
            os.utime(path)  # what was used last is dropped last
        except (OSError, FormatError):
            return None
        return record

    def _keep(self, key: str, record: object) -> None:
        if self.folder is not None:
            _write(self._path(key), key, record)


@dataclass(slots=True)
class MemoryStore(StageStore):
    """Keeps the records of stages as long as it lives; several uses may share it.

    Attributes:
        records: of the stages that were run, by their keys.
    """

    records: dict[str, object] = field(default_factory=dict)

    def _kept(self, key: str, kind: type[_Record]) -> _Record | None:
        return cast("_Record | None", self.records.get(key))

    def _keep(self, key: str, record: object) -> None:
        self.records[key] = record


@dataclass(slots=True)
class NoStore(StageStore):
    """Runs stages and keeps nothing; no key is made, no input is digested."""

    def key(self, name: str, settings: object, *inputs: str) -> str:
        """Return no key."""
        return ""

    def digest(self, records: object) -> str:
        """Return no digest."""
        return ""

    def _kept(self, key: str, kind: type[_Record]) -> _Record | None:
        return None

    def _keep(self, key: str, record: object) -> None:
        """Keep nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class StageRun:
    """What the stages of one input share.

    Attributes:
        stages: keeps them.
        digest: SHA-256 of the file of the input, in which names are unique; empty to
            know records by their content.
        progress: receives step and share done; None for no report.
    """

    stages: StageStore = field(default_factory=NoStore)
    digest: str = ""
    progress: Progress | None = None

    def source(self, name: str, record: object) -> tuple[str, ...]:
        """Return what a record of the input is known by: file and name, or content."""
        return (self.digest, name) if self.digest else (self.stages.digest(record),)


def _head(key: str, digest: str) -> bytes:
    """Return the line before the content of a kept stage."""
    return f"{key} {digest}\n".encode()


def _unsealed(key: str, path: Path) -> bytes:
    if not path.is_file():
        raise FormatError(f"there is no file '{path}'")
    with path.open("rb") as file:
        head, content = file.readline(), file.read()
    if head != _head(key, sha256(content).hexdigest()):
        raise FormatError(f"'{path}' does not hold what its name says")
    return content


def _write(path: Path, key: str, record: object) -> None:
    """Write whole or not at all; a disk that is full keeps nothing, and that is fine.

    The content is written before the line with its digest, which precedes it, so that
    the bytes of a large record are in no memory. No fsync: after a power loss the
    digest detects damage, and the stage runs again.
    """
    part = path.with_name(f"{path.name}.{os.getpid()}{_PART}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=path.parent) as content, part.open("wb") as file:
            write_record(record, content)
            content.seek(0)
            file.write(_head(key, file_digest(content, "sha256").hexdigest()))
            content.seek(0)
            copyfileobj(content, file)
        part.replace(path)
    except OSError:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def prune_stages(folder: Path, most_bytes: int) -> int:
    """Drop the stages that were not used for longest until the rest fits.

    What a killed worker left half written goes as well.

    Args:
        folder: of the stages.
        most_bytes: that may stay [bytes].

    Returns:
        How many were dropped.
    """
    found = []
    now = time.time()
    for path in folder.glob(f"??/{'?' * _KEY}{_SUFFIX}*"):
        try:
            info = path.stat()
        except OSError:
            continue
        if path.suffix == _PART:
            if now - info.st_mtime > _ABANDONED:
                path.unlink(missing_ok=True)
            continue
        found.append((info.st_mtime, info.st_size, path))
    total, dropped = sum(size for _, size, _ in found), 0
    for _, size, path in sorted(found):
        if total <= most_bytes:
            break
        path.unlink(missing_ok=True)
        total, dropped = total - size, dropped + 1
    return dropped


def differing(keys: Mapping[str, str], others: Mapping[str, str]) -> Sequence[str]:
    """Return the names of stages whose keys are not the same, in order."""
    return [
        name
        for name in dict.fromkeys([*keys, *others])
        if keys.get(name) != others.get(name)
    ]
