# SPDX-License-Identifier: MIT
"""Functions compiled by numba, cached on disk until any of their sources changes.

Functions called by a compiled function are compiled into it, and constants are included
as numbers, from any file. Numba's cache checks only the file of the function itself
(numba issue 1833), so that after an edit of another file it would run the old code.
"""

import ast
import hashlib
import importlib.util
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from numba import njit
from numba.core.caching import FunctionCache, IndexDataCacheFile

F = TypeVar("F", bound=Callable[..., Any])
COMPILING = (
    "compiling the models: 10 to 20 s, once; later runs load them from the cache"
)
_LISTENERS: list[Callable[[str], None]] = []


@contextmanager
def announced(listener: Callable[[str], None]) -> Iterator[None]:
    """Report to a listener, once, when a function has to be compiled first.

    Args:
        listener: receives one line before the compilation begins.
    """
    _LISTENERS.append(listener)
    try:
        yield
    finally:
        if listener in _LISTENERS:
            _LISTENERS.remove(listener)


def _announce() -> None:
    """Report to every listener, to none of them twice."""
    while _LISTENERS:
        _LISTENERS.pop()(COMPILING)


def compiled(**options: Any) -> Callable[[F], F]:
    """Compile a function as `numba.njit`, with a cache that checks all sources.

    Args:
        options: of `numba.njit`, but for ``cache``.

    Source:
        https://numba.readthedocs.io/en/stable/developer/caching.html
    """

    def decorate(function: F) -> F:
        # A wrapper for callers in C, of which there are none, is a tenth of the
        # compilation.
        flags: dict[str, Any] = {"no_cfunc_wrapper": True, **options}
        dispatcher: Any = njit(**flags)(function)
        # As in `enable_caching`, which supports one kind of cache only.
        dispatcher._cache = _Cache(function)  # noqa: SLF001
        made: F = dispatcher
        return made

    return decorate


class _Cache(FunctionCache):
    """Numba's cache of a function, stamped with all its sources."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        self._cache_file = IndexDataCacheFile(  # type: ignore[no-untyped-call]
            cache_path=self._cache_path,
            filename_base=self._impl.filename_base,
            source_stamp=digest_of(function.__module__),
        )

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load a compiled function; announce the compilation if there is none."""
        found = super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        if found is None:
            _announce()
        return found


@cache
def digest_of(module: str) -> str:
    """Return a digest of a module's source and of its imports from its package.

    Args:
        module: name of the module, imported or not.
    """
    content = hashlib.sha256()
    for name, path in sorted(_sources(module).items()):
        content.update(name.encode())
        content.update(path.read_bytes())
    return content.hexdigest()


def _sources(module: str) -> dict[str, Path]:
    """Return the files of a module and of its imports from its package, by name."""
    package = module.partition(".")[0]
    found: dict[str, Path] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        path = None if name in found else _file_of(name)
        if path is not None:
            found[name] = path
            waiting += [n for n in _imported(path) if n.partition(".")[0] == package]
    return found


def _file_of(module: str) -> Path | None:
    """Return the file of a module; None for a name inside one, and for a package."""
    try:
        spec = importlib.util.find_spec(module)
    except (ModuleNotFoundError, ValueError):
        return None
    if spec is None or spec.origin is None or not Path(spec.origin).is_file():
        return None
    return Path(spec.origin)


@cache
def _imported(path: Path) -> tuple[str, ...]:
    """Return the absolute imports of a file, modules and names in them."""
    names: list[str] = []
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names.append(node.module)
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    return tuple(names)
