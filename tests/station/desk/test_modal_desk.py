# SPDX-License-Identifier: MIT
"""The modal desk without a browser: poles chosen, cleared, merged, pinned, kept."""

from pathlib import Path

import numpy as np
import pytest
from desk_files import COLUMNS, DAMPING, FREQUENCY, write_frfs

import jointbench as jb
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.station.desk.desk_choice import (
    ChoiceAction,
    choice_steps,
    choices_of,
    effective,
    plain_who,
)
from jointbench.station.desk.desk_findings import findings_beside
from jointbench.station.desk.desk_pages import (
    diagram_page,
    evidence_page,
    summary_page,
)
from jointbench.station.desk.desk_results import DeskConflict, set_aside
from jointbench.station.desk.desk_state import made_choice
from jointbench.station.desk.desk_subject import DeskRequest, desk_subjects
from jointbench.station.desk.frf_pages import frf_page, matrix_page
from jointbench.station.desk.shape_page import shapes_page
from jointbench.station.library.desks import ModalDesk
from jointbench.station.results.results_modes import read_run


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Three files of FRFs with three known poles."""
    return write_frfs(tmp_path_factory.mktemp("desk"))


@pytest.fixture(scope="module")
def opened(files: list[Path]) -> ModalDesk:
    """Return the desk with these FRFs, nothing chosen."""
    return jb.desk(files, columns=COLUMNS, who="A. Person")


def found(desk: ModalDesk) -> np.ndarray:
    """Return the natural frequencies of the modes on a desk [Hz]."""
    return desk.state.chain.result.model.natural_frequency


def test_the_desk_begins_with_the_automatic_modes(opened: ModalDesk) -> None:
    """Three known poles to 0.01 Hz, nothing in the log."""
    assert found(opened) == pytest.approx(FREQUENCY, abs=0.01)
    assert opened.state.log == ()


def test_a_box_clears_the_poles_in_it_and_no_other(opened: ModalDesk) -> None:
    """The mode at 300 Hz is left out, and the fit without it is worse."""
    cleared = opened.clear(280.0, 320.0)
    assert found(cleared).size == 2
    before, after = (
        summary_page(d.state)["synthesis_error"] for d in (opened, cleared)
    )
    assert after > 10.0 * before


def test_a_chosen_pole_is_refined_to_the_truth(opened: ModalDesk) -> None:
    """From any order at which the pole stands: f to 0.01 Hz, zeta to 1 %."""
    for order in (12, 40):
        desk = opened.clear(250.0, 350.0).choose(300.0, order)
        model = desk.modes.chain.result.model
        assert model.natural_frequency[1] == pytest.approx(300.0, abs=0.01)
        assert model.damping_ratio[1] == pytest.approx(DAMPING[1], rel=0.01)
        assert 0.0 < model.frequency_sd[1] < 0.01
        assert list(model.by_hand) == [False, True, False]


def test_a_peak_is_chosen_once(opened: ModalDesk) -> None:
    """A second click on the same peak moves the choice to that order."""
    desk = opened.choose(300.0, 20).choose(300.0, 30)
    assert found(desk) == pytest.approx(FREQUENCY, abs=0.01)


def test_everything_can_be_cleared(opened: ModalDesk) -> None:
    """No pole is a state as any other: nothing is synthesised."""
    desk = opened.clear(1.0, 700.0)
    assert found(desk).size == 0
    assert summary_page(desk.state)["synthesis_error"] == pytest.approx(1.0)
    assert shapes_page(desk.state)["modes"] == []


def test_a_pinned_pole_keeps_frequency_and_damping(opened: ModalDesk) -> None:
    """Exactly those of its order; its sd is the scatter over the orders."""
    table = opened.state.automatic.result.stabilisation
    rows = np.flatnonzero((table.order == 30) & (np.abs(table.frequency - 520) < 5))
    row = rows[np.argmin(np.abs(table.frequency[rows] - 520))]
    model = opened.pin(520.0, 30).modes.chain.result.model
    assert model.natural_frequency[2] == pytest.approx(table.frequency[row], rel=1e-12)
    assert model.damping_ratio[2] == pytest.approx(table.damping_ratio[row], rel=1e-9)
    assert model.frequency_sd[2] > 0.0


def test_two_poles_are_merged_into_one(opened: ModalDesk) -> None:
    """Of poles at 300 and 520 Hz one is left; it needs two different ones."""
    assert found(opened.merge(300.0, 520.0)).size == 2
    with pytest.raises(UsageError, match="a merge needs two"):
        opened.merge(300.0, 300.1)


def test_undo_returns_to_the_choice_before_and_is_in_the_log(opened: ModalDesk) -> None:
    """The same modes to the last digit, and three lines with who and when."""
    once = opened.clear(250.0, 350.0)
    back = once.choose(300.0).undo()
    assert np.array_equal(found(back), found(once))
    assert [c.action for c in back.state.log] == ["clear", "choose", "undo"]
    assert {c.who for c in back.state.log} == {"A. Person"}
    with pytest.raises(UsageError, match="no choice to take back"):
        opened.undo()


def test_a_place_without_a_pole_is_refused_with_the_nearest(opened: ModalDesk) -> None:
    """One line with the way out; the log stays as it was."""
    with pytest.raises(UsageError, match="no pole within 1 % of 400 Hz"):
        opened.choose(400.0)
    with pytest.raises(UsageError, match="no pole is chosen between"):
        opened.clear(395.0, 405.0)


def test_choices_are_in_the_results_and_come_back(
    opened: ModalDesk, files: list[Path]
) -> None:
    """Who and when travel in the provenance; another desk begins where this ended."""
    desk = opened.clear(250.0, 350.0).choose(300.0, 30).pin(90.0, 20)
    written = desk.save()
    steps = read_run(written).modes[0].steps
    log = choices_of(steps)
    assert [(c.action, c.who) for c in log] == [
        ("clear", "A. Person"),
        ("choose", "A. Person"),
        ("pin", "A. Person"),
    ]
    assert all(c.when.startswith("20") for c in log)
    again = jb.desk(files, columns=COLUMNS, who="B")
    assert np.array_equal(found(again), found(desk))
    kept = set_aside(written)
    assert kept is not None and kept.name == "p1-txt.desk-1.results.h5"
    assert not written.exists()
    kept.unlink()


def test_two_desks_do_not_overwrite_each_other(
    opened: ModalDesk, files: list[Path]
) -> None:
    """The later one is refused with who chose what; what was written stays."""
    written = opened.clear(250.0, 350.0).save()
    with pytest.raises(DeskConflict, match=r"A\. Person cleared 250.*choose again"):
        opened.pin(90.0, 20).save()
    log = choices_of(read_run(written).modes[0].steps)
    assert [one.action for one in log] == ["clear"]
    again = jb.desk(files, columns=COLUMNS, who="B").pin(90.0, 20)
    again.save()
    log = choices_of(read_run(written).modes[0].steps)
    assert [(one.action, one.who) for one in log] == [
        ("clear", "A. Person"),
        ("pin", "B"),
    ]
    written.unlink()


def test_numbers_that_json_cannot_carry_are_left_out(files: list[Path]) -> None:
    """NaN and 1e999 in a file of another program; a table that is a text."""
    beside = files[0].parent
    text = '{"effects": [], "gap_before": NaN, "gap_after": 1e999, "verdict": "none"}'
    (beside / "p1.gap.json").write_text(text, encoding="utf-8")
    text = '{"parameters": "none", "verdict": "accepted"}'
    (beside / "p1.identify.json").write_text(text, encoding="utf-8")
    subject = desk_subjects(files, DeskRequest(frfs=FrfOptions(COLUMNS)))[0]
    found = findings_beside(subject)
    assert [one.kind for one in found] == ["gap"]
    assert found[0].content["gap_before"] is found[0].content["gap_after"] is None
    for name in ("gap", "identify"):
        (beside / f"p1.{name}.json").unlink()


def test_nothing_is_written_before_the_first_choice(opened: ModalDesk) -> None:
    """The results of others stay as they are."""
    with pytest.raises(UsageError, match="nothing was chosen"):
        opened.save()


def test_hover_states_uncertainty_and_collinearity(opened: ModalDesk) -> None:
    """The truth lies within six standard deviations; real shapes have an MPC of 1."""
    table = opened.state.automatic.result.stabilisation
    row = int(np.argmin(np.abs(table.frequency - 300.0) + (table.order != 30) * 1e3))
    page = evidence_page(opened.state, row)
    assert abs(page["frequency_hz"] - 300.0) < 6.0 * page["frequency_scatter_hz"] + 0.01
    assert 0.0 < page["frequency_sd_hz"] < 0.1
    assert page["mpc"] > 0.99
    with pytest.raises(UsageError, match="the diagram has"):
        opened.evidence(10**6)


def test_pages_hold_what_the_screens_draw(opened: ModalDesk) -> None:
    """Diagram, FRF, matrix and shapes agree in their sizes; nothing is infinite."""
    diagram, frf = diagram_page(opened.state), frf_page(opened.state, 1, 0)
    poles = len(diagram["order"])
    assert all(len(diagram[n]) == poles for n in ("frequency_hz", "stable", "track"))
    assert set(diagram["stable"]) <= {0, 1, 2, 3}
    assert len(frf["frequency_hz"]) == len(frf["size"]) == len(frf["fitted"])
    assert matrix_page(opened.state)["misfit"][0][0] < 0.01
    shapes = shapes_page(opened.state)
    assert [row[i] for i, row in enumerate(shapes["mac"])] == pytest.approx([1.0] * 3)
    with pytest.raises(UsageError, match="no FRF 4, 1"):
        frf_page(opened.state, 3, 0)


def test_names_cannot_forge_a_provenance() -> None:
    """A name with the marks of the provenance comes back as one plain line."""
    who = plain_who("Eve; when=never\n=x")
    assert who == "Eve, when-never -x"
    choice = made_choice(ChoiceAction.CLEAR, who, frequency=1.0, second=2.0)
    assert choices_of(choice_steps([choice])) == (choice,)


def test_undo_takes_back_one_choice_at_a_time() -> None:
    """Two undos after three choices leave the first."""
    log = [
        made_choice(ChoiceAction.CHOOSE, "a", frequency=float(i)) for i in range(1, 4)
    ]
    undo = made_choice(ChoiceAction.UNDO, "a")
    assert [c.frequency for c in effective([*log, undo, undo])] == [1.0]
