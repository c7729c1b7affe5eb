"""Recipes: what they say reaches the chain, what is wrong is named."""

import math
from pathlib import Path

import pytest

from jointbench.acquisition.basics.errors import BadData
from jointbench.signal.hits.windows import WindowRequest
from jointbench.signal.surface.surface_treatment import UNTREATED, SurfaceTreatment
from jointbench.station.pipeline.recipe_settings import (
    chain_settings,
    surface_treatment_of,
)
from jointbench.station.schemas.recipe import Recipe, read_recipe, recipe_digest


def written(folder: Path, text: str, name: str = "R.toml") -> Path:
    """Write a recipe."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_an_empty_recipe_is_the_chain_of_modal() -> None:
    """What a recipe leaves out is chosen as `jointbench modal` chooses it."""
    from jointbench.station.pipeline.chain import ChainSettings

    assert chain_settings(Recipe()) == ChainSettings()


def test_numbers_with_units_reach_the_settings_in_si(tmp_path: Path) -> None:
    """2 ms is 0.002 s, 5 % is 0.05, "none" switches a window off."""
    text = (
        '[hits]\ndouble_ratio = "12 %"\npretrigger = "5 ms"\n'
        '[windows]\nforce_width = "2 ms"\nexponential = "none"\n'
        '[modes]\nband = ["50 Hz", "2 kHz"]\n[kalman]\nuse = false\n'
    )
    settings = chain_settings(read_recipe(written(tmp_path, text)))
    assert settings.hits.limits.double_ratio == pytest.approx(0.12)
    assert settings.hits.pretrigger == pytest.approx(0.005)
    assert settings.window == WindowRequest(0.002, 0.0, None)
    assert settings.modal.band == (50.0, 2000.0)
    assert settings.kalman is None


def test_a_window_may_be_chosen_by_the_hits_or_left_out(tmp_path: Path) -> None:
    """As the page on recipes has it: "auto" is no number, "none" is 0."""
    text = '[windows]\nforce_width = "3 ms"\nexponential = "auto"\nlead = "none"\n'
    windows = read_recipe(written(tmp_path, text)).windows
    assert (windows.force_width, windows.exponential, windows.lead) == (3e-3, None, 0.0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[hits]\ndouble = "5 %"\n', ("hits.double", "'double_ratio' is meant?")),
        ('[windows]\nforce_width = "5 N"\n', ("windows.force_width", "unit of force")),
        ("[windows]\nforce_width = 5\n", ("windows.force_width", "with its unit")),
        ('[frf]\nestimator = "H3"\n', ("frf.estimator", "'H3'")),
        ('[modes]\nband = ["2 kHz", "50 Hz"]\n', ("modes", "lower end first")),
        ('[identification]\nmodel = "no.toml"\n', ("no.toml", "no such file")),
        ("models = 3\n", ("models", "no table")),
        ('[windos]\nlead = "none"\n', ("windos", "'windows' is meant?")),
        ("[windows]\nzzz = 1\n", ("zzz", "there are force_width, exponential")),
        ("windows = [1]\n", ("windows", "write a table")),
        ('[identification]\nmodel = "../m.toml"\n', ("../m.toml", "beside the")),
        ('[gap]\nmodel = "/etc/hostname"\n', ("/etc/hostname", "beside the")),
        ('[gap]\nmodel = "C:\\\\m.toml"\n', ("m.toml", "beside the")),
        ('[gap]\nmodel = "m.toml"\nwithout = ["jenkin"]\n', ("jenkin", "jenkins")),
        (
            '[contact]\nmodulus = "29 GPa"\nhardness = "1 GPa"\nmodel = "ke_3"\n',
            ("contact.model", "did you mean"),
        ),
        ('name = "../up"\n', ("../up", "part of file names")),
        ('name = "a\\nb"\n', ("part of file names",)),
        (f'name = "{"x" * 61}"\n', ("60 at the most",)),
    ],
)
def test_what_is_wrong_is_named_by_file_key_value_and_rule(
    tmp_path: Path, text: str, words: tuple[str, ...]
) -> None:
    """One line with the file and the key."""
    with pytest.raises(BadData) as caught:
        read_recipe(written(tmp_path, text))
    assert all(word in str(caught.value) for word in (".toml", *words))


def test_a_recipe_that_has_no_end_is_not_read(tmp_path: Path) -> None:
    """A device or a pipe has no size to hold against the limit."""
    if not Path("/dev/zero").exists():
        pytest.skip("no such device on this system")
    (tmp_path / "zero.toml").symlink_to("/dev/zero")
    with pytest.raises(BadData, match="device"):
        read_recipe(tmp_path / "zero.toml")
    with pytest.raises(BadData, match="folder"):
        read_recipe(tmp_path)


def test_the_digest_follows_the_content_and_not_the_spelling(tmp_path: Path) -> None:
    """2 ms and 0.002 s are one recipe; 3 ms is another; the name is none."""
    first = read_recipe(written(tmp_path, '[windows]\nforce_width = "2 ms"\n'))
    same = read_recipe(
        written(tmp_path, 'name = "x"\n[windows]\nforce_width = "0.002 s"\n')
    )
    other = read_recipe(written(tmp_path, '[windows]\nforce_width = "3 ms"\n'))
    assert recipe_digest(first) == recipe_digest(same) != recipe_digest(other)


def test_steps_before_the_fit_of_surfaces_reach_the_treatment(tmp_path: Path) -> None:
    """Lengths in SI, the direction in radians; a recipe without them keeps its key."""
    text = '[surface]\nform = 2\nlambda_c = "0.8 mm"\ndirection = 90\n'
    found = surface_treatment_of(read_recipe(written(tmp_path, text)))
    assert found == SurfaceTreatment(form=2, long=8e-4, direction=math.pi / 2)
    assert surface_treatment_of(Recipe()) == UNTREATED
    assert Recipe().model_dump()["surface"] == {"use": True, "gamma": None}


def test_the_digest_follows_the_model_that_is_named(tmp_path: Path) -> None:
    """A stiffer prior in the model file is another recipe."""
    model = (
        '[bodies.top]\nmass = "9 kg"\nchannel = "a1"\n'
        '[links.joint]\nbetween = ["ground", "top"]\n'
    )
    recipe = written(tmp_path, '[identification]\nmodel = "m.toml"\n')
    digests = set()
    for mass in ("9 kg", "10 kg"):
        written(tmp_path, model.replace("9 kg", mass), "m.toml")
        digests.add(recipe_digest(read_recipe(recipe)))
    assert len(digests) == 2
