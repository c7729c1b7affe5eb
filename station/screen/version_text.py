# SPDX-License-Identifier: MIT
"""The versions of the product, of Python and of the libraries that results rest on."""

import platform
from importlib.metadata import PackageNotFoundError, version

LIBRARIES = ("numpy", "scipy", "h5py", "nidaqmx")
_MISSING = "not installed"


def version_text() -> str:
    """Return one line for each; no library is imported."""
    versions = {
        "jointbench": _version("jointbench"),
        "python": platform.python_version(),
        **{name: _version(name) for name in LIBRARIES},
    }
    width = max(map(len, versions))
    return "\n".join(f"{name:{width}}  {text}" for name, text in versions.items())


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return _MISSING
