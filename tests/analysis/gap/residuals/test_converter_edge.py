# SPDX-License-Identifier: MIT
"""The end of the converter's pass band, which no data sheet gives, is estimated."""

from dataclasses import replace
from pathlib import Path

import gap_bench as made
import numpy as np
import pytest
from short_campaigns import write_short

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.residuals.bench_noise import refine_noise
from jointbench.analysis.gap.residuals.converter_edge import with_converter_edge
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.response.excitation import pass_band_end
from jointbench.simulators.campaigns.campaign_records import SimulatedCampaign
from jointbench.simulators.hidden.campaign_design import draw_design
from jointbench.simulators.hidden.campaign_response import simulate_records
from jointbench.simulators.hidden.hidden_effects import HiddenEffect
from jointbench.simulators.measuring.converter import AntiAlias

BASE = made.BASE
STOP = [3e7, 3e-6]
EARLY = AntiAlias(oversampling=16, pass_band=0.395, stop_band=0.445, attenuation=90.0)
NOISE = 0.02
LAWS = ("gap", "cubic_stiffness", "quadratic_stiffness", "quadratic_damping", "delay")
ENTRIES = tuple(e for e in CATALOGUE if e.effect.name in LAWS)
"""The stop, and effects that could compensate an error of filter or integration."""


def lines_of(bench: LumpedBench) -> FloatArray:
    """Return the lines over the sample rate."""
    count = len(bench.excitation.taper)
    return np.linspace(0.0, 0.5, count)


def early_end(frequency: FloatArray) -> FloatArray:
    """Return a filter with a lower pass-band end than the default."""
    return np.asarray(0.5 - 0.5 * np.tanh((frequency - 0.415) / 0.012))


def bench_of_a_stop() -> LumpedBench:
    """Return hits on a joint with a stop, recorded through the lower filter."""
    bench = make_bench(made.quiet_campaign())
    stop = made.term_of(bench, "gap", "link:joint", STOP)
    taper = early_end(lines_of(bench))
    early = replace(bench, excitation=replace(bench.excitation, taper=taper))
    clean = early.response(BASE, [stop])
    rng = np.random.default_rng(7)
    return make_bench(
        made.quiet_campaign(clean + NOISE * rng.standard_normal(clean.shape))
    )


def test_the_filter_is_found_in_the_band_excited_by_a_stop() -> None:
    """Within a tenth from 0.38 to 0.45."""
    bench = bench_of_a_stop()
    stop = made.term_of(bench, "gap", "link:joint", STOP)
    taper = refine_noise(bench, BASE, [stop]).excitation.taper
    frequency = lines_of(bench)
    inside = (frequency > 0.38) & (frequency < 0.45)
    assert np.abs(taper - pass_band_end(frequency))[inside].max() > 0.5
    assert taper[inside] == pytest.approx(early_end(frequency)[inside], abs=0.1)


def test_without_a_nonlinear_law_the_filter_is_the_default() -> None:
    """The filter is the same for force and response; an earlier estimate is dropped."""
    bench = bench_of_a_stop()
    stop = made.term_of(bench, "gap", "link:joint", STOP)
    found = with_converter_edge(bench, BASE, [stop])
    plain = with_converter_edge(found, BASE, [])
    frequency = lines_of(bench)
    assert np.abs(found.excitation.taper - pass_band_end(frequency)).max() > 0.5
    assert plain.excitation.taper == pytest.approx(pass_band_end(frequency))


def test_a_large_stop_seen_through_a_low_filter_is_named(tmp_path: Path) -> None:
    """Named alone: filter and integration leave no error that a second law explains."""
    stop = HiddenEffect("gap", {"g": 3e-6, "k": 3e7})
    design = draw_design(941, grid="small", noise=NOISE)
    force, clean = simulate_records(design, [stop], converter=EARLY)
    rng = np.random.default_rng(8)
    force += 0.4 * NOISE * rng.standard_normal(force.shape)
    clean += NOISE * rng.standard_normal(clean.shape)
    seen = SimulatedCampaign(design, (stop,), (), force, clean)
    path = tmp_path / "early.h5"
    write_short(seen, path)
    found = diagnose(read_campaign(path), entries=ENTRIES)
    assert found.gap_before.chi2_per_dof > 1000.0
    assert [e.name for e in found.effects] == ["gap"]
    assert found.verdict is Finding.NAMED
