"""Report sections of installed packages, through the real commands."""

import logging
import re
import subprocess
import sys
from pathlib import Path

import pytest
from package_commands import PACKAGE, SECTION_TEXT, add, run


def test_report_shows_the_section_of_a_package_in_a_process_of_its_own(
    example: Path, make_session
) -> None:
    """Its table, its place in the list of sections, and its package."""
    session = make_session("s.h5")
    code = (
        f"import sys; sys.path.insert(0, {str(example)!r})\n"
        "from jointbench.station.main import run\n"
        "run()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, "report", str(session)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    text = session.with_suffix(".html").read_text(encoding="utf-8")
    assert text.count('<section id="added-hit_forces">') == 1
    assert '<a href="#added-hit_forces">Forces of the hits</a>' in text
    assert "hardest [N]" in text
    assert f"package {PACKAGE}" in text


def page_with(
    monkeypatch: pytest.MonkeyPatch, folder: Path, session: Path, body: str
) -> str:
    """Return the report of a session with the section that a function makes."""
    text = SECTION_TEXT.format(name="own", body=body)
    add(monkeypatch, folder, "report_sections", ("own", "SECTION"), text)
    assert run(monkeypatch, "report", session) == 0
    return session.with_suffix(".html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("raise ValueError('a <b>\\n\\x1b[2J')", "ValueError: a &lt;b&gt; \\x1b[2J"),
        ("return 5", "TypeError"),
        ("return ['x']", "a str stands where a Section must"),
        ("return [Section('a', 'A', ('x',))]", "a str stands where a Plot must"),
        ("return [Section('a', 'A', (Text(5),))]", "a int stands where a str must"),
        (
            "return [Section('a', 'A', (Plot('p', 'P', {'data': {1}}),))]",
            "set is not JSON serializable",
        ),
        (
            "view.analysis.recordings[0].samples[0, 0] = 1.0",
            "ValueError: assignment destination is read-only",
        ),
        ("view.bench = None", "FrozenInstanceError"),
    ],
)
def test_a_section_that_fails_is_one_line_and_the_report_goes_on(
    body: str,
    reason: str,
    make_session,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """The page names section, package and cause; so does one warning."""
    with caplog.at_level(logging.WARNING):
        page = page_with(monkeypatch, tmp_path / "fails", make_session("s.h5"), body)
    (line,) = re.findall(r'<p class="notice">(Report section .*)</p>', page)
    assert line.startswith("Report section &#39;own&#39; of package added-fails 1.0")
    assert reason in line.replace("&#39;", "'")
    assert '<section id="hits">' in page
    assert '<section id="provenance">' in page
    (warning,) = [record.getMessage() for record in caplog.records]
    assert "report section 'own' of package added-fails 1.0 is missing" in warning
    assert warning.isprintable()


def test_texts_of_a_section_are_escaped_whatever_they_pass_for(
    make_session, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Markup, marks that turn the direction, links in figures: all are text."""
    bad = "'<script>x</script>\\u202e'"
    body = (
        "from markupsafe import Markup\n"
        f"    bad = Markup({bad})\n"
        "    table = DataTable(bad, (bad,), ((bad,),), frozenset({bad}))\n"
        "    plot = Plot('frf-1', bad, {'data': [], 'layout': {'title': bad}})\n"
        "    return [Section('hits', bad, (Text(bad), table, plot))] * 2"
    )
    page = page_with(monkeypatch, tmp_path / "markup", make_session("s.h5"), body)
    assert "<script>x" not in page
    assert "\u202e" not in page
    assert page.count("&lt;script&gt;x&lt;/script&gt;\\u202e") >= 10
    for anchor in ("hits", "added-own", "added-own-2"):
        assert page.count(f'<section id="{anchor}">') == 1
    for identifier in ("added-own-2", "added-own-2-2"):
        assert page.count(f'class="plot" id="{identifier}"') == 1
