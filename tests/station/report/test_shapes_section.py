# SPDX-License-Identifier: MIT
"""Shapes drawn on a geometry and animated, and the checks beside them."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.station.pipeline.chain import ModalChain, run_chain
from jointbench.station.report.checks_section import checks_section
from jointbench.station.report.shapes_section import shapes_section
from jointbench.station.schemas.geometry_file import Geometry, draw_shapes
from jointbench.station.screen.page import figures_in, write_report
from jointbench.station.screen.page_parts import Report, Text

RATE = 2048.0
FREQUENCY, DAMPING = np.array([90.0, 240.0, 410.0]), np.array([0.01, 0.008, 0.012])
GRID = tuple((x, y) for y in (0.0, 0.1, 0.2) for x in (0.0, 0.15, 0.3))
# A plate's bending, twist and second bending at the nine points.
SHAPES = np.array([[1.0, x / 0.15 - 1.0, 1.5 * np.cos(10 * y)] for x, y in GRID]).T


def plate(*, levels: tuple[float, ...] = (30.0, 60.0, 120.0)) -> Recording:
    """One hit a second at corner 1, nine sensors."""
    time = np.arange(int(len(levels) * RATE)) / RATE
    rng = np.random.default_rng(8)
    samples = rng.normal(0.0, 2e-4, (10, time.size))
    omega = 2.0 * np.pi * FREQUENCY[:, None]
    for number, level in enumerate(levels):
        since = time - number - 0.1
        on = (since >= 0.0) & (since < 0.003)
        samples[0, on] += level * np.sin(np.pi * since[on] / 0.003)
        late = np.maximum(since - 0.0015, 0.0)
        rings = np.exp(-DAMPING[:, None] * omega * late) * np.sin(omega * late)
        samples[1:] += level / 100.0 * (SHAPES * SHAPES[:, :1]).T @ (rings * (late > 0))
    channels = [Channel("force", Quantity.FORCE, point="1")]
    channels += [
        Channel(f"a{i}", Quantity.ACCELERATION, point=str(i)) for i in range(1, 10)
    ]
    return Recording("plate", samples, RATE, tuple(channels))


def grid(**more: object) -> Geometry:
    """The nine points and the plate's outline."""
    points = {str(i): (*place, 0.0) for i, place in enumerate(GRID, 1)}
    lines = [("1", "3"), ("3", "9"), ("9", "7"), ("7", "1")]
    content = {"points": points, "lines": lines} | more
    return Geometry.model_validate(content)


@pytest.fixture(scope="module")
def chain() -> ModalChain:
    """The plate's hits taken to modes."""
    return run_chain([plate()])


def test_shapes_move_where_the_sensors_sat(chain: ModalChain) -> None:
    """The twist of mode 2, in z, largest 1; nothing moves sideways."""
    drawn = draw_shapes(chain.result.model, grid())
    model = chain.result.model
    twist = int(np.argmin(np.abs(model.natural_frequency - 240.0)))
    motion = drawn.motion[twist]
    assert np.allclose(motion[:, :2], 0.0)
    agreement = np.abs(np.vdot(motion[:, 2], SHAPES[1])) ** 2
    lengths = np.sum(np.abs(motion[:, 2]) ** 2) * np.sum(SHAPES[1] ** 2)
    assert agreement / lengths > 0.999
    assert np.max(np.abs(motion)) == pytest.approx(1.0)


def test_a_direction_turns_the_motion(chain: ModalChain) -> None:
    """A sensor that looks along -x moves its point there."""
    plain = draw_shapes(chain.result.model, grid())
    turned = draw_shapes(chain.result.model, grid(directions={"a1": "-x"}))
    assert np.allclose(turned.motion[:, 0, 0], -plain.motion[:, 0, 2])
    assert np.allclose(turned.motion[:, 0, 2], 0.0)


def test_a_point_that_the_geometry_lacks_is_named(chain: ModalChain) -> None:
    """The message names what to write."""
    points = {str(i): (0.0, 0.0, 0.0) for i in range(1, 9)}
    with pytest.raises(BadData, match="no point '9'"):
        draw_shapes(chain.result.model, Geometry.model_validate({"points": points}))


def test_a_direction_that_is_none_is_refused(chain: ModalChain) -> None:
    """Up is no axis."""
    with pytest.raises(BadData, match="'up'"):
        draw_shapes(chain.result.model, grid(directions={"1": "up"}))


def test_every_mode_is_animated_on_the_page(chain: ModalChain) -> None:
    """Frames of every mode that a menu entry plays, and a MAC with ones across."""
    section = shapes_section(chain, grid())
    plots = {p.identifier: p.figure for p in figures_in(section.items)}
    modes = chain.result.model.natural_frequency.size
    drawings = [plots[f"shapes-plot-{mode + 1}"] for mode in range(modes)]
    for drawing in drawings:
        swing, data = drawing["swing"], drawing["data"]
        assert isinstance(swing, dict)
        assert isinstance(data, list)
        moving = data[swing["trace"]]
        assert len(swing["real"]["z"]) == len(swing["imaginary"]["z"])
        assert len(swing["real"]["z"]) == len(moving["z"])
    (mac,) = plots["mac-plot"]["data"]  # type: ignore[misc]
    assert np.allclose(np.diag(np.array(mac["z"], float)), 1.0)


def test_checks_speak_of_leakage_and_linearity(chain: ModalChain) -> None:
    """Three levels of a linear plate: no dependence on level."""
    section = checks_section(chain)
    words = " ".join(item.text for item in section.items if isinstance(item, Text))
    assert "Leakage" in words
    assert "no dependence on level" in words


def test_the_page_with_moving_shapes_loads_nothing(
    chain: ModalChain, tmp_path: Path
) -> None:
    """Everything is in the file, the motion too."""
    sections = (shapes_section(chain, None), checks_section(chain))
    path = tmp_path / "page.html"
    write_report(Report("plate", "", "jointbench", True, (), sections), path)
    page = path.read_text(encoding="utf-8")
    assert '"re":[' in page
    assert "src=" not in page
