# SPDX-License-Identifier: MIT
"""Reads mutated surface files: each is read or refused in one line, and quickly.

python benchmarks/surface/hostile.py --files 2000 prints a table for docs/surface.md.
"""

import argparse
import codecs
import random
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.acquisition.formats.heights.height_facts import cautions
from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.simulators.rough_surfaces.rough_surface import rough_map, rough_profile
from jointbench.simulators.rough_surfaces.surface_files import (
    ENCODINGS,
    write_dektak,
    write_keyence_csv,
    write_surfcom,
    write_utf16_table,
    write_wyko,
)

SLOW = 5.0  # [s]
SIDE = 16  # points of a line of the map [-]
COLUMNS = {".xyz": "x:um,y:um,z:um"}
HOSTILE = (b"1e999", b"nan", b"Bad", b"-25400", b"\x00", b"9" * 400, b"=1+1", b"'", b"")


def originals(folder: Path) -> list[Path]:
    """Write one whole file of each format."""
    areal = rough_map(24, SIDE, spacing=0.25e-6, dimension=1.5, roughness=1e-9, seed=1)
    line = rough_profile(300, spacing=0.2e-6, dimension=1.5, roughness=1e-9, seed=1)
    paths = []
    for language in ENCODINGS:
        paths.append(folder / f"{language}.csv")
        write_keyence_csv(areal, paths[-1], language=language)
    paths += [folder / name for name in ("d.csv", "s.tx1", "u.txt", "w.asc", "g.xyz")]
    write_dektak(line, paths[-5], stylus_radius=2e-6)
    write_surfcom(line, paths[-4])
    write_utf16_table(line, paths[-3])
    write_wyko(areal, paths[-2])
    heights = 1e6 * areal.heights.ravel()
    points = [f"{i % SIDE},{i // SIDE},{z:.5f}" for i, z in enumerate(heights)]
    paths[-1].write_text("\n".join(points))
    return paths


def truncated(data: bytes, draw: random.Random) -> bytes:
    """Cut the file anywhere."""
    return data[: draw.randrange(len(data))]


def reordered(data: bytes, draw: random.Random) -> bytes:
    """Swap two lines."""
    lines = data.split(b"\n")
    i, j = draw.randrange(len(lines)), draw.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return b"\n".join(lines)


def decimals(data: bytes, draw: random.Random) -> bytes:
    """Turn some points of numbers into commas, or lose them."""
    places = [i for i, value in enumerate(data) if value == ord(".")]
    for place in sorted(draw.sample(places, draw.randint(1, 4)), reverse=True):
        data = data[:place] + draw.choice([b",", b""]) + data[place + 1 :]
    return data


def counts(data: bytes, draw: random.Random) -> bytes:
    """Make a number of the header huge."""
    head = data[:1500]
    starts = [i for i, value in enumerate(head) if 48 <= value <= 57]
    place = draw.choice(starts)
    return data[:place] + draw.choice([b"9" * 12, b"-1", b"1e12", b"0"]) + data[place:]


def cells(data: bytes, draw: random.Random) -> bytes:
    """Put something else where a stretch of the file was."""
    place = draw.randrange(len(data))
    return data[:place] + draw.choice(HOSTILE) + data[place + draw.randint(0, 8) :]


MUTATIONS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    truncated,
    reordered,
    decimals,
    counts,
    cells,
)


def whole_lines(source: bytes, cut: bytes) -> bool:
    """Return whether what is left of a file is whole lines, and whole lines of a map.

    Nothing in such a file differs from a shorter measurement.
    """
    wide = source.startswith(codecs.BOM_UTF16_LE)
    if len(cut) >= len(source) or source[: len(cut)] != cut or (wide and len(cut) % 2):
        return False
    encoding = "utf-16-le" if wide else "latin-1"
    text, left = (
        one.decode(encoding).replace("\r\n", "\n") for one in (cut, source[len(cut) :])
    )
    if not (text.endswith("\n") or left.startswith("\n")):
        return False
    last = text.rstrip("\n").rpartition("\n")[2].split(",")
    rows = text.rstrip("\n").count("\n") + 1
    # Points of the map, see `originals`: its first line alone is a profile.
    return wide or rows <= SIDE or int(last[0]) == SIDE - 1


def outcome(path: Path, whole: np.ndarray, source: bytes = b"") -> str:
    """Read a file and say in a word what came of it."""
    started = time.perf_counter()
    try:
        surface = read_surface(path, columns=COLUMNS.get(path.suffix))
    except JointbenchError as error:
        word = "refused" if "\n" not in str(error) else "refused in many lines"
    except Exception as error:  # noqa: BLE001 - this is what is looked for
        word = f"traceback: {type(error).__name__}: {error}"
    else:
        same = surface.heights.shape == whole.shape
        equal = same and np.array_equal(surface.heights, whole)
        word = "read, heights as before" if equal else "read as it now stands"
        shorter = surface.heights.size < whole.size
        if shorter and not cautions(surface.provenance):
            word = f"shorter, without a caution ({path.suffix})"
            if whole_lines(source, path.read_bytes()):
                word = f"shorter by whole lines, which leaves no trace ({path.suffix})"
    return "slow" if time.perf_counter() - started > SLOW else word


def main() -> None:
    """Mutate, read and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--files", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=5)
    asked = parser.parse_args()
    draw = random.Random(asked.seed)
    found: dict[str, Counter[str]] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sources = originals(folder)
        wholes = [read_surface(p, columns=COLUMNS.get(p.suffix)) for p in sources]
        for k in range(asked.files):
            source = sources[k % len(sources)]
            mutate = MUTATIONS[(k // len(sources)) % len(MUTATIONS)]
            target = folder / f"mutated{source.suffix}"
            target.write_bytes(mutate(source.read_bytes(), draw))
            whole = wholes[k % len(sources)].heights
            word = outcome(target, whole, source.read_bytes())
            found.setdefault(mutate.__name__, Counter())[word] += 1
    print("| mutation | outcome | files |\n|---|---|---|")
    for name, counted in found.items():
        for word, count in sorted(counted.items()):
            print(f"| {name} | {word} | {count} |")


if __name__ == "__main__":
    main()
