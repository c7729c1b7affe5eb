"""Bodies of another thickness, against the modes of a free block (Ritz's method)."""

from pathlib import Path

import numpy as np
from bolted_plates import write_model

from jointbench.simulators.flexible.block_modes import ElasticBlock, block_modes
from jointbench.station.bolted.free_bodies import bolted_model


def test_each_mode_grows_with_the_thickness_as_that_of_a_block(tmp_path: Path) -> None:
    """Bending and twisting of a plate 13 % thicker, on a coarse mesh, within 0.5 %."""
    _, model = write_model(tmp_path)
    plain = bolted_model(model, tmp_path).bodies
    thick = plain.thickness["upper"](1.13)
    grown = []
    for bodies, thickness in ((plain, 0.01), (thick, 0.0113)):
        block = ElasticBlock((0.16, 0.08, thickness), 206e9, 0.3, 7850.0)
        wanted = block_modes(block, terms=(13, 9, 5), elastic=3).frequency[6:]
        own = np.sort(bodies.omega[bodies.body == 1]) / (2 * np.pi)
        grown.append((own[own > 1.0][:3], wanted))
    (first, wanted_first), (second, wanted_second) = grown
    ratio = wanted_second / wanted_first
    np.testing.assert_allclose(second / first, ratio, rtol=5e-3)
    assert ratio[0] > 1.1
