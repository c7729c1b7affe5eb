"""The joint of meshed bodies as the structure of a chain."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import write_session
from jointbench.analysis.gap.chain.moved_quantities import MovedStiffness
from jointbench.station.chain.identified_chain import moved_body_modes, read_identified
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.structure_model import StructureModel

MODEL = """
[materials.marble]
youngs_modulus = "55 GPa"
poisson_ratio = 0.25
density = "2600 kg/m^3"

[bodies.block]
box = ["200 mm", "100 mm", "50 mm"]
cells = [2, 1, 1]
material = "marble"

[joints.bed]
between = ["block", "ground"]
face = "z-"

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
"""
RATE = 4096.0
MASS = 2600.0 * 0.2 * 0.1 * 0.05
PRELOAD = np.array([2e3, 6e3, 18e3])
STIFFNESS = np.array([2.0e6, 3.2e6, 4.8e6])


def frequencies(stiffness: float) -> np.ndarray:
    """Return those of a rigid block on normal springs whose foot cannot slide [Hz].

    It rocks about either edge of its foot, and moves up and down: k l^2/12 against
    m (l^2/12 + h^2/3).
    """
    lengths, height = np.array([0.1, 0.2]), 0.05
    share = (lengths**2 / 12) / (lengths**2 / 12 + height**2 / 3)
    return np.sqrt(np.append(share, 1.0) * stiffness / MASS) / (2 * np.pi)


def recording(number: int) -> Recording:
    """Return three hits on a corner of the block at one preload."""
    rng, time = np.random.default_rng(number), np.arange(int(3 * RATE)) / RATE
    force, rings = (rng.normal(0.0, 1e-3, time.size) for _ in range(2))
    for begin in (0.1, 1.1, 2.1):
        since = time - begin
        on = (since >= 0.0) & (since < 0.001)
        force[on] += 50.0 * np.sin(np.pi * since[on] / 0.001)
        late = np.maximum(since - 0.0005, 0.0)
        for one in 2 * np.pi * frequencies(float(STIFFNESS[number])):
            wave = np.exp(-0.01 * one * late) * np.sin(one * late)
            rings += 5.0 * wave * (since > 0.0005)
    channels = (
        Channel("force", Quantity.FORCE, point="1"),
        Channel("a1", Quantity.ACCELERATION, point="1"),
    )
    return Recording(
        f"run-{number}",
        np.array([force, rings]),
        RATE,
        channels,
        preload=float(PRELOAD[number]),
    )


def written(folder: Path) -> tuple[Path, Path]:
    """Write session and model."""
    session, model = folder / "block.h5", folder / "block.toml"
    rows = tuple(map(recording, range(PRELOAD.size)))
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
    assert moved[0].after == pytest.approx(frequencies(STIFFNESS[0]), rel=0.005)
    assert moved[0].before == pytest.approx(2 * moved[0].after, rel=0.02)


def test_the_joint_of_a_chain_must_be_one_of_the_model(tmp_path: Path) -> None:
    """The message names the joints that have parameters."""
    model = tmp_path / "block.toml"
    model.write_text(MODEL.replace('link = "bed"', 'link = "lid"'), encoding="utf-8")
    with pytest.raises(BadData, match=r"'lid'.*\['bed'\]"):
        read_toml(model, StructureModel)
