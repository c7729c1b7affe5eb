"""Registries: built-in entries, entries of other packages, packages that fail."""

import logging
from dataclasses import dataclass
from pathlib import Path

import pytest
from plugin_distributions import install

from jointbench.acquisition.basics.errors import FormatError, UsageError
from jointbench.acquisition.basics.registry import (
    OWN_PACKAGE,
    Entry,
    PluginFault,
    Registry,
    UnknownEntry,
)

GROUP = "jointbench.test_shapes"


@dataclass(frozen=True, slots=True)
class Shape:
    """A record to register."""

    name: str
    corners: int = 0


SHAPES = Registry(GROUP, "shape", Shape, lambda: (Shape("line", 2), Shape("dot", 1)))


def add(
    folder: Path,
    package: str,
    points: dict[str, str],
    text: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Install a package with one module, named after it, and put it on the path."""
    module = package.replace("-", "_")
    named = {name: f"{module}:{value}" for name, value in points.items()}
    install(folder / package, package, {GROUP: named}, {module: text})
    monkeypatch.syspath_prepend(folder / package)


def shape_text(name: str, corners: int) -> str:
    """Return a module that makes a shape, without an import of this test."""
    return (
        "import sys\n"
        f"Shape = sys.modules[{__name__!r}].Shape\n"
        f"SHAPE = Shape({name!r}, {corners})\n"
    )


def test_built_in_entries_keep_their_order_and_need_no_package() -> None:
    """A table in code is there without any metadata."""
    assert SHAPES.names() == ("line", "dot")
    assert SHAPES.entry("dot") == Entry(Shape("dot", 1), OWN_PACKAGE)
    assert all(entry.built_in for entry in SHAPES.entries())


def test_entries_of_packages_follow_by_package_and_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The order depends neither on the path nor on the time of installation."""
    two = shape_text("ring", 0) + "OTHER = Shape('arc', 2)\n"
    add(tmp_path, "shapes-b", {"box": "SHAPE"}, shape_text("box", 4), monkeypatch)
    add(tmp_path, "shapes-a", {"ring": "SHAPE", "arc": "OTHER"}, two, monkeypatch)
    assert SHAPES.names() == ("line", "dot", "arc", "ring", "box")
    found = [(entry.value.name, entry.package) for entry in SHAPES.entries()]
    assert found[2:] == [
        ("arc", "shapes-a 1.0"),
        ("ring", "shapes-a 1.0"),
        ("box", "shapes-b 1.0"),
    ]


def test_names_are_known_without_an_import(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What lists or checks names does not run code of other packages."""
    add(tmp_path, "shapes-late", {"late": "SHAPE"}, "raise SystemExit", monkeypatch)
    assert "late" in SHAPES.names()
    assert SHAPES.entry("line").value.corners == 2


@pytest.mark.parametrize(
    ("package", "text", "reason"),
    [
        ("raises", "1 / 0", "ZeroDivisionError"),
        ("leaves", "raise SystemExit(3)", "SystemExit"),
        ("lines", "raise ValueError('a\\nb\\x1b')", r"ValueError: a b\?\)"),
        ("lacks", "", "AttributeError"),
        ("typed", "SHAPE = {}", "has the type dict, a shape must have the type Shape"),
        ("named", shape_text("another", 1), "is named 'another', its entry point"),
    ],
)
def test_a_package_that_fails_is_one_warning_and_the_rest_continues(
    package: str,
    text: str,
    reason: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """The warning names the package, once; asked for by name it is an error."""
    add(tmp_path, f"shapes-{package}", {"new": "SHAPE"}, text, monkeypatch)
    with caplog.at_level(logging.WARNING):
        first, again = SHAPES.entries(), SHAPES.entries()
    assert [entry.value.name for entry in first] == ["line", "dot"]
    assert first == again
    (line,) = [record.getMessage() for record in caplog.records]
    assert f"package shapes-{package} 1.0" in line
    assert "uninstall that package; jointbench continues without it" in line
    assert line.isprintable()
    with pytest.raises(PluginFault, match=reason):
        SHAPES.entry("new")


def test_an_unreadable_list_of_entry_points_is_one_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """A package that no one can read does not stop the others."""
    add(tmp_path, "shapes-good", {"fine": "SHAPE"}, shape_text("fine", 3), monkeypatch)
    add(tmp_path, "shapes-torn", {"torn": "SHAPE"}, "", monkeypatch)
    torn = next((tmp_path / "shapes-torn").glob("*.dist-info")) / "entry_points.txt"
    torn.write_text(f"[{GROUP}]\nthis is no entry\n", encoding="utf-8")
    with caplog.at_level(logging.WARNING):
        assert SHAPES.names() == ("line", "dot", "fine")
    (line,) = [record.getMessage() for record in caplog.records]
    assert "the entry points of shapes-torn 1.0 cannot be read" in line


@pytest.mark.parametrize("name", ["line", "box"])
def test_a_name_that_two_packages_add_is_refused(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Which of the two is meant must not depend on an order; both are named."""
    add(tmp_path, "shapes-x", {name: "SHAPE"}, shape_text(name, 4), monkeypatch)
    add(tmp_path, "shapes-y", {"box": "SHAPE"}, shape_text("box", 5), monkeypatch)
    first = "jointbench" if name == "line" else "shapes-x 1.0"
    second = "shapes-x 1.0" if name == "line" else "shapes-y 1.0"
    words = f"{first} and {second} both add the shape '{name}'"
    for ask in (SHAPES.names, SHAPES.entries, lambda: SHAPES.entry("dot")):
        with pytest.raises(UsageError, match=words):
            ask()


def test_the_first_of_two_copies_on_the_path_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Python imports the first; the second is not a second package."""
    for copy in ("old", "new"):
        folder = tmp_path / copy
        text = shape_text("copy", 1)
        add(folder, "shapes-copy", {"copy": "SHAPE"}, text, monkeypatch)
    assert SHAPES.names().count("copy") == 1


def test_an_unknown_name_is_answered_with_a_near_one() -> None:
    """The message lists what there is."""
    with pytest.raises(UnknownEntry, match=r"'lime' is no shape; there are line, dot"):
        SHAPES.entry("lime")
    with pytest.raises(UnknownEntry, match="did you mean 'line'"):
        SHAPES.entry("lime")


def test_code_of_a_package_that_fails_while_it_runs_is_named() -> None:
    """A foreign exception becomes one line; our own errors pass unchanged."""
    entry = Entry(Shape("box"), "shapes-x 1.0")
    with pytest.raises(FormatError, match=r"'box' of package shapes-x 1.0 fails \(Key"):
        with entry.running(FormatError):
            raise KeyError("z")
    with pytest.raises(UsageError, match="ours"):
        with entry.running(FormatError):
            raise UsageError("ours")
