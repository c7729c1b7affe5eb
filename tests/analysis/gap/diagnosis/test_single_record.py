"""A long record of one input and one output: cut, diagnosed, scored on the rest."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.signal

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, SamplingError
from jointbench.analysis.gap.diagnosis.single_record import (
    SingleRecord,
    Stretch,
    diagnose_record,
    stretch_campaign,
)
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.model.nominal import NominalParameters
from jointbench.analysis.lumped.lumped_model import (
    Body,
    Link,
    LumpedModel,
    Output,
    ResponseChannel,
)

RATE = 1000.0
NOMINAL = NominalParameters(
    LumpedModel(
        bodies=(Body("body", 1.0, 0.3),),
        links=(Link("joint", ("ground", "body"), 1e5, 12.0, 0.3, 0.3, joint=True),),
        channels=(ResponseChannel("y", "body"),),
        output=Output.DISPLACEMENT,
    ),
    {},
    repeatability=3e-3,
)
TRAINING = Stretch("training", (1000, 3000), 1500, lead=800)
SCORED = Stretch("scored", (5000,), 1500, lead=800)


def linear_record(*, noise: float = 2e-3) -> tuple[SingleRecord, FloatArray]:
    """Return a band-limited record of 1 kg on 1.1e5 N/m, and its noise."""
    rng = np.random.default_rng(5)
    up = 16
    sos = scipy.signal.butter(8, 120.0, fs=RATE * up, output="sos")
    u = scipy.signal.sosfiltfilt(sos, rng.standard_normal(7000 * up))
    system = ([1.0], [1.0, 14.0, 1.1e5])
    _, y, _ = scipy.signal.lsim(system, u, np.arange(u.size) / (RATE * up))
    force, clean = u[::up] / u.std(), y[::up] / u.std()
    added = noise * clean.std() * rng.standard_normal(clean.size)
    return SingleRecord("made", force, clean + added, RATE), added


def test_a_linear_record_needs_no_effect_and_its_error_is_the_noise() -> None:
    """On samples not used for the fit, the error of the base is the added noise."""
    record, added = linear_record()
    found, (score,) = diagnose_record(record, TRAINING, (SCORED,), NOMINAL)
    assert found.verdict is Finding.NONE
    assert found.effects == ()
    own = float(np.std(added[5000:6436]))
    assert score.before == pytest.approx(own, rel=0.05)
    assert score.after == pytest.approx(score.before, rel=0.01)
    estimate = {one.name: one.value for one in found.base}
    assert estimate["k_joint"] / estimate["body"] == pytest.approx(1.1e5, rel=1e-3)


def test_the_lead_is_simulated_and_not_scored() -> None:
    """It precedes each start; its samples have no weight."""
    record, _ = linear_record()
    campaign = stretch_campaign(record, TRAINING, NOMINAL)
    assert campaign.force.shape == (2, 2300)
    assert campaign.lead == 800
    np.testing.assert_array_equal(campaign.force[1, 800:], record.excitation[3000:4500])


@pytest.mark.parametrize(
    "stretch",
    [replace(SCORED, starts=(100,)), replace(SCORED, starts=(6000,))],
)
def test_a_stretch_beyond_the_record_is_refused(stretch: Stretch) -> None:
    """Before its first sample, or after its last."""
    record, _ = linear_record()
    with pytest.raises(SamplingError, match=r"'scored'.*shorten"):
        stretch_campaign(record, stretch, NOMINAL)


def test_rows_of_other_lengths_and_nan_are_refused() -> None:
    """Samples are never filled in."""
    row = np.zeros(100)
    with pytest.raises(SamplingError, match="same length"):
        SingleRecord("r", row, row[1:], RATE)
    with pytest.raises(BadData, match="NaN"):
        SingleRecord("r", row, np.where(np.arange(100) == 3, np.nan, row), RATE)
