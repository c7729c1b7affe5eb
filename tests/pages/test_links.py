"""No link of a page is dead; the site builds where its builder is installed."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest
from page_commands import ROOT

LINK = re.compile(r"\]\(([^)\s#]*)(#[^)]*)?\)")
FENCE = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)
CODE = re.compile(r"`[^`]*`")


def pages() -> list[Path]:
    """Return all pages of the repository."""
    places = (ROOT, ROOT / "docs", ROOT / "docs" / "decisions")
    found = [path for place in places for path in sorted(place.glob("*.md"))]
    return found + sorted((ROOT / "examples").glob("*/*.md"))


def anchors(path: Path) -> set[str]:
    """Return the anchors of the headings of a page."""
    text = FENCE.sub("", path.read_text(encoding="utf-8"))
    heads = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    plain = (re.sub(r"[^\w\- ]", "", head.lower()) for head in heads)
    return {f"#{head.strip().replace(' ', '-')}" for head in plain}


def test_no_link_is_dead() -> None:
    """Files and headings within the repository."""
    dead = []
    for page in pages():
        text = CODE.sub("", FENCE.sub("", page.read_text(encoding="utf-8")))
        for target, anchor in LINK.findall(text):
            if ":" in target:
                continue
            file = (page.parent / target) if target else page
            missing = not file.exists()
            if missing or (anchor and anchor not in anchors(file)):
                dead.append(f"{page.relative_to(ROOT)}: {target}{anchor}")
    assert not dead


@pytest.mark.skipif(
    importlib.util.find_spec("mkdocs") is None, reason="needs the extra [site]"
)
def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    """Warnings are errors; every page of the navigation is there."""
    command = [sys.executable, "docs/site/build_site.py", "--out", tmp_path / "site"]
    subprocess.run(command, cwd=ROOT, check=True)
    for name in ("index", "uses", "reference/commands", "decisions/README"):
        assert (tmp_path / "site" / f"{name}.html").exists()
    assert (tmp_path / "site" / "search" / "search_index.json").exists()
    home = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    assert not re.findall(r"<(?:script|link)[^>]+(?:src|href)=\"https?:", home)
