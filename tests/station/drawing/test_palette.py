"""Colours of reports: one meaning each, and legible in light and in dark."""

import re
from importlib.resources import files

import pytest

from jointbench.station.drawing.map_picture import legible_on, map_colour
from jointbench.station.drawing.palette import MEANINGS

CSS = files("jointbench.station.drawing").joinpath("palette.css").read_text("utf-8")
SCREEN = (
    files("jointbench.station.drawing").joinpath("screen_roles.css").read_text("utf-8")
)
ASSETS = files("jointbench.station.browser").joinpath("assets")
LEAST_CONTRAST = 4.5
TEXTS = ("ink", "soft", "link")


def values(block: str) -> dict[str, str]:
    """Return the values of a block of the palette."""
    return dict(re.findall(r"--([a-z]+): (#[0-9a-f]{6});", block))


LIGHT, DARK = (values(block) for block in CSS.split("@media"))


def on_screens(mode: dict[str, str]) -> dict[str, str]:
    """Return the colours of screens, those of reports among them."""
    found = dict(mode)
    for name, value in re.findall(r"--([\w-]+): ([^;]+);", SCREEN):
        role = re.fullmatch(r"var\(--([a-z]+)\)", value)
        found[name] = found[role[1]] if role else value
    return found


def luminance(color: str) -> float:
    """Return the relative luminance of #rrggbb by WCAG 2.2."""
    parts = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    red, green, blue = (
        p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    """Return the contrast of two colours by WCAG 2.2."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("mode", [LIGHT, DARK], ids=["light", "dark"])
def test_every_text_and_every_role_is_legible_on_every_ground(mode):
    """4.5:1 on the page, on its sections, and texts on notices."""
    roles = [re.sub(r"\W|var", "", role) for role in MEANINGS]
    for name in (*TEXTS, *roles):
        for ground in ("paper", "ground"):
            assert contrast(mode[name], mode[ground]) >= LEAST_CONTRAST, (name, ground)
    assert contrast(mode["ink"], mode["notice"]) >= LEAST_CONTRAST


def test_light_and_dark_have_the_same_names_and_every_role_a_class():
    """No colour is missing in one of them."""
    assert LIGHT.keys() == DARK.keys()
    for role in MEANINGS:
        name = role.removeprefix("var(--").removesuffix(")")
        assert f".c-{name} {{ --c: {role}; }}" in CSS


@pytest.mark.parametrize("mode", [LIGHT, DARK], ids=["light", "dark"])
def test_texts_on_bands_and_curves_of_screens_are_legible(mode):
    """4.5:1 for texts on bands of colour, and for curves on paper."""
    known = on_screens(mode)
    pairs = [("on-band", band) for band in known if band.startswith("band-")]
    pairs += [("on-accent", "accent"), ("on-notice", "notice")]
    pairs += [(curve, "paper") for curve in known if curve.startswith("curve-")]
    assert len(pairs) == 13
    low = {p: contrast(known[p[0]], known[p[1]]) for p in pairs}
    assert {p: value for p, value in low.items() if value < LEAST_CONTRAST} == {}


def test_screens_use_no_colour_beside_the_palette():
    """Every role that a style sheet names exists, and none has a value of its own."""
    known = on_screens(LIGHT)
    for name in ("screen.css", "bench.css", "desk.css"):
        text = ASSETS.joinpath(name).read_text("utf-8")
        assert set(re.findall(r"var\(--([\w-]+)\)", text)) <= known.keys(), name
        assert re.findall(r"#[0-9a-fA-F]{3,8}\b(?=[^{}]*;)", text) == [], name


def test_no_two_roles_have_one_colour():
    """One colour, one meaning."""
    for mode in (LIGHT, DARK):
        roles = [mode[r.removeprefix("var(--").removesuffix(")")] for r in MEANINGS]
        assert len(set(roles)) == len(roles)


@pytest.mark.parametrize("share", [0.0, 0.2, 0.4, 0.59, 0.61, 0.8, 1.0])
def test_a_number_on_a_map_is_legible(share):
    """White on the dark half of the scale, ink on the bright half."""
    ground = "#" + "".join(f"{v:02x}" for v in map_colour(share))
    assert contrast(legible_on(share), ground) >= LEAST_CONTRAST
