# SPDX-License-Identifier: MIT
"""Check foreign HDF5 files before a sample is read.

HDF5 can refer to other files, claim sizes beyond its content, and unpack a few bytes
into gigabytes. A measurement needs none of that, so it is refused, with a reason,
before any value is read and without following any link.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import h5py
from h5py import h5a, h5d, h5g, h5o, h5t, h5z

from jointbench.acquisition.basics.errors import BadData, FormatError, HostileFile
from jointbench.acquisition.file_access.followed_files import require_not_followed
from jointbench.acquisition.file_access.memory_room import VARIABLE, room
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_size

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_FILTERS = {
    h5z.FILTER_DEFLATE: "gzip",
    h5z.FILTER_SHUFFLE: "shuffle",
    h5z.FILTER_FLETCHER32: "fletcher32",
}
_DOUBLE, _TEXT = 8, 100  # size of a number, and overhead of a text
_NUMBERS = {h5t.INTEGER, h5t.FLOAT, h5t.ENUM, h5t.STRING}
# Attributes that link dimension scales; they are not read here.
_SCALE_ATTRIBUTES = {b"DIMENSION_LIST", b"REFERENCE_LIST"}
# Size of HDF5's cache of indices and headers [bytes]. It counts them as stored, in
# memory they take ten times as much; by default it grows to 32 MB.
_METADATA = 2**19
_USER_BLOCK = 512  # bytes that MATLAB writes before the signature
_COMPLEX = ((b"real", b"imag"), (b"r", b"i"))
_PAIR = 2
_FIELD_NAMES = b"MATLAB_fields"


@dataclass(frozen=True, slots=True)
class FileLimits:
    """Limits of a measurement file.

    Attributes:
        objects: groups and datasets in a file.
        depth: groups inside each other.
        attributes: of one object.
        all_attributes: of all objects; each takes 25 us to look at.
        attribute_bytes: of one attribute [bytes].
        dimensions: axes of a dataset.
        chunks: pieces that a file is stored in; HDF5 takes 4 kB of memory for each.
        chunk_bytes: least size of a chunk in the file [bytes]; above zero, a file that
            is large enough may have more than `chunks`.
        unpacked_bytes: of all values [bytes], counted as doubles, and 100 bytes per
            text.
        always_bytes: unpacked size that any file may have [bytes].
        unpacked_ratio: unpacked size of all values over the size of the file, above
            `always_bytes` [-]. Measured samples compress by 2 to 10.
        variable_texts: texts of variable length in one row that a dataset may hold;
            a caller that allows some must read them one by one and check their length.
        matlab: whether the features of a MAT file of version 7.3 are allowed: 512 bytes
            before the signature, complex numbers as pairs, references to objects of
            the same file, and field names as attributes (which are not read).
        complex_pairs: whether complex numbers as pairs are allowed, and their type as
            an object of the file, as netCDF has them.
        in_parts: end of the names of datasets that are unpacked chunk by chunk; of
            these a chunk counts, and all together by `unpacked_ratio`. Empty for none.
    """

    objects: int = 20_000
    depth: int = 16
    attributes: int = 256
    all_attributes: int = 200_000
    attribute_bytes: int = 65_536
    dimensions: int = 8
    chunks: int = 60_000
    chunk_bytes: int = 0
    unpacked_bytes: int = 8 * 2**30
    always_bytes: int = 64 * 2**20
    unpacked_ratio: float = 64.0
    variable_texts: int = 0
    matlab: bool = False
    in_parts: str = ""
    complex_pairs: bool = False


@dataclass(slots=True)
class _Tally:
    """Totals of the objects checked so far."""

    path: Path
    limits: FileLimits
    file_bytes: int
    objects: int = 0
    chunks: int = 0
    attributes: int = 0
    unpacked: int = 0
    parts: int = 0
    groups: set[int] = field(default_factory=set)

    def refuse(self, name: str, rule: str) -> HostileFile:
        return HostileFile(
            f"{named(self.path)}: {shown(name)} {rule}; it was refused unread: "
            "request a plain copy of the file"
        )


@contextmanager
def open_guarded(
    path: Path | str, *, limits: FileLimits | None = None
) -> Iterator[h5py.File]:
    """Open an HDF5 file for reading after a check for harmful content.

    Args:
        path: of the file.
        limits: limits; None for those of any measurement.

    Yields:
        The open file.

    Raises:
        BadData: it cannot be opened.
        FormatError: it is empty, truncated or no HDF5.
        HostileFile: it refers to other files or exceeds the limits; the message names
            the object and the rule.
        UsageError: it is a recording that this process follows.
    """
    path = Path(path)
    require_not_followed(path)
    limits = limits or FileLimits()
    _require_signature(path, _USER_BLOCK if limits.matlab else 0)
    try:
        file = _open(path)
    except (OSError, RuntimeError, ValueError) as error:
        raise FormatError(
            f"{named(path)} cannot be opened as HDF5 ({shown(error)}); it is cut short "
            "or was not closed: use another copy"
        ) from error
    with file:
        _inspect(file, path, limits)
        yield file


def _open(path: Path) -> h5py.File:
    """Open a file, also one of a killed recording."""
    try:
        file = h5py.File(path, "r")
    except OSError:
        file = h5py.File(path, "r", libver="latest", swmr=True)
    settings = file.id.get_mdc_config()
    settings.set_initial_size = True
    settings.initial_size = settings.min_size = settings.max_size = _METADATA
    file.id.set_mdc_config(settings)
    return file


def _require_signature(path: Path, user_block: int) -> None:
    if file_size(path) == 0:
        raise FormatError(f"{named(path)} is empty; nothing was written to it")
    try:
        with path.open("rb") as file:
            head = file.read(user_block + len(_SIGNATURE))
    except OSError as error:
        raise BadData(f"{named(path)} cannot be read: {error.strerror}") from error
    if not head.startswith(_SIGNATURE) and head[user_block:] != _SIGNATURE:
        raise FormatError(
            f"{named(path)} is no HDF5 file; text and .npy are read with --columns"
        )


def _inspect(file: h5py.File, path: Path, limits: FileLimits) -> None:
    """Check all objects by their links, without following these."""
    tally = _Tally(path, limits, file_size(path))
    try:
        _walk(file, tally)
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        raise FormatError(
            f"{named(path)} is damaged inside ({shown(error)}); use another copy"
        ) from error


def _walk(file: h5py.File, tally: _Tally) -> None:
    waiting = [(file.id, "/", 0)]
    tally.groups.add(_address(file.id, b"."))
    _check_attributes(h5g.open(file.id, b"/"), "/", tally)
    while waiting:
        group, name, depth = waiting.pop()
        opened = h5g.open(group, name.encode("utf-8", "surrogateescape"))
        # The number of entries is read first: listing millions takes too long.
        tally.objects += opened.get_num_objs()
        if tally.objects > tally.limits.objects:
            raise tally.refuse(
                name,
                f"brings the file to {tally.objects} objects, at most "
                f"{tally.limits.objects} are read",
            )
        for entry in list(opened):
            child = f"{name.rstrip('/')}/{entry.decode('utf-8', 'surrogateescape')}"
            if _check_entry(opened, entry, child, tally):
                if depth >= tally.limits.depth:
                    raise tally.refuse(child, "is nested deeper than any session")
                waiting.append((group, child, depth + 1))


def _address(place: h5g.GroupID, name: bytes) -> int:
    return int(h5o.get_info(place, name).addr)


def _check_entry(group: h5g.GroupID, entry: bytes, name: str, tally: _Tally) -> bool:
    """Check one entry of a group; True if it is a group to walk into."""
    kind = group.links.get_info(entry).type
    if kind != h5py.h5l.TYPE_HARD:
        what = {
            h5py.h5l.TYPE_SOFT: "a soft link",
            h5py.h5l.TYPE_EXTERNAL: "a link to another file",
        }.get(kind, "a link of an unknown kind")
        raise tally.refuse(name, f"is {what}, links are not followed")
    info = h5o.get_info(group, entry)
    opened = h5o.open(group, entry)
    if info.type == h5o.TYPE_GROUP:
        if int(info.addr) in tally.groups:
            raise tally.refuse(name, "leads back to a group that was met already")
        tally.groups.add(int(info.addr))
    elif info.type == h5o.TYPE_DATASET:
        _check_dataset(opened, name, tally)
    elif info.type == h5o.TYPE_NAMED_DATATYPE and tally.limits.complex_pairs:
        if not _is_complex(opened):
            raise tally.refuse(name, "is a type other than that of complex numbers")
    else:
        raise tally.refuse(name, "is neither a group nor a dataset")
    _check_attributes(opened, name, tally)
    return bool(info.type == h5o.TYPE_GROUP)


def _check_dataset(dataset: h5d.DatasetID, name: str, tally: _Tally) -> None:
    properties = dataset.get_create_plist()
    if properties.get_layout() == h5d.VIRTUAL:
        raise tally.refuse(name, "is a virtual dataset made of other files")
    if properties.get_external_count():
        raise tally.refuse(name, "keeps its values in another file")
    _check_filters(properties, name, tally)
    kind = dataset.get_type()
    variable = isinstance(kind, h5t.TypeStringID) and kind.is_variable_str()
    if variable and len(dataset.shape) == 1:
        variable = dataset.shape[0] > tally.limits.variable_texts
    pairs = tally.limits.matlab or tally.limits.complex_pairs
    allowed = (
        kind.get_class() in _NUMBERS
        or (pairs and _is_complex(kind))
        or (tally.limits.matlab and kind.equal(h5t.STD_REF_OBJ))
    )
    if not allowed or variable:
        raise tally.refuse(
            name, "holds neither numbers nor texts of fixed length (variable, compound)"
        )
    if dataset.get_space().get_simple_extent_type() == h5py.h5s.NULL:
        raise tally.refuse(name, "has no extent")
    _check_size(dataset, properties, name, tally)


def _is_complex(kind: h5t.TypeID) -> bool:
    """Return whether a type is a pair of numbers, real and imaginary part."""
    if not isinstance(kind, h5t.TypeCompoundID) or kind.get_nmembers() != _PAIR:
        return False
    members = range(_PAIR)
    return tuple(map(kind.get_member_name, members)) in _COMPLEX and all(
        kind.get_member_type(i).get_class() == h5t.FLOAT for i in members
    )


def _check_filters(properties: h5py.h5p.PropDCID, name: str, tally: _Tally) -> None:
    codes = [properties.get_filter(i)[0] for i in range(properties.get_nfilters())]
    for code in codes:
        if code not in _FILTERS:
            raise tally.refuse(
                name,
                f"is packed by filter {code}, only {', '.join(_FILTERS.values())} are "
                "read",
            )
    if len(set(codes)) != len(codes):
        raise tally.refuse(name, "is packed by the same filter more than once")


def _check_size(
    dataset: h5d.DatasetID,
    properties: h5py.h5p.PropDCID,
    name: str,
    tally: _Tally,
) -> None:
    """Add the unpacked size, in whole chunks."""
    shape, limits = dataset.shape, tally.limits
    if len(shape) > limits.dimensions:
        raise tally.refuse(name, f"has {len(shape)} dimensions")
    values, kind = math.prod(shape), dataset.get_type()
    if properties.get_layout() == h5d.CHUNKED:
        chunk = properties.get_chunk()
        pieces = math.prod(-(-n // c) for n, c in zip(shape, chunk, strict=True))
        tally.chunks += pieces
        values = max(values, pieces * math.prod(chunk) if pieces else 0)
    if limits.in_parts and name.endswith(limits.in_parts):
        tally.parts += values * max(_DOUBLE, kind.get_size())
        whole = max(limits.always_bytes, limits.unpacked_ratio * tally.file_bytes)
        if tally.parts > min(whole, limits.unpacked_bytes):
            words = f"brings the file to {tally.parts} bytes of values"
            raise tally.refuse(name, words)
        chunked = properties.get_layout() == h5d.CHUNKED
        values = math.prod(properties.get_chunk()) if chunked else 0
    if isinstance(kind, h5t.TypeStringID):
        tally.unpacked += values * kind.get_size() + _TEXT * math.prod(shape[:-1])
    else:
        tally.unpacked += values * max(_DOUBLE, kind.get_size())
    stored = tally.file_bytes // limits.chunk_bytes if limits.chunk_bytes else 0
    if tally.chunks > max(limits.chunks, stored):
        raise tally.refuse(name, f"brings the file to {tally.chunks} chunks")
    allowed = max(limits.always_bytes, limits.unpacked_ratio * tally.file_bytes)
    # Values are copied once more for checks, and single precision becomes double.
    allowed = min(allowed, 0.7 * room(tally.file_bytes), limits.unpacked_bytes)
    if tally.unpacked > allowed:
        raise tally.refuse(
            name,
            f"of shape {shape} brings {tally.file_bytes} bytes of file to "
            f"{tally.unpacked} bytes of values ({VARIABLE} allows more)",
        )


def _check_attributes(
    target: h5g.GroupID | h5d.DatasetID, name: str, tally: _Tally
) -> None:
    count = h5a.get_num_attrs(target)
    tally.attributes += count
    if count > tally.limits.attributes:
        raise tally.refuse(name, f"has {count} attributes")
    if tally.attributes > tally.limits.all_attributes:
        raise tally.refuse(name, f"brings the file to {tally.attributes} attributes")
    for i in range(count):
        attribute = h5a.open(target, index=i)
        # Asked once: each answer makes an object of HDF5.
        own = attribute.name
        if own in _SCALE_ATTRIBUTES or (tally.limits.matlab and own == _FIELD_NAMES):
            continue
        kind, values = attribute.get_type(), math.prod(attribute.shape or (1,))
        size = values * kind.get_size()
        text = isinstance(kind, h5t.TypeStringID)
        if kind.get_class() not in _NUMBERS or (
            text and values > 1 and kind.is_variable_str()
        ):
            raise tally.refuse(
                f"{name}@{own.decode('utf-8', 'replace')}",
                "is an attribute of neither numbers nor text",
            )
        if size > tally.limits.attribute_bytes:
            raise tally.refuse(
                f"{name}@{own.decode('utf-8', 'replace')}",
                f"is an attribute of {size} bytes",
            )
