"""Effects of installed packages, through the real commands."""

from pathlib import Path

import pytest
from package_commands import EFFECT_TEXT, PACKAGE, add, content_of, run
from short_campaigns import write_short

from jointbench.simulators.campaigns.campaign_records import quick_campaign
from jointbench.station.schemas.recipe import GapPart, Recipe, recipe_digest

SLOW = "bouc_wen,iwan,jenkins,coulomb,hidden_mode,maxwell,hum"


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
    write_short(campaign, path)
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
    assert f">{PACKAGE}</td>" in page.read_text(encoding="utf-8")


@pytest.mark.usefixtures("example")
def test_without_takes_the_effect_of_a_package_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its name is known as a built-in one is; a misspelt one gets it as near match."""
    path = tmp_path / "c.h5"
    campaign = quick_campaign(8, effects=("delay",), grid="small", noise=0.05)
    write_short(campaign, path)
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
    write_short(campaign, path)
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
