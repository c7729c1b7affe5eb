# SPDX-License-Identifier: MIT
"""Build the sdist, and from it a wheel without an index; compare it with the source.

    python benchmarks/release/sdist_offline.py

The wheel is built in a network namespace of its own, which has no network, where the
system grants one (Linux, ``unshare``); elsewhere pip alone is kept from asking. Needs
pip and setuptools 77 or newer beside the Python that runs it, as the build does.
"""

import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("acquisition", "analysis", "examples", "signal", "simulators", "station")
BUILD = "import setuptools.build_meta as b, sys; b.build_sdist(sys.argv[1])"
NAMESPACES = (["unshare", "--net"], ["unshare", "--net", "--map-root-user"])
PROBE = "import socket; socket.create_connection(('192.0.2.1', 80), 1)"
"""Fails at once without a network: the address belongs to no host."""


def expected() -> set[str]:
    """Return the files that a wheel has to hold: those of git below the rooms."""
    listed = subprocess.run(
        ["git", "ls-files", *ROOMS],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split("\n")
    return {f"jointbench/{name}" for name in listed if name}


def without_network() -> list[str]:
    """Return the words that run a command without a network, none where none can."""
    for words in NAMESPACES if shutil.which("unshare") else ():
        if subprocess.run(
            [*words, "true"], capture_output=True, check=False
        ).returncode:
            continue
        tried = [*words, sys.executable, "-c", PROBE]
        said = subprocess.run(tried, capture_output=True, text=True, check=False).stderr
        if "unreachable" in said:
            return words
    return []


def main() -> int:
    """Build and compare; return 1 where a file is missing."""
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        subprocess.run(
            ["git", "clone", "--quiet", str(ROOT), str(place / "clone")], check=True
        )
        command = [sys.executable, "-c", BUILD, str(place)]
        subprocess.run(
            command, cwd=place / "clone", check=True, stdout=subprocess.DEVNULL
        )
        (sdist,) = place.glob("*.tar.gz")
        with tarfile.open(sdist) as archive:
            archive.extractall(place / "unpacked", filter="data")
        (source,) = (place / "unpacked").iterdir()
        offline = os.environ | {
            "PIP_NO_INDEX": "1",
            "PIP_DISABLE_PIP_VERSION_CHECK": "1",
        }
        pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps"]
        words = [*pip, "--no-build-isolation", "-w", str(place / "wheels"), str(source)]
        cut_off = without_network()
        subprocess.run([*cut_off, *words], env=offline, check=True)
        (wheel,) = (place / "wheels").glob("*.whl")
        names = set(zipfile.ZipFile(wheel).namelist())
        sizes = sdist.stat().st_size, wheel.stat().st_size
    missing = sorted(expected() - names)
    print(f"network: {'none' if cut_off else 'not asked by pip'}")
    print(f"sdist {sizes[0] / 1e6:.1f} MB, wheel {sizes[1] / 1e6:.1f} MB")
    print(f"{len(names)} files in the wheel, {len(missing)} missing")
    print("\n".join(missing))
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
