"""Bodies of another thickness, against the modes of a free block (Ritz's method)."""

from pathlib import Path

import numpy as np
from bolted_plates import MODEL, FullPlates, write_hits, write_model

from jointbench.acquisition.session_file.store import read_session
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.make_structure_bench import (
    make_structure_bench,
)
from jointbench.simulators.flexible.block_modes import ElasticBlock, block_modes
from jointbench.station.bolted.bolted_campaign import bolted_campaign
from jointbench.station.bolted.free_bodies import bolted_model
from jointbench.station.gap.session_hits import judged_recordings, with_preloads


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


def test_a_thicker_plate_is_no_stiffer_one(tmp_path: Path) -> None:
    """6 % of thickness in the first milliseconds: found, and no modulus explains it."""
    text = MODEL.replace('"80 mm", "10 mm"]', '"80 mm", "10.6 mm"]')
    text = text.replace('"22 mm"]', '"22.6 mm"]').replace('"17 mm"]', '"17.3 mm"]')
    _, thicker = write_model(tmp_path, text)
    write_hits(tmp_path / "hits.h5", FullPlates(thicker, {}))
    path, _ = write_model(tmp_path)
    stored = with_preloads(read_session(tmp_path / "hits.h5"), None)
    made = bolted_campaign("plates", judged_recordings(stored, []), path).campaign
    bench = make_structure_bench(made)
    nominal = np.zeros(bench.base_sd.size)
    bench = bench.at(nominal, (), bench.landing, bench.table_floor)
    fits = {
        c.effect.name: minimise(
            make_problem(bench, (c,)),
            np.append(nominal, 0.1),
            Resolution(0.006),
            iterations=6,
            exact_slopes=False,
        )
        for c in bench.candidates
        if c.effect.name in ("modulus", "thickness") and c.site.name == "upper"
    }
    assert abs(fits["thickness"].x[-1] - 0.06) < 5e-3
    assert fits["thickness"].cost < 0.1 * fits["modulus"].cost
