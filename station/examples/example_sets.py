# SPDX-License-Identifier: MIT
"""Example data sets that come with the program, and how they are written out.

Every set is a folder below `examples` with a README of commands; plans and models that
several sets or the tests use lie beside these folders. The data are made by
`tests/fixtures/make_examples.py`.
"""

import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import named
from jointbench.station.files.output_paths import make_folder

# Both in a source tree and in an installed package, two folders above this one.
FOLDER = Path(__file__).resolve().parents[2] / "examples"
"""Where the example data are."""
_SKIPPED = frozenset({"__pycache__"})


@dataclass(frozen=True, slots=True)
class ExampleSet:
    """A data set with its commands.

    Attributes:
        name: of the set and of its folder.
        summary: what it holds, in one line.
        shared: further files, by their path below `FOLDER`; all go to one folder.
    """

    name: str
    summary: str
    shared: tuple[str, ...] = ()

    def files(self) -> Iterator[tuple[Path, Path]]:
        """Yield each file and where it goes below the folder of the set."""
        own = FOLDER / self.name
        for path in sorted(own.rglob("*")):
            if path.is_file() and not _SKIPPED & set(path.parts):
                yield path, path.relative_to(own)
        for name in self.shared:
            yield FOLDER / name, Path(Path(name).name)


EXAMPLES = (
    ExampleSet(
        "hits",
        "three recorded hammer hits as .csv: a first mode",
    ),
    ExampleSet(
        "joint",
        "a bolted joint: hits, two surfaces and a bench model",
        ("surfaces/face-a.csv", "surfaces/face-b.csv", "archive/narrow.toml"),
    ),
    ExampleSet(
        "surfaces",
        "two profiles and two maps of contact surfaces",
        ("rough_surface.py", "roughness.py"),
    ),
    ExampleSet(
        "plates",
        "two bolted plates: plans, a model of meshed bodies and a short session",
        ("plates.toml", "plates-model.toml", "calibration.toml"),
    ),
    ExampleSet(
        "campaign",
        "hits at levels, points and preloads on a joint that its model lacks",
    ),
    ExampleSet(
        "torques",
        "stiffness and damping of a joint over its preload, as a table",
        ("joint-stiffness.toml", "joint-stiffness.csv"),
    ),
    ExampleSet(
        "loops",
        "loops of force and displacement of a joint, and the program that makes them",
    ),
    ExampleSet(
        "pressed",
        "two plates under four bolts: the pressure between them",
        ("pressed-plates.toml",),
    ),
    ExampleSet("archive", "a year of sessions on one joint, and two recipes"),
    ExampleSet(
        "machine", "a grinder of seven bodies and six joints", ("grinder.toml",)
    ),
)


def example_set(name: str) -> ExampleSet:
    """Return the example of a name.

    Raises:
        UsageError: there is none of that name.
    """
    known = {one.name: one for one in EXAMPLES}
    if name in known:
        return known[name]
    near = get_close_matches(str(name), known, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(known)}"
    raise UsageError(f"no example is called {name!r}; {hint}")


def write_example(
    name: str, folder: Path | None = None, *, overwrite: bool = False
) -> Path:
    """Write an example out to a folder.

    Args:
        name: of the example, see `EXAMPLES`.
        folder: to write to, made if need be; None for the name of the example.
        overwrite: replace files of the same names.

    Returns:
        The folder.

    Raises:
        UsageError: there is no such example, a file is there and `overwrite` is off, or
            the folder cannot be written to.
    """
    files = list(example_set(name).files())
    target = Path(name) if folder is None else folder
    there = [target / place for _, place in files if (target / place).exists()]
    if there and not overwrite:
        raise UsageError(
            f"{named(there[0])} exists already; name another folder with --out, or add "
            "--force to overwrite it"
        )
    for source, place in files:
        make_folder((target / place).parent)
        try:
            shutil.copyfile(source, target / place)
        except OSError as error:
            raise UsageError(
                f"{named(target / place)} cannot be written: {error.strerror}; choose "
                "another folder with --out"
            ) from error
    return target
