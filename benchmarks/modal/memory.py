# SPDX-License-Identifier: MIT
"""Peak memory of this process from a moment on (Linux only)."""

import re
from pathlib import Path

_STATUS, _RESET = Path("/proc/self/status"), Path("/proc/self/clear_refs")
_KIB = 1024.0


def reset_peak() -> float:
    """Forget the peak so far; return what the process holds now [MiB]."""
    _RESET.write_text("5")
    return _read("VmRSS")


def peak_mib() -> float:
    """Return the peak since the last reset [MiB]."""
    return _read("VmHWM")


def _read(name: str) -> float:
    found = re.search(rf"{name}:\s+(\d+)", _STATUS.read_text())
    return int(found.group(1)) / _KIB if found else float("nan")
