"""Effects, contact laws and report sections of packages, through the real commands."""

import itertools
import json
import logging
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from plugin_distributions import install, install_example

from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import write_session
from jointbench.simulators.campaigns.campaign_records import quick_campaign
from jointbench.simulators.campaigns.write_campaign import write_campaign
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile
from jointbench.station.archive.process_file import State, Task, process_task
from jointbench.station.main import app, exit_code
from jointbench.station.results.result_tables import result_texts
from jointbench.station.schemas.recipe import (
    GapPart,
    Recipe,
    read_recipe,
    recipe_digest,
)

COUNT = itertools.count()
"""A module is imported once in a process, so that each has a name of its own."""
PACKAGE = "jointbench-example 1.0"
SLOW = "bouc_wen,iwan,jenkins,coulomb,hidden_mode,maxwell,hum"
JOINT = (
    "contact",
    "--dimension=1.54",
    "--roughness=1e-9 m",
    "--modulus=29.3 GPa",
    "--hardness=1.5 GPa",
    "--load=1 kN",
)
EFFECT_TEXT = """
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.model.effect_parameter import Parameter
from jointbench.analysis.gap.response.curve_law import curve_law
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
K = Parameter("k", "N/m^5", "stiffness/travel^4", off=0.0)
EFFECT = LumpedEffect(
    Effect({name!r}, "stiffness", (K,), "a note"), {sites!r},
    law=lambda v: curve_law(spring=lambda r: v[0] * r**5),
)
"""
LAW_TEXT = """
from dataclasses import replace
from jointbench.analysis.contact.asperity_laws import PowerLaw
from jointbench.analysis.contact.model_catalogue import CONTACT_MODELS
from jointbench.analysis.contact.models import ContactLaw
BASE = CONTACT_MODELS["ke_3d"]
LAW = ContactLaw(replace(BASE, name={name!r}, elastic=PowerLaw({factor!r}, 1.5)))
"""
SECTION_TEXT = """
from jointbench.station.report.report_sections import ReportSection
from jointbench.station.screen.page_parts import DataTable, Plot, Section, Text
def make(view):
    {body}
SECTION = ReportSection({name!r}, make)
"""


@pytest.fixture
def example(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Path]:
    """The example package, installed for one test."""
    folder = install_example(tmp_path_factory.mktemp("site"))
    monkeypatch.syspath_prepend(folder)
    yield folder
    for module in [m for m in sys.modules if m.startswith("jointbench_example")]:
        monkeypatch.delitem(sys.modules, module)


def add(
    monkeypatch: pytest.MonkeyPatch,
    folder: Path,
    group: str,
    point: tuple[str, str],
    text: str,
    version: str = "1.0",
) -> None:
    """Install a package of one module and one entry point, and put it on the path."""
    name, value = point
    module = f"added_{folder.name}_{next(COUNT)}"
    install(
        folder,
        f"added-{folder.name}",
        {f"jointbench.{group}": {name: f"{module}:{value}"}},
        {module: text},
        version,
    )
    monkeypatch.syspath_prepend(folder)


def run(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    """Run a command in this process; return its exit code."""
    monkeypatch.setattr(sys, "argv", ["jointbench", *map(str, words)])
    return exit_code(app, debug=False)


def content_of(path: Path) -> dict[str, object]:
    """Return the JSON of a command."""
    found: dict[str, object] = json.loads(path.read_text(encoding="utf-8"))
    return found


@pytest.mark.usefixtures("example")
def test_gap_names_a_hidden_effect_that_a_package_adds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A quintic spring is found with its size; screen, page and JSON name the package.

    The slowest of the built-in effects are left out; its nearest rivals stay.
    """
    campaign = quick_campaign(
        8, effects=("quintic_stiffness",), size=0.003, grid="small", noise=0.05
    )
    path, page, found = (tmp_path / n for n in ("c.h5", "gap.html", "gap.json"))
    write_campaign(campaign, path)
    command = ("gap", path, f"--without={SLOW}", "--report", page, "--json", found)
    assert run(monkeypatch, *command) == 0
    content = content_of(found)
    (effect,) = content["effects"]  # type: ignore[misc, attr-defined]
    assert effect["name"] == "quintic_stiffness"
    k5 = effect["parameters"]["k5"]
    truth = campaign.effects[0].parameters["k5"]
    assert abs(k5["value"] - truth) < 5 * k5["sd"] + 0.02 * abs(truth)
    assert content["packages"] == {"quintic_stiffness": PACKAGE}
    note = f"effect quintic_stiffness is from package {PACKAGE}"
    assert note in capsys.readouterr().out
    assert f"<td>{PACKAGE}</td>" in page.read_text(encoding="utf-8")


@pytest.mark.usefixtures("example")
def test_without_takes_the_effect_of_a_package_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its name is known as a built-in one is; a misspelt one gets it as near match."""
    path = tmp_path / "c.h5"
    campaign = quick_campaign(8, effects=("delay",), grid="small", noise=0.05)
    write_campaign(campaign, path)
    assert run(monkeypatch, "gap", path, "--without=quintic_stifness") == 2
    error = capsys.readouterr().err
    assert "no effect is called 'quintic_stifness'" in error
    assert "quintic_stiffness" in error.replace("quintic_stifness", "")


def test_an_effect_that_fails_in_a_fit_is_one_line_that_names_its_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is silent at amplitude 0, so that only the search finds its fault."""
    text = EFFECT_TEXT.format(name="own", sites=("link",))
    text = text.replace("lambda v:", "lambda v: v[0] and [][1] or")
    add(monkeypatch, tmp_path / "faulty", "effects", ("own", "EFFECT"), text)
    path = tmp_path / "c.h5"
    campaign = quick_campaign(8, effects=("delay",), grid="small", noise=0.05)
    write_campaign(campaign, path)
    assert run(monkeypatch, "gap", path, f"--without={SLOW}") == 2
    error = " ".join(capsys.readouterr().err.split())
    assert "'own' of package added-faulty 1.0 fails (IndexError" in error


@pytest.mark.usefixtures("example")
def test_an_effect_of_a_file_may_not_bear_the_name_of_an_installed_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two effects of one name would be ambiguous in a verdict."""
    text = EFFECT_TEXT.format(name="quintic_stiffness", sites=("link",))
    file = tmp_path / "own.py"
    file.write_text(f"{text}EFFECTS = (EFFECT,)", encoding="utf-8")
    assert run(monkeypatch, "gap", tmp_path / "c.h5", "--effects", file) == 2
    assert "two effects are called 'quintic_stiffness'" in capsys.readouterr().err


@pytest.mark.usefixtures("example")
def test_contact_predicts_by_the_model_of_a_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The same stiffness as `ke_3d` without its two elastic-plastic regimes."""
    mine, theirs = tmp_path / "mine.json", tmp_path / "theirs.json"
    assert run(monkeypatch, *JOINT, "--model=two_regimes_3d", "--json", mine) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert f"two_regimes_3d: a model of package {PACKAGE}" in text
    terms = "--without=elastic_plastic_1,elastic_plastic_2"
    assert run(monkeypatch, *JOINT, "--model=ke_3d", terms, "--json", theirs) == 0
    (found,), (known,) = (content_of(p)["models"] for p in (mine, theirs))  # type: ignore[misc]
    assert found["package"] == PACKAGE
    assert known["package"] == "jointbench"
    for key in ("normal_stiffness", "tangential_stiffness", "real_area"):
        assert found[key] == pytest.approx(known[key], rel=1e-12)


@pytest.mark.usefixtures("example")
def test_a_model_without_a_printed_form_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line with the way out."""
    options = ("--model=two_regimes_3d", "--mode=as-printed")
    assert run(monkeypatch, *JOINT, *options) == 2
    error = " ".join(capsys.readouterr().err.split())
    assert "'two_regimes_3d' has no form as printed" in error


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


def law_of(
    monkeypatch: pytest.MonkeyPatch, folder: Path, factor: float, version: str
) -> None:
    """Install a version of a package with a contact law; it replaces an earlier one."""
    folder.mkdir(parents=True)
    text = LAW_TEXT.format(name="own", factor=factor)
    add(monkeypatch, folder / "law", "contact_laws", ("own", "LAW"), text, version)


@pytest.fixture
def face_file(tmp_path: Path) -> Path:
    """A session of one surface."""
    face = rough_profile(2000, dimension=1.5, roughness=1e-10, spacing=5e-7, seed=3)
    session = Session(
        uuid="0000-1",
        created="2025-03-01T12:00:00+00:00",
        software="jointbench 0.1.0",
        simulated=True,
        surfaces=(replace(face, name="face"),),
    )
    write_session(session, tmp_path / "face.h5")
    return tmp_path / "face.h5"


def test_reprocessing_computes_anew_what_depends_on_a_law_that_changed(
    face_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither a rise of the version nor an edit of the module gives an old number."""
    written = tmp_path / "recipe.toml"
    written.write_text(
        '[contact]\nmodulus = "29 GPa"\nhardness = "1 GPa"\npreload = "20 kN"\n'
        'model = "own"\n',
        encoding="utf-8",
    )
    task = Task(face_file, tmp_path / "face.results.h5", tmp_path / "stages")
    found: dict[str, tuple[float, str, str]] = {}
    for name, factor, version in (
        ("first", 1.0, "1.0"),
        ("same", 1.0, "1.0"),
        ("raised", 1.0, "1.1"),
        ("edited", 2.0, "1.1"),
    ):
        law_of(monkeypatch, tmp_path / name, factor, version)
        outcome = process_task(task, read_recipe(written))
        assert outcome.state is (State.SKIPPED if name == "same" else State.DONE)
        if name in ("raised", "edited"):
            assert outcome.computed == ("contact",)
            assert outcome.reused == ("structure of face", "surface face")
        (model,) = json.loads(result_texts(task.result)["contact"])["models"]
        assert model["package"] == f"added-law {version}"
        found[name] = (model["normal_stiffness"], outcome.key, version)
    assert found["first"][:2] == found["same"][:2]
    assert found["raised"][0] == found["first"][0]
    assert abs(found["edited"][0] / found["first"][0] - 1.0) > 0.1
    assert len({key for _, key, _ in found.values()}) == 3


def test_the_key_of_a_gap_holds_the_effects_of_packages_that_are_tried(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One more effect may change a verdict; one that is left out cannot."""
    bench = GapPart(model="bench.toml")
    recipes = [
        Recipe(gap=bench),
        Recipe(gap=bench.model_copy(update={"without": ("own",)})),
        Recipe(),
    ]
    before = [recipe_digest(recipe) for recipe in recipes]
    text = EFFECT_TEXT.format(name="own", sites=("link",))
    add(monkeypatch, tmp_path / "more", "effects", ("own", "EFFECT"), text)
    after = [recipe_digest(recipe) for recipe in recipes]
    changed = [a != b for a, b in zip(before, after, strict=True)]
    assert changed == [True, False, False]


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
