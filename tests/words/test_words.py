"""The glossary is in force: no banned expression in texts, names and pages."""

import re

import pytest
from banned_expressions import BANNED, ROOT, everywhere, findings

GLOSSARY = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("place", everywhere(), ids=lambda path: path.name)
def test_no_banned_expression_is_used(place):
    """Texts, names and pages use the standard terms."""
    assert [str(finding) for finding in findings([place])] == []


@pytest.mark.parametrize("ban", BANNED, ids=lambda ban: ban.expression)
def test_the_glossary_page_lists_every_banned_expression(ban):
    """The page and the check are one list."""
    assert f"| {ban.expression} | {ban.say} |" in GLOSSARY


@pytest.mark.parametrize("ban", BANNED, ids=lambda ban: ban.expression)
def test_a_pattern_finds_what_its_expression_shows(ban):
    """Every pattern finds at least one of the words of its own entry."""
    shown = re.sub(r"[(),;]", " ", ban.expression)
    assert re.search(ban.pattern, shown, re.IGNORECASE)


def test_other_senses_are_left_alone(tmp_path, monkeypatch):
    """A data sheet, a race condition and a quality gate are no findings."""
    monkeypatch.setattr("banned_expressions.ROOT", tmp_path)
    page = tmp_path / "page.md"
    page.write_text("the data sheet, a race condition, the quality gate\n")
    assert list(findings([page])) == []
    page.write_text("the sheet is pulled\n")
    assert [finding.found for finding in findings([page])] == ["sheet", "pulled"]
