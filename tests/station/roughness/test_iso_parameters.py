"""`jointbench surface --iso`: tables, JSON, and what it refuses."""

import json

import numpy as np
import pytest
from pydantic import ValidationError

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import (
    Areal,
    Profile,
    SurfaceInstrument,
    all_valid,
)
from jointbench.station.commands.surface_command import run_surface
from jointbench.station.pipeline.recipe_settings import texture_request_of
from jointbench.station.pipeline.surface_options import SurfaceOptions
from jointbench.station.roughness.texture_figures import texture_items
from jointbench.station.roughness.texture_request import (
    TextureRequest,
    requested_texture,
    texture_answer,
)
from jointbench.station.roughness.texture_words import (
    answer_json,
    answer_lines,
    parameter_rows,
    title_words,
)
from jointbench.station.schemas.recipe import Recipe, SurfacePart

PITCH = 0.5e-6
ASKED = TextureRequest()


def sine(size=1e-6, points=11200, **more):
    place = PITCH * np.arange(points)
    heights = size * np.sin(2 * np.pi * place / 1e-4)
    return Profile("sine", heights, PITCH, all_valid(heights), **more)


def test_the_setting_class_follows_from_the_roughness():
    answer = texture_answer(sine(), ASKED)
    assert answer.reason == "setting class Sc3, chosen by Rz"
    assert "Sc3, S 2.5 µm, L 800 µm, evaluation length 4 mm" in title_words(
        answer.measured
    )
    fine = texture_answer(sine(0.15e-6), ASKED)
    assert fine.measured.texture.settings.setting_class == "Sc2"


def test_a_profile_too_short_for_its_class_says_which_one():
    answer = texture_answer(sine(points=1400), ASKED)
    assert answer.measured.texture.settings.setting_class == "Sc2"
    assert "too short for Sc3" in " ".join(answer.remarks)


def test_stated_cut_offs_of_the_file_are_its_nesting_indices():
    stated = SurfaceInstrument(cutoff_short=8e-6, cutoff_long=0.25e-3)
    answer = texture_answer(sine(instrument=stated), ASKED)
    settings = answer.measured.texture.settings
    assert (settings.short, settings.long) == (8e-6, 0.25e-3)
    assert "noise of the heights is not known" in " ".join(answer_lines(answer))


def test_rows_and_plain_data_agree():
    answer = texture_answer(sine(), ASKED)
    rows = {row[0]: row for row in parameter_rows(answer.measured)}
    page = answer_json(answer)
    by_name = {one["name"]: one for one in page["parameters"]}
    assert set(rows) == set(by_name)
    assert by_name["Rsm"]["value"] == pytest.approx(1e-4, rel=1e-3)
    assert rows["Rsm"][1].endswith("µm")
    assert page["settings"]["l_index_m"] == 0.8e-3
    assert len(page["material_ratio"]["ratio"]) == 101


def test_a_map_has_the_parameters_of_iso_25178():
    rows, columns = np.mgrid[:150, :150]
    heights = 1e-6 * np.sin(2 * np.pi * columns / 20) + 0.0 * rows
    answer = texture_answer(
        Areal("map", heights, (1e-6, 1e-6), all_valid(heights)), ASKED
    )
    names = [row[0] for row in parameter_rows(answer.measured)]
    assert {"Sa", "Str", "Sdr", "Smrk2", "Vvv"} <= set(names)
    assert answer.measured.named("Std").value == pytest.approx(np.pi / 2, abs=1e-3)


def test_the_command_shows_and_writes_them(tmp_path, capsys):
    place = np.arange(1000) * PITCH
    heights = 1e-7 * np.random.default_rng(1).normal(size=1000)
    file = tmp_path / "trace.csv"
    lines = [f"{1e6 * x},{1e6 * z}" for x, z in zip(place, heights, strict=True)]
    file.write_text("\n".join(lines))
    target = tmp_path / "found.json"
    run_surface(
        [file],
        columns="x:um,z:um",
        json_target=str(target),
        options=SurfaceOptions(texture=ASKED),
    )
    shown = capsys.readouterr().out
    assert "roughness by ISO 21920-2" in shown
    assert "no law: it depends on the L-filter" in shown
    texture = json.loads(target.read_text())["files"][0]["texture"]
    assert texture["standard"] == "ISO 21920-2"
    assert texture["sections"] == 2


@pytest.mark.parametrize(
    ("typed", "iso", "said"),
    [
        (("Sc3", None, None), False, "add --iso"),
        (("N6", None, None), True, "Sc1, Sc2"),
        (("Sc3", "2.5 um:0.8 mm", None), True, "leave one out"),
        ((None, None, "1 %"), True, "for example '1 %:0.5 %'"),
        ((None, None, "much:"), True, "a share is a number"),
    ],
)
def test_requests_that_cannot_be_met_name_the_way_out(typed, iso, said):
    with pytest.raises(UsageError, match=said):
        requested_texture(typed, iso=iso, form=None, robust=False)


def test_a_recipe_asks_for_them_with_its_cut_offs():
    part = SurfacePart(iso=True, lambda_s="2.5 um", lambda_c="0.25 mm", robust=True)
    asked = texture_request_of(Recipe(name="iso", surface=part))
    assert (asked.short, asked.long) == pytest.approx((2.5e-6, 0.25e-3))
    assert asked.robust
    assert texture_request_of(Recipe(name="plain")) is None
    with pytest.raises(ValidationError, match="Sc1, Sc2"):
        SurfacePart(setting_class="N6")


def test_a_report_has_traces_curve_and_table():
    items = texture_items([("sine", texture_answer(sine(), ASKED)), ("other", None)])
    kinds = [item.kind for item in items]
    assert kinds == ["figure", "grid", "fold", "text"]
    assert [one.identifier for one in items[1].items] == ["abbott-plot-0"]
    (table,) = items[2].items
    assert len(table.rows) == 16
