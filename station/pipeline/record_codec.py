# SPDX-License-Identifier: MIT
"""Records as plain arrays and one JSON text, and back; nothing is ever pickled.

Only records that the asked-for type can hold are made on reading, whatever the file
says; each field must be of its type, and the records' own checks run again.
"""

import io
import json
import types
import typing
import zipfile
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import IO, Any, TypeVar

import numpy as np

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.records.stored_samples import StoredSamples

Record = TypeVar("Record")
_TEXT = "record"
_KIND, _ARRAY, _COMPLEX, _MAP, _LIST = "@kind", "@array", "@complex", "@map", "@list"
_DAMAGE = (
    *(ValueError, TypeError, KeyError, IndexError, AttributeError, EOFError),
    *(OSError, zipfile.BadZipFile, NotImplementedError, RecursionError, MemoryError),
)


def encode_record(record: object) -> bytes:
    """Return a record, a tuple of records or plain data as bytes.

    Args:
        record: dataclasses of numbers, texts, enumerations, arrays, tuples, mappings.

    Raises:
        TypeError: it holds something else.
    """
    buffer = io.BytesIO()
    write_record(record, buffer)
    return buffer.getvalue()


def write_record(record: object, file: IO[bytes]) -> None:
    """Write a record to an open file as `encode_record` does; its arrays once.

    Args:
        record: see `encode_record`.
        file: empty, open for writing.
    """
    arrays: dict[str, np.ndarray[Any, Any]] = {}
    text = json.dumps(_plain(record, arrays)).encode()
    content: dict[str, Any] = {_TEXT: np.frombuffer(text, np.uint8), **arrays}
    np.savez(file, **content)


def decode_record(data: bytes, kind: type[Record]) -> Record:
    """Return what `encode_record` wrote.

    Args:
        data: the bytes.
        kind: type of the record, for example ``Frf`` or ``tuple[Hit, ...]``.

    Raises:
        FormatError: the bytes are damaged, or hold something else than `kind`.
    """
    try:
        _require_stored(data)
        with np.load(io.BytesIO(data), allow_pickle=False) as content:
            arrays = {name: content[name] for name in content.files}
        tree = json.loads(arrays.pop(_TEXT).tobytes())
        value = _made(tree, arrays, _known(kind))
        if not _is_a(value, kind):
            raise TypeError(f"no {kind}")
    except _DAMAGE as error:
        raise FormatError(f"a kept stage is damaged ({error})") from error
    return typing.cast(Record, value)


def _require_stored(data: bytes) -> None:
    """Refuse a zip that unpacks to more than it is; `encode_record` packs nothing."""
    with zipfile.ZipFile(io.BytesIO(data)) as packed:
        if any(one.compress_type != zipfile.ZIP_STORED for one in packed.infolist()):
            raise ValueError("it is packed")


def _plain(value: Any, arrays: dict[str, np.ndarray[Any, Any]]) -> Any:
    if isinstance(value, StoredSamples):
        value = np.asarray(value)
    if isinstance(value, np.ndarray):
        name = f"a{len(arrays)}"
        arrays[name] = value
        return {_ARRAY: name}
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, Enum):
        return {_KIND: type(value).__name__, "value": value.value}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, complex):
        return {_COMPLEX: [value.real, value.imag]}
    if is_dataclass(value) and not isinstance(value, type):
        parts = {f.name: _plain(getattr(value, f.name), arrays) for f in fields(value)}
        return {_KIND: type(value).__name__, "fields": parts}
    if isinstance(value, Mapping):
        pairs = [[_plain(k, arrays), _plain(v, arrays)] for k, v in value.items()]
        return {_MAP: pairs}
    if isinstance(value, tuple):
        return [_plain(item, arrays) for item in value]
    if isinstance(value, list):
        return {_LIST: [_plain(item, arrays) for item in value]}
    raise TypeError(f"a {type(value).__name__} cannot be kept")


def _made(
    tree: Any, arrays: Mapping[str, np.ndarray[Any, Any]], known: Mapping[str, type]
) -> Any:
    if isinstance(tree, list):
        return tuple(_made(item, arrays, known) for item in tree)
    if not isinstance(tree, dict):
        return tree
    if _ARRAY in tree:
        return arrays[tree[_ARRAY]]
    if _COMPLEX in tree:
        return complex(*tree[_COMPLEX])
    if _LIST in tree:
        return [_made(item, arrays, known) for item in tree[_LIST]]
    if _MAP in tree:
        return {_made(k, arrays, known): _made(v, arrays, known) for k, v in tree[_MAP]}
    kind = known[tree[_KIND]]
    if "value" in tree:
        return kind(tree["value"])
    parts = tree["fields"]
    return kind(**{name: _made(part, arrays, known) for name, part in parts.items()})


def _is_a(value: Any, kind: Any) -> bool:
    """Return whether a value is of a type, with all that it holds."""
    origin, parts = typing.get_origin(kind) or kind, typing.get_args(kind)
    if origin in {typing.Any, object}:
        return True
    if origin in {typing.Union, types.UnionType}:
        return any(_is_a(value, part) for part in parts)
    if origin is typing.Literal:
        return value in parts
    if origin is float:
        return isinstance(value, float | int) and not isinstance(value, bool)
    if not isinstance(value, origin):
        return False
    if isinstance(value, tuple):
        kinds = parts[:1] * len(value) if parts[1:] == (...,) else parts
        return not parts or (len(kinds) == len(value) and all(map(_is_a, value, kinds)))
    if isinstance(value, Mapping) and parts:
        return all(_is_a(k, parts[0]) and _is_a(v, parts[1]) for k, v in value.items())
    if is_dataclass(value):
        hints = typing.get_type_hints(type(value))
        return all(_is_a(getattr(value, f.name), hints[f.name]) for f in fields(value))
    return True


def _known(kind: Any) -> dict[str, type]:
    """Return the records and enumerations that a type can hold, by their names."""
    found: dict[str, type] = {}
    waiting = [kind]
    while waiting:
        one = waiting.pop()
        waiting += typing.get_args(one)
        if not isinstance(one, type) or one.__name__ in found:
            continue
        if issubclass(one, Enum):
            found[one.__name__] = one
        elif is_dataclass(one):
            found[one.__name__] = one
            waiting += list(typing.get_type_hints(one).values())
    return found
