"""The joint of meshed bodies as the structure of a chain."""

from pathlib import Path

import numpy as np
import pytest
from marble_block import block_frequencies, block_recording, marble_block

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import write_session
from jointbench.analysis.gap.chain.moved_quantities import MovedStiffness
from jointbench.station.chain.identified_chain import moved_body_modes, read_identified
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.structure_model import StructureModel

MODEL = marble_block("""
[identify]
data = "frequencies"
modes = 6
band = ["60 Hz", "500 Hz"]
frequency_sd = "0.5 %"
sought = ["bed.normal"]
known = { "bed.tangential_1" = "1 GN/m", "bed.tangential_2" = "1 GN/m" }
stiffness_box = ["1 MN/m", "1 GN/m"]

[bolted_joint]
link = "bed"
bolts = 4
diameter = "8 mm"
area = "200 cm^2"
modulus = "55 GPa"
poisson = 0.25
hardness = "1.5 GPa"
""")
PRELOAD = np.array([2e3, 6e3, 18e3])
STIFFNESS = np.array([2.0e6, 3.2e6, 4.8e6])


def written(folder: Path) -> tuple[Path, Path]:
    """Write session and model."""
    session, model = folder / "block.h5", folder / "block.toml"
    rows = tuple(
        block_recording(number, stiffness, preload)
        for number, (stiffness, preload) in enumerate(
            zip(STIFFNESS.tolist(), PRELOAD.tolist(), strict=True)
        )
    )
    write_session(
        Session("1", "2026-01-01T00:00:00Z", "test", True, recordings=rows), session
    )
    model.write_text(MODEL, encoding="utf-8")
    return session, model


def test_a_meshed_block_gives_the_stiffness_of_its_joint_over_the_preload(
    tmp_path: Path,
) -> None:
    """Within 1 % of the rigid block's (modes 0.5 %), and its modes move with it."""
    session, model = written(tmp_path)
    table = read_toml(model, StructureModel).bolted_joint
    assert table is not None
    found = read_identified([session], model, table, None)
    assert found.states.preload == pytest.approx(PRELOAD)
    read = np.exp(found.reading.before.log_stiffness)
    assert read == pytest.approx(STIFFNESS, rel=0.01)
    assert found.reading.before.test.passed
    moved = moved_body_modes(
        found,
        MovedStiffness(PRELOAD, read, 0 * read, 4 * read, read, 0 * read),
    )
    assert moved[0].after == pytest.approx(block_frequencies(STIFFNESS[0]), rel=0.005)
    assert moved[0].before == pytest.approx(2 * moved[0].after, rel=0.02)


def test_the_joint_of_a_chain_must_be_one_of_the_model(tmp_path: Path) -> None:
    """The message names the joints that have parameters."""
    model = tmp_path / "block.toml"
    model.write_text(MODEL.replace('link = "bed"', 'link = "lid"'), encoding="utf-8")
    with pytest.raises(BadData, match=r"'lid'.*\['bed'\]"):
        read_toml(model, StructureModel)
