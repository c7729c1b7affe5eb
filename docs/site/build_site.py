"""Build all pages as a site with search, offline: warnings are errors.

    pip install '.[site]'
    python docs/site/build_site.py --out site

Pages are staged below the output folder: links to files of the repository are made to
fit, the references of commands and library are generated, and the tables of
`docs/README.md` become the navigation.
"""

import argparse
import inspect
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import typer
from typer.core import TyperGroup

import jointbench
from jointbench.station.main import app
from jointbench.station.screen.help_page import command_groups

ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"(!?\[[^\]]*\])\(([^)\s#]+)(#[^)]*)?\)")
ROW = re.compile(r"^\| \[([^\]]+)\]\(([\w./-]+\.md)\)", re.MULTILINE)
SHOWN = {".md", ".png", ".toml", ".py", ".ipynb", ".csv"}
"""Endings of files that pages link to and that the site has."""
OUTSIDE = ("CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")


def main() -> int:
    """Stage the pages and build the site; return the exit code of the builder."""
    given = argparse.ArgumentParser(description=__doc__)
    given.add_argument("--out", type=Path, default=Path("site"), help="folder to write")
    out = given.parse_args().out.resolve()
    staged = out.with_name(out.name + ".pages")
    shutil.rmtree(staged, ignore_errors=True)
    stage(staged / "docs")
    config = staged / "mkdocs.yml"
    # JSON is YAML as well, and needs no writer.
    config.write_text(json.dumps(settings(staged / "docs", out), indent=1), "utf-8")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "-f", str(config)]
    # The builder advertises a successor on every run.
    quiet = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run([*command, "--quiet"], env=quiet, check=False).returncode
    if not done:
        shutil.rmtree(staged)
    return done


def stage(docs: Path) -> None:
    """Copy and generate all pages."""
    days = last_changes()
    for path in sorted((ROOT / "docs").rglob("*")):
        place = path.relative_to(ROOT / "docs")
        if path.suffix not in SHOWN or place.parts[0] == "site":
            continue
        name = "pages.md" if place.as_posix() == "README.md" else place
        copy(path, docs / name, days.get(path.relative_to(ROOT).as_posix(), ""))
    copy(ROOT / "README.md", docs / "index.md")
    copy(Path(__file__).with_name("site.css"), docs / "site.css")
    for name in OUTSIDE:
        if (ROOT / name).exists():
            copy(ROOT / name, docs / name)
    for path in (ROOT / "examples").rglob("*"):
        if path.suffix in SHOWN:
            copy(path, docs / path.relative_to(ROOT))
    reference = docs / "reference"
    reference.mkdir()
    (reference / "commands.md").write_text(command_reference(), encoding="utf-8")
    (reference / "library.md").write_text(library_reference(), encoding="utf-8")


def copy(source: Path, target: Path, day: str = "") -> None:
    """Copy a file; links of a page are made to fit its new place."""
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.suffix != ".md":
        shutil.copyfile(source, target)
        return
    text = source.read_text(encoding="utf-8")
    here = source.parent
    text = LINK.sub(lambda found: fitted(found, here), text)
    if source.parent == ROOT / "docs" and day:
        text += f"\n\n---\n*Last changed {day}.*\n"
    target.write_text(text, encoding="utf-8")


def fitted(found: re.Match[str], here: Path) -> str:
    """Return a link as the site has it; to what it has not, the words alone."""
    words, target, anchor = found[1], found[2], found[3] or ""
    if "://" in target or target.startswith("mailto:"):
        return found[0]
    file = (here / target).resolve()
    if not file.is_relative_to(ROOT):
        raise SystemExit(f"{here}: the link {target} leaves the repository")
    if not file.exists():
        raise SystemExit(f"{here}: dead link {target}")
    place = staged_place(file)
    if place is None:
        return f"`{file.relative_to(ROOT).as_posix()}`"
    start = staged_place(here / "x.md") or Path("x.md")
    ups = [".."] * (len(start.parts) - 1)
    return f"{words}({'/'.join([*ups, *place.parts])}{anchor})"


def staged_place(file: Path) -> Path | None:
    """Return where the site has a file of the repository, None if it has it not."""
    place = file.relative_to(ROOT)
    if file.suffix not in SHOWN:
        return None
    if place.parts[0] == "docs":
        inside = Path(*place.parts[1:])
        return Path("pages.md") if inside == Path("README.md") else inside
    if place == Path("README.md"):
        return Path("index.md")
    return place if place.parts[0] == "examples" or place.name in OUTSIDE else None


def last_changes() -> dict[str, str]:
    """Return the day of the last commit of each page; none without git."""
    command = ["git", "log", "--format=%cs", "--name-only", "--", "docs"]
    try:
        log = subprocess.run(
            command, cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout
    except (OSError, subprocess.CalledProcessError):
        return {}
    found: dict[str, str] = {}
    day = ""
    for line in log.split("\n"):
        if re.fullmatch(r"\d{4}-\d\d-\d\d", line):
            day = line
        elif line:
            found.setdefault(line, day)
    return found


def command_reference() -> str:
    """Return the help of every command, by group."""
    group = typer.main.get_command(app)
    assert isinstance(group, TyperGroup)
    context = group.make_context("jointbench", [], resilient_parsing=True)
    lines = ["# All commands", "The help of every command, as `--help` prints it."]
    for heading, members in command_groups(group).items():
        lines.append(f"## {heading}")
        for one in members:
            own = one.make_context(one.name, [], parent=context, resilient_parsing=True)
            lines.append(f"### {one.name}\n```text\n{one.get_help(own)}\n```")
    return "\n\n".join(lines) + "\n"


def library_reference() -> str:
    """Return signature and docstring of every function of the library."""
    lines = ["# The library", "Functions of `import jointbench as jb`."]
    for name in sorted(jointbench.__all__):
        work = getattr(jointbench, name)
        text = inspect.getdoc(work) or ""
        signature = str(inspect.signature(work)).replace("jointbench.", "")
        plain = re.sub(r"[\w.]+\.(\w+)", r"\1", signature)
        lines.append(
            f"## jb.{name}\n```python\njb.{name}{plain}\n```\n{sections(text)}"
        )
    return "\n\n".join(lines) + "\n"


def sections(text: str) -> str:
    """Return a docstring with its sections as lists."""
    blocks = []
    for block in text.split("\n\n"):
        head, _, body = block.partition("\n")
        if head in {"Args:", "Returns:", "Raises:", "Attributes:", "Source:"}:
            blocks.append(f"**{head[:-1]}**\n\n" + "\n".join(entries(body)))
        else:
            blocks.append(block)
    return "\n\n".join(blocks)


def entries(body: str) -> Iterator[str]:
    """Yield the entries of a section as a list; longer lines go with their entry."""
    for line in inspect.cleandoc(body).split("\n"):
        if line.startswith(" "):
            yield f"  {line.strip()}"
        else:
            yield f"- {line}"


def settings(docs: Path, out: Path) -> dict[str, object]:
    """Return the settings of the builder."""
    return {
        "site_name": "jointbench",
        "docs_dir": str(docs),
        "site_dir": str(out),
        "use_directory_urls": False,
        "theme": {
            "name": "material",
            "font": False,
            "features": [
                "navigation.tabs",
                "navigation.top",
                "search.highlight",
                "content.code.copy",
            ],
            "palette": [{"scheme": "default", "primary": "blue grey"}],
        },
        # Not `offline`: its search without a server loads a script of others.
        "plugins": ["search"],
        "extra_css": ["site.css"],
        "markdown_extensions": [
            "tables",
            "toc",
            "pymdownx.superfences",
            "pymdownx.highlight",
        ],
        "validation": {
            "nav": {"omitted_files": "info", "not_found": "warn"},
            "links": {"not_found": "warn", "anchors": "warn"},
        },
        "exclude_docs": "/examples/**/*.py\n!/examples/**",
        "nav": navigation(docs),
    }


def navigation(docs: Path) -> list[object]:
    """Return the pages by kind, as the tables of `docs/README.md` list them."""
    text = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    parts: dict[str, list[object]] = {}
    for part in text.split("\n## ")[1:]:
        names = [row[1] for row in ROW.findall(part) if not row[1].startswith("..")]
        parts[part.split("\n")[0]] = list(names)
    listed = {name for names in parts.values() for name in names}
    fixed = {"index.md", "pages.md", "gallery.md", *OUTSIDE}
    rest = sorted(p.name for p in docs.glob("*.md") if p.name not in listed | fixed)
    parts.setdefault("Measurements", []).extend(rest)
    records = sorted(p.name for p in (docs / "decisions").glob("[0-9]*.md"))
    outside = [name for name in OUTSIDE if (docs / name).exists()]
    reference: list[object] = ["reference/commands.md", "reference/library.md"]
    decisions = [f"decisions/{name}" for name in records if name[:4] != "0000"]
    return [
        {"Home": ["index.md", {"Gallery": "gallery.md"}, {"All pages": "pages.md"}]},
        *({kind: names} for kind, names in parts.items()),
        {"Reference": reference},
        {"Decisions": [{"Index": "decisions/README.md"}, *decisions]},
        {"Project": outside},
    ]


if __name__ == "__main__":
    sys.exit(main())
