"""Packages that cannot be used or take a name, and their names in the help."""

import logging
import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest
from package_commands import EFFECT_TEXT, JOINT, LAW_TEXT, SECTION_TEXT, add, run


@pytest.mark.parametrize(
    ("command", "names"),
    [
        ("contact", ("mb_2d", "ke_3d_modified", "two_regimes_3d")),
        ("gap", ("quintic_stiffness",)),
    ],
)
def test_help_lists_the_names_of_packages(
    command: str, names: tuple[str, ...], example: Path
) -> None:
    """In a process of its own; the effects are named without an import."""
    code = (
        f"import sys; sys.path.insert(0, {str(example)!r})\n"
        "from jointbench.station.main import run\n"
        "run()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, command, "--help"],
        capture_output=True,
        text=True,
        check=True,
    )
    letters = re.sub(r"[^a-z0-9_]", "", done.stdout)
    for name in names:
        assert name in letters


FAULTY: Mapping[str, tuple[str, tuple[str, str], str, str]] = {
    "import": ("effects", ("own", "EFFECT"), "1 / 0", "ZeroDivisionError"),
    "type": ("effects", ("own", "EFFECT"), "EFFECT = 5", "must have the type Lumped"),
    "site": (
        "effects",
        ("own", "EFFECT"),
        EFFECT_TEXT.format(name="own", sites=("body",)),
        "its hook law acts on a link, not on a body",
    ),
    "probe": (
        "effects",
        ("lag", "EFFECT"),
        EFFECT_TEXT.format(name="lag", sites=("link",)),
        "the engine's own probes use that name",
    ),
    "law": (
        "contact_laws",
        ("own", "LAW"),
        LAW_TEXT.format(name="own", factor=-1.0),
        "a coefficient must be finite and not negative",
    ),
    "lawtype": ("contact_laws", ("own", "LAW"), "LAW = {}", "the type ContactLaw"),
    "section": (
        "report_sections",
        ("own", "SECTION"),
        SECTION_TEXT.format(name="own", body="pass") + "SECTION = make",
        "must have the type ReportSection",
    ),
}


@pytest.mark.parametrize("case", sorted(FAULTY))
def test_a_package_that_cannot_be_used_is_one_line_and_left_out(
    case: str,
    make_session,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A contact model is asked for by name, so it is an error; the others a warning."""
    group, point, text, reason = FAULTY[case]
    add(monkeypatch, tmp_path / case, group, point, text)
    commands: Mapping[str, tuple[object, ...]] = {
        "effects": ("gap", tmp_path / "no.h5"),
        "contact_laws": (*JOINT, "--model=own"),
        "report_sections": ("report", make_session("s.h5")),
    }
    with caplog.at_level(logging.WARNING):
        code = run(monkeypatch, *commands[group])
    lines = [record.getMessage() for record in caplog.records]
    if group == "contact_laws":
        assert code == 2
        lines = [" ".join(capsys.readouterr().err.split())]
    (line,) = lines
    assert reason in line
    assert f"package added-{case} 1.0" in line


@pytest.mark.parametrize(
    ("group", "point", "text", "command"),
    [
        (
            "effects",
            ("delay", "EFFECT"),
            EFFECT_TEXT.format(name="delay", sites=("link",)),
            ("gap", "no.h5"),
        ),
        (
            "contact_laws",
            ("ke_3d", "LAW"),
            LAW_TEXT.format(name="ke_3d", factor=1.0),
            JOINT,
        ),
    ],
)
def test_a_name_that_is_taken_is_refused_with_both_packages(
    group: str,
    point: tuple[str, str],
    text: str,
    command: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """No order decides which of the two is meant."""
    add(monkeypatch, tmp_path / f"taken_{group}", group, point, text)
    assert run(monkeypatch, *command) == 2
    error = " ".join(capsys.readouterr().err.split())
    assert f"jointbench and added-taken_{group} 1.0 both add" in error
    assert repr(point[0]) in error
