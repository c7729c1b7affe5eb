# SPDX-License-Identifier: MIT
"""Registries: what jointbench has built in, and what installed packages add to it.

A package adds to a registry by one entry point in its ``pyproject.toml``::

    [project.entry-points."jointbench.sample_formats"]
    xyz = "lab_formats.xyz:FORMAT"

The built-in records are a table in code, so that a source tree without installed
metadata has them too; entry points are read for other packages alone (record 0063).
"""

import logging
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from hashlib import sha256
from importlib import metadata
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from jointbench.acquisition.basics.errors import JointbenchError, UsageError

logger = logging.getLogger(__name__)

OWN_PACKAGE = "jointbench"
"""Package of the built-in entries."""
_LONGEST = 200
"""Most characters of a foreign error that a message quotes."""


class UnknownEntry(UsageError):
    """A name that no entry of a registry has."""


class PluginFault(UsageError):
    """A package whose entry point cannot be used."""


class Named(Protocol):
    """What an entry of a registry has at least."""

    @property
    def name(self) -> str:
        """Name under which the entry is asked for."""
        ...


Item = TypeVar("Item", bound=Named)


@dataclass(frozen=True, slots=True)
class Entry(Generic[Item]):
    """One entry of a registry.

    Attributes:
        value: the record.
        package: distribution and version that adds it, `OWN_PACKAGE` if built in.
        module: that the record was imported from; empty if built in.
    """

    value: Item
    package: str
    module: str = ""

    @property
    def built_in(self) -> bool:
        """Whether it belongs to jointbench itself."""
        return self.package == OWN_PACKAGE

    @property
    def code(self) -> str:
        """Package, version and SHA-256 of the module that holds the record.

        The key of a result that depends on an entry of another package contains this.
        """
        return f"{self.package} {_source_digest(self.module)}".strip()

    @contextmanager
    def running(self, failure: type[JointbenchError]) -> Iterator[None]:
        """Name the package where code of another package fails in this context.

        Args:
            failure: error that an unexpected exception becomes.

        Raises:
            JointbenchError: of the class `failure`, in one line.
        """
        try:
            yield
        except (JointbenchError, OSError):
            raise
        except Exception as error:
            if self.built_in:
                raise
            raise failure(
                f"{self.value.name!r} of package {self.package} fails "
                f"({_words(error)}); report it to its author, or uninstall it"
            ) from error


@dataclass(frozen=True, slots=True)
class Registry(Generic[Item]):
    """Records of one kind by their names.

    A package that cannot be imported or has the wrong type is left out with a warning
    of one line; asked for by its name, it is an error.

    Attributes:
        group: of the entry points, ``"jointbench.sample_formats"``.
        what: an entry in a message, ``"sample format"``.
        kind: class of the records.
        built_in: returns the records of jointbench itself, in their order.
        fault: returns what is wrong with a record of another package, or an empty
            text.
    """

    group: str
    what: str
    kind: type[Item]
    built_in: Callable[[], Iterable[Item]]
    fault: Callable[[Item], str] = lambda item: ""

    def names(self) -> tuple[str, ...]:
        """Return all names, built-in ones first; nothing foreign is imported.

        Raises:
            UsageError: two packages add the same name.
        """
        own = tuple(item.name for item in self.built_in())
        return own + tuple(point.name for point in self._points())

    def entries(self) -> tuple[Entry[Item], ...]:
        """Return all entries: built-in first, then by package and name.

        A package that cannot be used is left out; a warning names it once.

        Raises:
            UsageError: two packages add the same name.
        """
        own = tuple(Entry(item, OWN_PACKAGE) for item in self.built_in())
        found = []
        for point in self._points():
            try:
                found.append(self._entry(point))
            except PluginFault as error:
                warn_once(str(error))
        return own + tuple(found)

    def entry(self, name: str) -> Entry[Item]:
        """Return the entry of a name.

        Raises:
            UnknownEntry: there is none; the message has near matches.
            PluginFault: the package that adds it cannot be used.
            UsageError: two packages add the same name.
        """
        for item in self.built_in():
            if item.name == name:
                self._points()
                return Entry(item, OWN_PACKAGE)
        for point in self._points():
            if point.name == name:
                return self._entry(point)
        raise UnknownEntry(unknown_words(name, self.what, self.names()))

    def _points(self) -> tuple["_OutsidePoint", ...]:
        """Return the entry points of other packages, after a check of their names."""
        points = _outside(self.group, tuple(sys.path))
        packages = {item.name: OWN_PACKAGE for item in self.built_in()}
        for point in points:
            if point.name in packages:
                raise UsageError(
                    f"{packages[point.name]} and {point.package} both add the "
                    f"{self.what} {point.name!r}; a name must be unique: uninstall "
                    "one, or rename it"
                )
            packages[point.name] = point.package
        return points

    def _entry(self, point: "_OutsidePoint") -> Entry[Item]:
        value = _loaded(point)
        if not isinstance(value, self.kind):
            raise PluginFault(
                f"package {point.package}: {point.value} has the type "
                f"{type(value).__name__}, a {self.what} must have the type "
                f"{self.kind.__name__}; {_WAY_OUT}"
            )
        if value.name != point.name:
            raise PluginFault(
                f"package {point.package}: the {self.what} of {point.value} is named "
                f"{value.name!r}, its entry point {point.name!r}; both must be the "
                f"same; {_WAY_OUT}"
            )
        if fault := self._fault_of(value):
            raise PluginFault(
                f"package {point.package}, {self.what} {point.name!r}: {fault}; "
                f"{_WAY_OUT}"
            )
        return Entry(value, point.package, point.value.partition(":")[0].strip())

    def _fault_of(self, value: Item) -> str:
        """Return what is wrong with a record; what its own code raises counts."""
        try:
            return self.fault(value)
        except JointbenchError as error:
            return str(error)
        except Exception as error:  # noqa: BLE001 - whatever foreign code makes of it
            return _words(error)


def added_names(group: str) -> tuple[str, ...]:
    """Return the names that other packages add to a group, by package and name.

    Nothing is imported, not even the built-in table: this serves the help.

    Args:
        group: of the entry points.
    """
    return tuple(point.name for point in _outside(group, tuple(sys.path)))


def unknown_words(name: str, what: str, known: Iterable[str]) -> str:
    """Return the message for a name that is not known, with a near match."""
    names = tuple(known)
    near = get_close_matches(name, names, n=1)
    hint = f"; did you mean {near[0]!r}?" if near else ""
    return f"{name!r} is no {what}; there are {', '.join(names)}{hint}"


@dataclass(frozen=True, slots=True, order=True)
class _OutsidePoint:
    """An entry point of another package; sorted by package and name."""

    package: str
    name: str
    value: str
    group: str


_WAY_OUT = "correct or uninstall that package"


@cache
def _outside(group: str, path: tuple[str, ...]) -> tuple[_OutsidePoint, ...]:
    """Return the entry points of a group that are installed along `sys.path`.

    Args:
        group: of the entry points.
        path: where packages are looked for, `sys.path`.
    """
    seen: set[str] = set()
    points: list[_OutsidePoint] = []
    for distribution in metadata.distributions(path=list(path)):
        try:
            found = distribution.entry_points.select(group=group)
        except Exception as error:  # noqa: BLE001 - whatever its file makes of it
            warn_once(
                f"the entry points of {_package(distribution)} cannot be read "
                f"({_words(error)}); {_WAY_OUT}"
            )
            continue
        if not found:  # its name takes longer to read than its entry points
            continue
        package = _package(distribution)
        name = re.sub(r"[-_.]+", "-", package.rpartition(" ")[0]).lower()
        # Of two copies of a package Python imports the first on the path.
        if name not in seen:
            seen.add(name)
            points += [_OutsidePoint(package, p.name, p.value, group) for p in found]
    return tuple(sorted(points))


def _package(distribution: metadata.Distribution) -> str:
    """Return name and version of a distribution."""
    facts = distribution.metadata
    return f"{facts['Name'] or 'unnamed'} {facts['Version'] or '?'}"


@cache
def _loaded(point: _OutsidePoint) -> object:
    """Import what an entry point names.

    Raises:
        PluginFault: the import fails, for whatever reason.
    """
    try:
        return metadata.EntryPoint(point.name, point.value, point.group).load()
    except (Exception, SystemExit) as error:
        raise PluginFault(
            f"package {point.package}: the entry point {point.name!r} of "
            f"{point.group} cannot be loaded ({_words(error)}); {_WAY_OUT}"
        ) from error


@cache
def _source_digest(module: str) -> str:
    """Return the SHA-256 of the file of an imported module; empty without a file.

    It is taken once: a file that changes later is not the code that runs.
    """
    file = getattr(sys.modules.get(module), "__file__", None)
    if not file or not Path(file).is_file():
        return ""
    return sha256(Path(file).read_bytes()).hexdigest()


@cache
def warn_once(message: str) -> None:
    """Report once in a process what is left out."""
    logger.warning("jointbench: warning: %s; jointbench continues without it", message)


def _words(error: BaseException) -> str:
    """Return kind and message of a foreign error in one printable line."""
    text = " ".join(f"{type(error).__name__}: {error}".split())[:_LONGEST]
    return "".join(letter if letter.isprintable() else "?" for letter in text)
