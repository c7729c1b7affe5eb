# SPDX-License-Identifier: MIT
"""What computed a result: build, versions, kind of computer. No names, no addresses."""

import os
import platform
from collections.abc import Mapping
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

LIBRARIES = ("filterpy", "h5py", "numba", "numpy", "pyuff", "scipy", "threadpoolctl")
"""Whose code computes or reads."""
_ROOMS = ("acquisition", "analysis", "signal", "station")
NOT_INSTALLED = "not installed"


@cache
def computing_environment() -> Mapping[str, str]:
    """Return build, versions and kind of computer, as texts by name.

    Host name, user, paths and environment variables are left out.
    """
    return {
        "jointbench": library_version("jointbench"),
        "build_sha256": _build(),
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        **{name: library_version(name) for name in LIBRARIES},
        "blas": _blas(),
        "system": f"{platform.system()} {platform.release()}",
        "machine": platform.machine(),
        "processors": str(os.cpu_count() or 0),
    }


def library_version(package: str) -> str:
    """Return the version of an installed package, or that it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return NOT_INSTALLED


def _build() -> str:
    """Return the SHA-256 of all modules: two builds of one version can differ."""
    root = Path(__file__).resolve().parents[2]
    digest = sha256()
    for room in _ROOMS:
        for path in sorted((root / room).rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _blas() -> str:
    """Return the linear algebra libraries in use, with their versions."""
    from threadpoolctl import threadpool_info

    found = {
        f"{one['internal_api']} {one['version']}"
        for one in threadpool_info()
        if one["user_api"] == "blas"
    }
    return ", ".join(sorted(found))
