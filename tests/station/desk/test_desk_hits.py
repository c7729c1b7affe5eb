# SPDX-License-Identifier: MIT
"""Hits on the modal desk: dropped afterwards, and what reads the choices."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import jointbench as jb
from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.desk.desk_results import chosen_at_desk
from jointbench.station.library.desks import ModalDesk

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of the session of the joint example."""
    path = tmp_path_factory.mktemp("desk") / "session.h5"
    shutil.copy(ROOT / "examples" / "joint" / "session.h5", path)
    return path


@pytest.fixture(scope="module")
def opened(session: Path) -> ModalDesk:
    """Return the desk with it."""
    return jb.desk(session, who="A. Person")


def test_a_dropped_hit_leaves_the_average_and_undo_brings_it_back(
    opened: ModalDesk,
) -> None:
    """One hit fewer, its reason names the person; taken back, the same modes."""
    chain = opened.state.chain
    hits = [h for r in chain.recordings for h in r.hits]
    good = next(i for i, h in enumerate(hits) if h.verdict == "ok")
    dropped = opened.drop_hit(good + 1)
    now = [h for r in dropped.state.chain.recordings for h in r.hits][good]
    assert now.verdict == "operator"
    assert now.reason == "dropped at the desk by A. Person"
    assert dropped.state.chain.frf.averages < chain.frf.averages
    back = dropped.undo().state.chain.result.model.natural_frequency
    assert np.array_equal(back, chain.result.model.natural_frequency)
    with pytest.raises(UsageError, match="hits on the desk"):
        opened.drop_hit(10**4)


def test_identify_uses_the_modes_chosen_at_the_desk(
    opened: ModalDesk, session: Path
) -> None:
    """As long as the session is the same; a changed file has no choices."""
    frequency = float(opened.state.chain.result.model.natural_frequency[0])
    assert chosen_at_desk([session]) is None
    desk = opened.choose(frequency)
    results = desk.save()
    chain = chosen_at_desk([session])
    assert chain is not None
    own = desk.state.chain.result.model.natural_frequency
    assert np.array_equal(chain.result.model.natural_frequency, own)
    other = session.with_name("other.h5")
    shutil.copy(ROOT / "examples" / "campaign" / "session.h5", other)
    shutil.copy(results, other.with_name("other.results.h5"))
    assert chosen_at_desk([other]) is None
