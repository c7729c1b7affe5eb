"""The worked example of docs/adding-an-effect.md, taken from the page and used."""

import re
from pathlib import Path

import numpy as np
import pytest
from short_campaigns import write_short

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.catalogue.linear_effects import CROSS_TALK
from jointbench.analysis.gap.model.effect import EXACT, FAMILIES
from jointbench.analysis.gap.response.curve_integration import (
    REACH,
    finest_of,
    look_up,
    tabulate,
)
from jointbench.analysis.gap.response.curve_law import curve_law
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.simulators.campaigns.campaign_records import quick_campaign
from jointbench.station.gap.run_gap import run_gap
from jointbench.station.schemas.effects_file import read_effects, with_own

PAGE = Path(__file__).parents[4] / "docs" / "adding-an-effect.md"


def example(folder: Path) -> Path:
    """Write the first code block of the page to a file."""
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    path = folder / "my_effects.py"
    path.write_text(blocks[0], encoding="utf-8")
    return path


def written(folder: Path, text: str) -> Path:
    """Write an effects file."""
    path = folder / "own.py"
    path.write_text(text, encoding="utf-8")
    return path


def test_an_effect_from_the_page_is_named_where_it_is_hidden(tmp_path: Path) -> None:
    """A quintic spring, outside the built-in catalogue, is found with its size.

    The slowest of the built-in effects are left out; its nearest rivals stay.
    """
    campaign = quick_campaign(
        8, effects=("quintic_stiffness",), size=0.003, grid="small", noise=0.05
    )
    path = tmp_path / "campaign.h5"
    write_short(campaign, path)
    found = run_gap(
        path,
        without="bouc_wen,iwan,jenkins,coulomb,hidden_mode,maxwell,hum",
        effects=[example(tmp_path)],
        report=None,
        json_target=None,
    )
    assert [e.name for e in found.effects] == ["quintic_stiffness"]
    (k5,) = found.effects[0].parameters
    truth = campaign.effects[0].parameters["k5"]
    assert abs(k5.value - truth) < 5 * k5.sd + 0.02 * abs(truth)


@pytest.mark.parametrize("power", [2, 3, 5, 7])
def test_a_tabulated_power_is_close_to_the_power(power: int) -> None:
    """Within 1e-6 from 10 nm to 9 mm, on both sides of zero."""
    table = np.stack([tabulate(lambda r: r**power, REACH)])
    x = np.geomspace(1e-8, 9e-3, 501)
    x = np.concatenate([-x, x])
    seen = [look_up(table, 0, finest_of(REACH), float(v)) for v in x]
    assert np.allclose(seen, x**power, rtol=1e-6, atol=0.0)


def test_a_corner_is_rounded_over_little_of_its_distance() -> None:
    """A clearance of 5 um: 1 % beyond it, the table agrees with the curve."""
    table = np.stack([tabulate(lambda r: np.where(np.abs(r) > 5e-6, 3.0, 0.0), REACH)])
    inside, outside = (
        look_up(table, 0, finest_of(REACH), x) for x in (4.95e-6, -5.05e-6)
    )
    assert (inside, outside) == (0.0, 3.0)


def test_a_curve_that_is_not_finite_is_refused() -> None:
    """The message states the number of wrong values."""
    with pytest.raises(UsageError, match="not finite"), np.errstate(invalid="ignore"):
        curve_law(drag=lambda v: np.sqrt(v))


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("EFFECTS = ()", "EFFECTS"),
        ("EFFECTS = (1,)", "LumpedEffect"),
        ("import nothing_of_the_kind", "ModuleNotFoundError"),
        ("x = (", "SyntaxError"),
    ],
)
def test_an_effects_file_that_is_unsound_is_refused(
    tmp_path: Path, text: str, word: str
) -> None:
    """One line states the fault, for any fault of the file."""
    with pytest.raises(UsageError, match=word):
        read_effects(written(tmp_path, text))


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ("quintic_stiffness", "Quintic", "small letters"),
        ("off=0.0", "off=None", "amplitude"),
        ('"stiffness"', '"probe"', "reserved for probes"),
        ('("link",)', '("joint",)', "sites"),
        ("law=quintic,", "", "hook"),
        ("k5 * r**5", "(k5 + 1.0) * r**5", "last bit"),
        ("k5 = values[0]", "k5 = values[7]", "IndexError"),
    ],
)
def test_an_effect_that_the_engine_cannot_use_is_refused(
    tmp_path: Path, old: str, new: str, word: str
) -> None:
    """The fault is named before any record is read."""
    text = example(tmp_path).read_text("utf-8")
    assert old in text
    with pytest.raises(UsageError, match=word):
        read_effects(written(tmp_path, text.replace(old, new)))


def test_an_effect_that_bears_a_built_in_name_is_refused(tmp_path: Path) -> None:
    """Two effects of one name could not be distinguished in a verdict."""
    text = example(tmp_path).read_text("utf-8")
    own = read_effects(written(tmp_path, text.replace("quintic_", "cubic_")))
    with pytest.raises(UsageError, match="cubic_stiffness"):
        with_own(CATALOGUE, own)


@pytest.mark.parametrize("name", ["lag", "relaxation"])
def test_an_effect_that_bears_the_name_of_a_probe_is_refused(
    tmp_path: Path, name: str
) -> None:
    """The engine would use its probe instead of the effect."""
    text = example(tmp_path).read_text("utf-8")
    own = read_effects(written(tmp_path, text.replace("quintic_stiffness", name)))
    with pytest.raises(UsageError, match=f"may not be called '{name}'.*another"):
        with_own(CATALOGUE, own)


def test_every_built_in_effect_meets_the_rules_of_a_user_defined_one(
    tmp_path: Path,
) -> None:
    """Hooks at their sites, and no influence at amplitude 0: the rules are the same."""
    text = (
        "from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE as EFFECTS"
    )
    assert read_effects(written(tmp_path, text)) == CATALOGUE


HOOKS = {
    "stiffness": "lambda state, v: v[0] * state.s[None, :]",
    "law": "lambda v: curve_law(spring=lambda r: v[0] * r**2)",
    "transfer": "lambda s, v: 1.0 + v[0] * s",
    "mixing": "lambda v: v[0]",
    "shape": "lambda model, measured, v, rate: model + v[0] * model**2",
}
STIFFER = "stiffness=lambda state, v: 0.0 * state.s[None, :] "


def own_effect(folder: Path, sites: tuple[str, ...], hooks: str) -> Path:
    """Write an effect of one amplitude with given sites and hooks."""
    head = """
import numpy as np
from jointbench.analysis.gap.response.curve_law import curve_law
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.model.effect_parameter import Parameter
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
EFFECT = Effect("own", "own", (Parameter("a", "-", off=0.0),), "nowhere")
"""
    tail = f"EFFECTS = (LumpedEffect(EFFECT, {sites!r}, {hooks}),)"
    return written(folder, head + tail)


@pytest.mark.parametrize(
    ("hook", "right", "wrong"),
    [
        ("stiffness", ("link", "body"), ("channel",)),
        ("law", ("link",), ("body", "channel")),
        ("transfer", ("channel",), ("link", "body")),
        ("mixing", ("channel",), ("link", "body")),
        ("shape", ("channel",), ("link", "body")),
    ],
)
def test_a_hook_is_refused_at_a_site_where_it_would_act_on_something_else(
    tmp_path: Path, hook: str, right: tuple[str, ...], wrong: tuple[str, ...]
) -> None:
    """A law at body 0 would act on link 0; all correct sites together are accepted."""
    given = f"{hook}={HOOKS[hook]}"
    assert len(read_effects(own_effect(tmp_path, right, given))) == 1
    for site in wrong:
        message = f"its hook {hook} acts on a {' or a '.join(right)}, not on a {site}$"
        with pytest.raises(UsageError, match=message):
            read_effects(own_effect(tmp_path, (*right, site), given))


def test_a_rise_is_refused_at_a_body(tmp_path: Path) -> None:
    """It would change the joint whose index is that of the body."""
    hooks = STIFFER + ", rise=lambda conditions, v: v[0] * conditions.preload"
    assert len(read_effects(own_effect(tmp_path, ("link",), hooks))) == 1
    with pytest.raises(UsageError, match="its hook rise acts on a link, not on a body"):
        read_effects(own_effect(tmp_path, ("link", "body"), hooks))


def test_a_mixing_of_every_channel_is_refused(tmp_path: Path) -> None:
    """The index of all channels is -1: it would mix into the last one only."""
    hooks = f"mixing={HOOKS['mixing']}, every_channel=True"
    with pytest.raises(UsageError, match="leave every_channel out"):
        read_effects(own_effect(tmp_path, ("channel",), hooks))
    assert not CROSS_TALK.every_channel


@pytest.mark.parametrize(
    ("site", "hooks"),
    [
        ("link", STIFFER + "+ (state.conditions.preload**0.5 - 1.0)[:, None]"),
        ("link", STIFFER + ", rise=lambda c, v: c.preload ** (v[0] + 0.5) - 1.0"),
        ("body", STIFFER + "+ (state.conditions.progress == 0.5)[:, None]"),
        ("channel", "shape=lambda model, measured, v, rate: model + 1e-9 * model**3"),
        ("channel", "shape=lambda model, measured, v, rate: measured"),
    ],
)
def test_an_influence_at_amplitude_0_on_only_some_records_is_detected(
    tmp_path: Path, site: str, hooks: str
) -> None:
    """Powers of the preload have no influence at 1, so other preloads are tried."""
    with pytest.raises(UsageError, match="last bit"):
        read_effects(own_effect(tmp_path, (site,), hooks))


def test_the_page_lists_the_model_error_of_each_family() -> None:
    """Its numbers are those of the engine."""
    page = PAGE.read_text("utf-8")
    stated = {name: float(x) for name, x in re.findall(r"`(\w+)` (\de-\d)", page)}
    assert stated == {name: one.model_error for name, one in FAMILIES.items()}
    assert f"Any other family gets {EXACT:.0e}".replace("e-0", "e-") in page


def test_an_effects_file_leaves_no_compiled_cache(tmp_path: Path) -> None:
    """No cache of compiled code appears beside a file that was run."""
    (entry,) = read_effects(example(tmp_path))
    assert isinstance(entry, LumpedEffect)
    assert [path.name for path in tmp_path.iterdir()] == ["my_effects.py"]
