"""Decision records: all listed, holes explained, citations of numbers that exist."""

import os
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
RECORDS = ROOT / "docs" / "decisions"
ROW = re.compile(r"^\| \[(\d{4})\]\(([\w.-]+)\) \| (.+?) \| (.+?) \| (.+?) \|$", re.M)
CITED = re.compile(r"decisions/(\d{4})|\brecords? (0\d{3})\b|\]\((\d{4})-[\w-]+\.md")
LINK = re.compile(r"decisions/(\d{4}-[\w-]+\.md)")
SKIPPED = {"build", "dist"}
"""Folders at any depth that hold copies; hidden ones hold environments and caches."""
MOST_WORDS = 500
SPLIT_FROM_0007 = range(65, 86)


def records() -> dict[str, Path]:
    """Return the records by number, without the template."""
    found = {path.name[:4]: path for path in RECORDS.glob("[0-9]*.md")}
    found.pop("0000")
    return found


def listed() -> str:
    """Return the list of all records."""
    return (RECORDS / "README.md").read_text(encoding="utf-8")


def texts() -> Iterator[tuple[str, str]]:
    """Return path and text of all code, pages and settings of the project."""
    for folder, inside, files in os.walk(ROOT):
        # Not entered at all: an environment holds a hundred times as many files.
        kept = (n for n in inside if n not in SKIPPED and not n.startswith("."))
        inside[:] = sorted(kept)
        for name in sorted(files):
            if name.endswith((".py", ".md", ".toml")):
                path = Path(folder, name)
                text = path.read_text(encoding="utf-8")
                yield path.relative_to(ROOT).as_posix(), text


def test_the_list_holds_every_record_once_with_its_title() -> None:
    """Number, file and title of each row are those of the record itself."""
    rows = [match[:3] for match in ROW.findall(listed())]
    wanted = [
        (number, path.name, path.read_text(encoding="utf-8").split("\n")[0][7:].strip())
        for number, path in sorted(records().items())
    ]
    assert rows == wanted, "add a row for each record to docs/decisions/README.md"


def test_every_number_without_a_record_is_explained_once() -> None:
    """A reader who misses a record learns why there is none."""
    holes = re.findall(r"\b(\d{4})\b", listed().split("## Numbers without")[1])
    numbers = {f"{n:04d}" for n in range(1, int(max(records())) + 1)}
    assert Counter(holes) == Counter(numbers - records().keys())


def test_what_code_and_pages_cite_exists() -> None:
    """A citation leads to a record, and a link to its file."""
    known = records()
    names = {record.name for record in known.values()} | {"0000-template.md"}
    for path, text in texts():
        cited = {one or two or three for one, two, three in CITED.findall(text)}
        assert cited - {"0000"} <= known.keys(), f"{path} cites {sorted(cited)}"
        assert set(LINK.findall(text)) <= names, path


def test_the_records_split_from_0007_are_a_page_each_and_cited_in_its_place() -> None:
    """Each has its three parts; nothing but the list and the index cites 0007."""
    for number in SPLIT_FROM_0007:
        text = records()[f"{number:04d}"].read_text(encoding="utf-8")
        assert len(text.split()) < MOST_WORDS
        parts = re.findall(r"^## (\w+)$", text, re.M)
        assert parts == ["Context", "Decision", "Consequences"]
    citing = {
        path
        for path, text in texts()
        if path.endswith(".py")
        and "0007" in {c for g in CITED.findall(text) for c in g}
    }
    assert not citing
