"""`jointbench gap` on hits on bolted bodies, and files that cannot be used."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from hit_campaigns import Hidden, nominal_content, write_campaign

from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    JointbenchError,
    UsageError,
)
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.station.gap.run_gap import run_gap
from jointbench.station.gap.structure_files import examine_structure, nominal_beside


@pytest.fixture(scope="module")
def complete(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return a campaign without a missing effect, and its nominal parameters."""
    return write_campaign(tmp_path_factory.mktemp("complete"), Hidden())


def examined(files: tuple[Path, Path]) -> tuple[Any, tuple[str, ...]]:
    """Return the diagnosis of a campaign, and remarks on its hits."""
    path, nominal = files
    return examine_structure(
        path, nominal, without=frozenset(), progress=lambda line: None
    )


def test_a_loose_bolt_is_named_with_its_factor(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One command: verdict, bolt, factor within its interval, report and JSON."""
    path, nominal = write_campaign(tmp_path, Hidden(loose=(1.0, 1.0, 0.1, 1.0)))
    report, target = tmp_path / "gap.html", tmp_path / "gap.json"
    found = run_gap(
        path,
        model=nominal,
        # They take most of the computing time.
        without="hidden_mode,microslip,macroslip,clearance,cubic,quadratic,damping_law",
        report=report,
        json_target=str(target),
    )
    assert found.verdict is Finding.NAMED
    (effect,) = found.effects
    assert (effect.name, effect.site) == ("loose_bolt", "bolt:2")
    (factor,) = effect.parameters
    assert abs(factor.value - 0.1) < 3 * factor.sd
    assert found.shrink > 0.9
    shown = capsys.readouterr().out
    assert "loose bolt at bolt 2" in shown
    assert "left out r001: double" in shown
    written = json.loads(target.read_text(encoding="utf-8"))
    assert written["effects"][0]["site"] == "bolt:2"
    page = report.read_text(encoding="utf-8")
    assert "Loose bolt at bolt 2" in page
    assert page.count('id="structure"') == page.count('id="plan"') == 1


def test_nothing_is_named_where_nothing_is_missing(
    complete: tuple[Path, Path],
) -> None:
    """The base explains the hits once each is met where it landed."""
    found, remarks = examined(complete)
    assert found.verdict is Finding.NONE
    assert found.gap_before.value == 0.0
    assert [line.partition(":")[0] for line in remarks[1:]] == [
        "left out r001",
        "left out r003",
    ]


def _cut_channels(file: h5py.File) -> None:
    data = file["records/r004/data"][:2]
    del file["records/r004/data"]
    file["records/r004/data"] = data


def _nan_mode(file: h5py.File) -> None:
    file["model/top/phi_bolts"][0, 0, 0] = np.nan


def _few_modes(file: h5py.File) -> None:
    rows = file["model/bottom/phi_feet"][:, :, :-1]
    del file["model/bottom/phi_feet"]
    file["model/bottom/phi_feet"] = rows


def _text_torque(file: h5py.File) -> None:
    file["records/r000"].attrs["torque_Nm"] = "tight"


def _unknown_point(file: h5py.File) -> None:
    file["records/r000"].attrs["point"] = "P9"


def _no_list(file: h5py.File) -> None:
    file.attrs["channels"] = "{}"


def _infinite_rate(file: h5py.File) -> None:
    file.attrs["fs_hz"] = np.inf


def _no_model(file: h5py.File) -> None:
    del file["model"]


def _all_double(file: h5py.File) -> None:
    for record in file["records"].values():
        record["data"][0, 700:720] = 500_000


def _more_bolts(file: h5py.File) -> None:
    rows = file["model/top/phi_bolts"][:3]
    del file["model/top/phi_bolts"]
    file["model/top/phi_bolts"] = rows


def _flat_nodes(file: h5py.File) -> None:
    file["model/top/nodes_m"] = np.zeros((40, 2))


def _nodes_alone(file: h5py.File) -> None:
    file["model/top/nodes_m"] = np.zeros((40, 3))


@pytest.mark.parametrize(
    ("spoil", "error", "words"),
    [
        (_cut_channels, FormatError, "a row for each of 4 channels is required"),
        (_nan_mode, BadData, "NaN or infinite numbers in 'phi_bolts'"),
        (_few_modes, FormatError, "'phi_feet' of shape"),
        (_text_torque, FormatError, "a number is required"),
        (_unknown_point, FormatError, "the nominal parameters have P1, P2"),
        (_no_list, FormatError, "a list of 2 to"),
        (_infinite_rate, FormatError, "it must be finite"),
        (_no_model, FormatError, "no group 'model'"),
        (_all_double, BadData, "2 or more are required"),
        (_more_bolts, FormatError, "store the same bolts for both bodies"),
        (_flat_nodes, FormatError, "rows of x, y and z are read"),
        (_nodes_alone, FormatError, "'phi_nodes'"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_in_one_line(
    complete: tuple[Path, Path],
    tmp_path: Path,
    spoil: Callable[[h5py.File], None],
    error: type[JointbenchError],
    words: str,
) -> None:
    """The message names file, part and rule."""
    path = tmp_path / "hits.h5"
    shutil.copy(complete[0], path)
    with h5py.File(path, "r+") as file:
        spoil(file)
    with pytest.raises(error, match=words) as caught:
        examined((path, complete[1]))
    assert "\n" not in str(caught.value)
    assert "hits.h5" in str(caught.value)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("plate_damping_ratio", -1.0, "plate_damping_ratio"),
        ("tilt_sigma_deg", float("nan"), "tilt_sigma_deg"),
        ("joint_per_bolt", {}, "joint_per_bolt"),
        ("schema", "bench-sheet/9", "schema"),
    ],
)
def test_nominal_parameters_that_break_a_rule_are_refused_with_their_key(
    complete: tuple[Path, Path], tmp_path: Path, key: str, value: Any, words: str
) -> None:
    """The message names the key, the value and the rule in one line."""
    nominal = tmp_path / "sheet.json"
    nominal.write_text(json.dumps(nominal_content() | {key: value}), encoding="utf-8")
    with pytest.raises(BadData, match=words) as caught:
        examined((complete[0], nominal))
    assert "\n" not in str(caught.value)


def test_a_campaign_without_nominal_parameters_asks_for_one(
    complete: tuple[Path, Path], tmp_path: Path
) -> None:
    """Without a file of nominal parameters the message names the option."""
    path = tmp_path / "hits.h5"
    shutil.copy(complete[0], path)
    with pytest.raises(UsageError, match=r"add --model SHEET\.json"):
        run_gap(path, without=None, report=None, json_target=None)


def test_options_of_other_benches_are_refused(complete: tuple[Path, Path]) -> None:
    """Curves belong to lumped benches."""
    with pytest.raises(UsageError, match="do not apply to bolted bodies"):
        run_gap(
            complete[0],
            model=complete[1],
            without=None,
            curves=True,
            report=None,
            json_target=None,
        )


def test_an_effect_that_is_taken_out_is_not_named(complete: tuple[Path, Path]) -> None:
    """An unknown name of --without is refused with the names there are."""
    path, nominal = complete
    with pytest.raises(UsageError, match="loose_bolt"):
        examine_structure(
            path, nominal, without=frozenset({"loose"}), progress=lambda line: None
        )


def test_nominal_parameters_are_found_beside_the_campaign(
    complete: tuple[Path, Path], tmp_path: Path
) -> None:
    """NAME.sheet.json of `record` goes before sheet.json of the folder."""
    campaign = tmp_path / "hits.h5"
    campaign.write_bytes(complete[0].read_bytes())

    def examine() -> None:
        nominal = nominal_beside(campaign)
        examine_structure(
            campaign, nominal, without=frozenset({"-"}), progress=lambda line: None
        )

    with pytest.raises(UsageError, match=r"no 'hits\.sheet\.json' or 'sheet\.json'"):
        examine()
    (tmp_path / "sheet.json").write_bytes(complete[1].read_bytes())
    with pytest.raises(UsageError, match="loose_bolt"):
        examine()
    (tmp_path / "hits.sheet.json").write_text("{}", encoding="utf-8")
    with pytest.raises(BadData, match=r"hits\.sheet\.json"):
        examine()
