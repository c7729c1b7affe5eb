# SPDX-License-Identifier: MIT
"""Roving hammers and mixed roving through the chain and the door of `modal`."""

import json
from pathlib import Path

import numpy as np
import pytest
from hammered_structures import Bench, Strike, prescribed, strike
from typer.testing import CliRunner

from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import write_session
from jointbench.station.main import app

FREQUENCY = np.array([60.0, 140.0, 260.0])


def recorded(*strikes: Strike) -> tuple[Recording, ...]:
    """Return hits on three modes of 2 %."""
    rng = np.random.default_rng(8)
    structure = prescribed(FREQUENCY, np.full(3, 0.02), 5, rng)
    return strike(structure, strikes, Bench(hits=2), rng).recordings


@pytest.mark.parametrize(
    ("hit", "moved", "outputs", "inputs"),
    [((0, 1, 2, 3, 4), (), 1, 5), ((0, 1, 2), (3, 4), 5, 1)],
    ids=["roving hammer", "mixed roving"],
)
def test_modal_takes_roving_sessions(
    tmp_path: Path,
    hit: tuple[int, ...],
    moved: tuple[int, ...],
    outputs: int,
    inputs: int,
) -> None:
    """Three modes; what was taken by reciprocity is in the notes."""
    strikes = [Strike(point, (0,), ("a1",)) for point in hit]
    strikes += [Strike(0, (point,), ("a1",)) for point in moved]
    session, target = tmp_path / "roving.h5", tmp_path / "modes.json"
    content = Session(
        uuid="0000-1",
        created="2026-03-01T12:00:00+00:00",
        software="jointbench 0.1.0",
        simulated=True,
        recordings=recorded(*strikes),
    )
    write_session(content, session)
    arguments = ["modal", str(session), "--order", "20", "--json", str(target)]
    assert CliRunner().invoke(app, arguments).exit_code == 0
    found = json.loads(target.read_text())
    assert [m["frequency_hz"] for m in found["modes"]] == pytest.approx(
        FREQUENCY, rel=2e-3
    )
    assert (len(found["outputs"]), len(found["inputs"])) == (outputs, inputs)
    turned = [note for note in found["notes"] if "by reciprocity" in note]
    assert len(turned) == bool(moved)
