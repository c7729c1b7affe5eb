"""No link of a page is dead, on the forge and in the built site."""

import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

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


def test_the_site_builds_without_a_warning_or_a_dead_link(tmp_path: Path) -> None:
    """Warnings are errors; pages, files and headings that are linked are there."""
    site = tmp_path / "site"
    command = [sys.executable, "docs/site/build_site.py", "--out", site]
    done = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    assert "WARNING" not in done.stderr
    for name in ("index", "uses", "reference/commands", "decisions/index"):
        assert (site / f"{name}.html").exists()
    assert (site / "search" / "search_index.json").exists()
    home = (site / "index.html").read_text(encoding="utf-8")
    assert not re.findall(r"<(?:script|link)[^>]+(?:src|href)=\"https?:", home)
    assert not sorted(dead_links(site))


def dead_links(site: Path) -> set[str]:
    """Return the links of a built site that lead to no file or to no heading."""
    texts = {path.resolve(): path.read_text("utf-8") for path in site.rglob("*.html")}
    # The page of a server for what is not found has links from the root.
    del texts[(site / "404.html").resolve()]
    known = {path: set(re.findall(r'\sid="?([^"\s>]+)', texts[path])) for path in texts}
    dead = set()
    for page, text in texts.items():
        links = set(re.findall(r'\s(?:href|src)="([^"#]*)(?:#([^"]*))?"', text))
        for target, heading in links:
            if ":" in target:
                continue
            file = (page.parent / unquote(target)).resolve() if target else page
            headings = known.get(file, set())
            lost = heading and heading != "__nothing" and heading not in headings
            if lost or not file.exists():
                dead.add(f"{page.name}: {target}#{heading}")
    return dead
