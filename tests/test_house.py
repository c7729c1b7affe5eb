"""The house itself: packaging, the direction of imports, what starting up costs."""

import ast
import graphlib
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from jointbench.station.main import app

ROOT = Path(__file__).parents[1]
ROOMS = ("acquisition", "signal", "analysis", "simulators", "station")
MAY_IMPORT = {
    "acquisition": set(),
    "signal": {"acquisition"},
    "analysis": {"acquisition", "signal"},
    "simulators": {"acquisition"},
    "station": {"acquisition", "signal", "analysis", "simulators"},
}
ONE_HOME = {"filterpy", "nidaqmx", "serial"}
# The simulated chassis answers in NI's own protocol, which the client package ships;
# errors are sorted by the names that the package gives them.
SECOND_HOMES = {
    "nidaqmx": {"simulators/chassis/protocol.py", "acquisition/ni/error_codes.py"}
}
NOT_AT_START = (
    "scipy",
    "numba",
    "matplotlib",
    "filterpy",
    "grpc",
    "h5py",
    "pydantic",
)


MOST_PARAMETERS = 8
MOST_MODULES = 25
MOST_NAMES = 8
MOST_LARGE_VOCABULARIES = 19


def sources(room: str) -> list[Path]:
    """Return the modules of a room."""
    return sorted((ROOT / room).rglob("*.py"))


@dataclass(frozen=True, slots=True)
class Outline:
    """What the tests look at in a module; its syntax tree is walked once.

    Attributes:
        imported: absolute names that it imports anywhere.
        members: names that it imports from each of them, with the module in front.
        classes: that it defines anywhere.
        parameters: how many a function declares, starred ones included, by its name.
        names: that stand in an expression or get a value anywhere.
        assigned: constants at the top, one for each assignment.
        defined: functions and classes at the top.
    """

    imported: frozenset[str]
    members: frozenset[str]
    classes: frozenset[str]
    parameters: tuple[tuple[str, int], ...]
    names: frozenset[str]
    assigned: tuple[str, ...]
    defined: frozenset[str]


@cache
def outline(path: Path) -> Outline:
    """Return the outline of a module."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    imported_, members, classes, names = set(), set(), set(), set()
    parameters = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            names.add(node.id)
        elif isinstance(node, ast.Import):
            imported_ |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            imported_.add(node.module)
            members |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            parameters.append((node.name, parameters_of(node)))
        elif isinstance(node, ast.ClassDef):
            classes.add(node.name)
    tops = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return Outline(
        frozenset(imported_),
        frozenset(members),
        frozenset(classes),
        tuple(parameters),
        frozenset(names),
        tuple(name for node in tree.body for name in assigned(node)),
        frozenset(node.name for node in tree.body if isinstance(node, tops)),
    )


def imported(path: Path) -> frozenset[str]:
    """Return the absolute names that a module imports anywhere."""
    return outline(path).imported


def modules() -> dict[str, Path]:
    """Return every product module by its full name, each package by its folder's."""
    paths = [path.relative_to(ROOT) for room in ROOMS for path in sources(room)]
    named = {".".join(["jointbench", *p.with_suffix("").parts]): p for p in paths}
    return {name.removesuffix(".__init__"): ROOT / p for name, p in named.items()}


def imported_modules(path: Path, known: Collection[str]) -> set[str]:
    """Return the product modules that a module imports anywhere, functions included.

    `from package import name` may mean a module of the package or a name in it, so
    both are looked up; importing a module also imports the packages that hold it.
    """
    names = outline(path).imported | outline(path).members
    parts = [name.split(".") for name in names]
    holders = {".".join(p[:k]) for p in parts for k in range(1, len(p) + 1)}
    return holders & set(known)


def reached(start: str, known: Mapping[str, Path]) -> set[str]:
    """Return the modules that importing `start` and calling all of it may import."""
    found, open_ = {start}, [start]
    while open_:
        new = imported_modules(known[open_.pop()], known) - found
        found |= new
        open_ += new
    return found


def rooms_of(names: Collection[str]) -> set[str]:
    """Return the rooms among imported names."""
    return {n.split(".")[1] for n in names if n.startswith("jointbench.")}


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_holds_no_init_and_is_typed(room: str) -> None:
    """An `__init__.py` would shadow the standard library's `signal`."""
    assert not (ROOT / room / "__init__.py").exists()
    assert (ROOT / room / "py.typed").exists()


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_imports_only_what_stands_to_its_left(room: str) -> None:
    """Acquisition, signal, analysis, station; simulators know acquisition alone."""
    modules = sources(room)
    assert modules
    for path in modules:
        foreign = rooms_of(imported(path)) - {room}
        assert foreign <= MAY_IMPORT[room], f"{path.name} imports {foreign}"


def test_every_product_module_is_reached_from_the_command_line() -> None:
    """What no command imports is not in use: it needs an option, or goes to tests.

    The functions of the library are reached from ``import jointbench``.
    """
    known = modules() | {"jointbench": ROOT / "library" / "__init__.py"}
    doors = ("jointbench", "jointbench.station.main")
    unreached = set(known) - set().union(*(reached(door, known) for door in doors))
    assert not unreached, sorted(unreached)


def dotted(path: Path) -> str:
    """Return the dotted name under which a module is imported."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(("jointbench", *parts))


@pytest.mark.parametrize("room", ROOMS)
def test_no_modules_import_each_other_in_a_circle(room: str) -> None:
    """Imports for type checkers alone and inside functions count as well."""
    graph = {dotted(path): imported(path) for path in sources(room)}
    known = {module: names & graph.keys() for module, names in graph.items()}
    graphlib.TopologicalSorter(known).prepare()


@pytest.mark.parametrize("package", sorted(ONE_HOME))
def test_a_heavy_dependency_has_at_most_one_home(package: str) -> None:
    """Filterpy, nidaqmx and pyserial are each imported by one module at the most."""
    homes = [
        path
        for room in ROOMS
        for path in sources(room)
        if package in {name.split(".")[0] for name in imported(path)}
        and path.relative_to(ROOT).as_posix() not in SECOND_HOMES.get(package, set())
    ]
    assert len(homes) <= 1, homes


def parameters_of(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Return how many parameters a function declares, starred ones included."""
    given = node.args
    named = [*given.posonlyargs, *given.args, *given.kwonlyargs]
    return len(named) + (given.vararg is not None) + (given.kwarg is not None)


def callbacks() -> set[str]:
    """Return the functions that Typer registers as commands, as file:name."""
    found = [one.callback for one in app.registered_commands if one.callback]
    places = [f.__module__.split(".")[1:] for f in found]
    return {
        f"{'/'.join(place)}.py:{f.__name__}"
        for f, place in zip(found, places, strict=True)
    }


@pytest.mark.parametrize("room", ROOMS)
def test_no_function_has_more_than_eight_parameters(room: str) -> None:
    """What belongs together is one record; callbacks have a parameter an option."""
    over = {
        f"{path.relative_to(ROOT).as_posix()}:{name}"
        for path in sources(room)
        for name, count in outline(path).parameters
        if count > MOST_PARAMETERS
    }
    assert over <= callbacks()


def folders() -> Counter[str]:
    """Return how many modules each product folder holds itself, by its path."""
    paths = [path for room in ROOMS for path in sources(room)]
    return Counter(path.parent.relative_to(ROOT).as_posix() for path in paths)


def assigned(node: ast.stmt) -> Iterator[str]:
    """Return the names that a top-level statement gives to constants."""
    targets: list[ast.expr] = []
    if isinstance(node, ast.Assign):
        targets = node.targets
    elif isinstance(node, ast.AnnAssign):
        targets = [node.target]
    for target in targets:
        yield from (one.id for one in ast.walk(target) if isinstance(one, ast.Name))


def public_names(path: Path) -> set[str]:
    """Return the constants, functions and classes that a module offers."""
    names = outline(path).defined | set(outline(path).assigned)
    return {name for name in names if not name.startswith("_")}


def test_no_folder_holds_more_than_twenty_five_modules() -> None:
    """A larger folder should be several folders."""
    over = {folder: n for folder, n in folders().items() if n > MOST_MODULES}
    assert not over


def test_every_folder_of_modules_is_packaged() -> None:
    """A folder that the package list forgets is missing from an installed product."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    setuptools = project["tool"]["setuptools"]
    wanted = {f"jointbench.{f.replace('/', '.')}": f for f in folders()}
    assert not wanted.keys() - set(setuptools["packages"])
    assert not wanted.items() - setuptools["package-dir"].items()


def test_a_class_name_stands_in_one_file_and_a_file_name_in_one_folder() -> None:
    """One name for one thing: who searches for it finds one place."""
    paths = [path for room in ROOMS for path in sources(room)]
    classes = {(name, path) for path in paths for name in outline(path).classes}
    files = Counter(path.name for path in paths)
    places = Counter(name for name, _ in classes)
    assert not [name for name, n in (files + places).items() if n > 1]


def test_few_modules_offer_more_than_eight_names() -> None:
    """A file that offers many names has several meanings, but for a few tables."""
    over = {
        path.relative_to(ROOT).as_posix()
        for room in ROOMS
        for path in sources(room)
        if len(public_names(path)) > MOST_NAMES
    }
    assert len(over) <= MOST_LARGE_VOCABULARIES, sorted(over)


@pytest.mark.parametrize("room", ROOMS)
def test_no_module_takes_its_local_names_as_data(room: str) -> None:
    """Options that pass through `locals()` are not checked."""
    called = [path.name for path in sources(room) if "locals" in outline(path).names]
    assert not called


def test_the_standard_library_signal_is_not_shadowed_at_the_root() -> None:
    """Subprocess and asyncio import `signal` and must find the real one."""
    code = "import signal, subprocess, asyncio; signal.SIGINT"
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True)


def test_help_imports_nothing_heavy() -> None:
    """Starting up must stay instant: no SciPy, numba, plotting or HDF5."""
    code = (
        "import sys\n"
        "from jointbench.station.main import app, exit_code\n"
        "sys.argv = ['jointbench', '--help']\n"
        "assert exit_code(app, debug=True) == 0\n"
        f"heavy = [m for m in {NOT_AT_START!r} if m in sys.modules]\n"
        "assert not heavy, heavy\n"
    )
    subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True
    )


def test_no_module_assigns_a_name_twice() -> None:
    """A second value would replace the first without an error, as a rename once did."""
    found = [
        f"{path.relative_to(ROOT)}: {name}"
        for room in ROOMS
        for path in sources(room)
        for name, count in Counter(outline(path).assigned).items()
        if count > 1
    ]
    assert found == []
