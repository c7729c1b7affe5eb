"""A block on a bed, whose test is designed."""

from pathlib import Path

import pytest
from marble_block import marble_block

DESIGN = """
[identify]
modes = 10
stiffness_box = ["1 MN/m", "1 GN/m"]
modulus_sd = { block = "3 %" }

[design]
sensors = 3
hits = 2
band = ["100 Hz", "3000 Hz"]
duration = "100 ms"

[design.stiffness]
"bed.normal" = "300 MN/m"
"bed.tangential_1" = "100 MN/m"
"bed.tangential_2" = "80 MN/m"

[design.damping]
"bed.normal" = "2 kN s/m"
"bed.tangential_1" = "1 kN s/m"
"bed.tangential_2" = "1 kN s/m"
"""
POINTS = [
    ("a", (0, 0, 50), (0, 0, 1)),
    ("b", (200, 100, 50), (0, 0, 1)),
    ("c", (200, 50, 50), (1, 0, 0)),
    ("d", (100, 100, 50), (0, 1, 0)),
    ("e", (100, 50, 50), (0, 0, 1)),
]


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A block on a bed, with five points within reach."""
    text = marble_block(DESIGN, loss_factor=0.01) + "".join(
        f'\n[reachable.{name}]\nbody = "block"\ndirection = {list(way)}\n'
        f"position = {[f'{x} mm' for x in at]}\n"
        for name, at, way in POINTS
    )
    path = tmp_path / "block.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def measured_block(model: Path) -> Path:
    """The block as it was measured at 20 N m: one sensor, one hit point."""
    text = model.read_text(encoding="utf-8")
    text = text.replace("[design]\n", '[design]\ntorque = "20 N m"\n')
    place = 'body = "block"\nposition = ["{} mm", "{} mm", "50 mm"]\n'
    text += "\n[sensors.a1]\ndirection = [0, 0, 1]\n" + place.format(0, 0)
    text += "\n[hits.1]\ndirection = [0, 0, 1]\n" + place.format(200, 100)
    model.write_text(text, encoding="utf-8")
    return model
