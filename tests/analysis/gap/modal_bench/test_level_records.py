"""Records at several levels: base of modes, response at ports, noise, periods."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.integrate
import scipy.interpolate

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, SamplingError, UsageError
from jointbench.analysis.gap.modal_bench.base_from_records import (
    BaseRequest,
    base_from_records,
)
from jointbench.analysis.gap.modal_bench.level_records import (
    LevelRecord,
    Port,
    RecordSet,
)
from jointbench.analysis.gap.modal_bench.modal_base import ModalBase, UnitModes
from jointbench.analysis.gap.modal_bench.modal_bench import ModalBench, make_modal_bench
from jointbench.analysis.gap.modal_bench.periods import one_period
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL, Resolution
from jointbench.analysis.lumped.lumped_model import Output

RATE, SAMPLES = 400.0, 1024
MASS = np.diag([1.0, 0.5])
STIFFNESS = np.array([[4e4, -1.5e4], [-1.5e4, 1.5e4]])
DAMPING = 2e-4 * STIFFNESS
CUBIC = 5e8
"""Between the two masses [N/m^3]."""
PORT = Port("joint", ("a1", "a2"))


def noise_force(rms: float, seed: int) -> FloatArray:
    """Return band-limited noise of 2 to 60 Hz that begins and ends at zero."""
    rng = np.random.default_rng(seed)
    lines = np.fft.rfftfreq(SAMPLES, 1 / RATE)
    spectrum = ((lines > 2.0) & (lines < 60.0)) * np.exp(6.3j * rng.random(lines.size))
    force = np.fft.irfft(spectrum, SAMPLES)
    n = np.arange(SAMPLES)
    ramp = np.sin(0.5 * np.pi * np.minimum(1.0, np.minimum(n, n[::-1]) / 80)) ** 2
    return np.asarray(ramp * force * rms / force.std())


def motion_of(force: FloatArray, cubic: float) -> FloatArray:
    """Return the displacements of both masses by an integrator of scipy."""
    up = 8
    fine = np.fft.irfft(np.fft.rfft(force), SAMPLES * up) * up
    time = np.arange(SAMPLES * up) / (RATE * up)
    push = scipy.interpolate.CubicSpline(time, fine)

    def slope(t: float, y: FloatArray) -> FloatArray:
        f = -STIFFNESS @ y[:2] - DAMPING @ y[2:]
        spring = cubic * (y[1] - y[0]) ** 3
        f += np.array([float(push(t)) + spring, -spring])
        return np.concatenate([y[2:], f / np.diag(MASS)])

    found = scipy.integrate.solve_ivp(
        slope,
        (0.0, time[-1]),
        np.zeros(4),
        method="DOP853",
        t_eval=np.arange(SAMPLES) / RATE,
        rtol=1e-6,
        atol=1e-12,
    )
    return np.asarray(found.y[:2])


def records(cubic: float = CUBIC, noise: float = 2e-7) -> RecordSet:
    """Return three levels, the last one held out."""
    rng = np.random.default_rng(1)
    rows = []
    for k, level in enumerate((0.3, 3.0, 5.0)):
        force = noise_force(level, k)
        motion = motion_of(force, cubic)
        motion = motion + noise * rng.standard_normal(motion.shape)
        rows.append(
            LevelRecord(f"r{k}", f"{level:g} N", force[None], motion, held_out=k == 2)
        )
    return RecordSet(
        "two masses",
        RATE,
        ("a1", "a2"),
        ("a1",),
        (PORT,),
        tuple(rows),
        Output.DISPLACEMENT,
    )


def true_modes() -> UnitModes:
    """Return the modes of the two masses."""
    root = np.diag(1.0 / np.sqrt(np.diag(MASS)))
    values, vectors = np.linalg.eigh(root @ STIFFNESS @ root)
    omega = np.sqrt(values)
    return UnitModes(omega / (2 * np.pi), 1e-4 * omega, (root @ vectors).T)


@pytest.fixture(scope="module")
def given() -> RecordSet:
    """The records, made once."""
    return records()


@pytest.fixture(scope="module")
def found(given: RecordSet) -> tuple[ModalBase, float]:
    """The base of the lowest level."""
    return base_from_records(given, BaseRequest((2.0, 60.0), 2, beyond=False))


def true_bench(given: RecordSet) -> tuple[ModalBench, Term]:
    """Return the bench at the true modes, and the true spring."""
    base = ModalBase(given.points, true_modes(), np.full(8, 0.01))
    bench = make_modal_bench(given, base)
    spring = next(c for c in bench.candidates if c.effect.name == "cubic_stiffness")
    size = CUBIC / bench.scale(spring.effect.parameters[0].scale)
    return bench, Term(spring, np.array([size]))


def test_the_base_of_the_lowest_level_is_that_of_the_structure(
    found: tuple[ModalBase, float],
) -> None:
    """Frequencies, damping and shapes, with a scale from the driven sensor."""
    modes, truth = found[0].nominal, true_modes()
    np.testing.assert_allclose(modes.frequency, truth.frequency, rtol=2e-3)
    np.testing.assert_allclose(modes.damping, truth.damping, rtol=0.1)
    sign = np.sign(np.sum(modes.shapes * truth.shapes, axis=1, keepdims=True))
    np.testing.assert_allclose(modes.shapes * sign, truth.shapes, atol=0.01)


def test_the_response_at_a_port_is_that_of_another_integrator(
    given: RecordSet,
) -> None:
    """A cubic spring between two sensors, to 1e-3 of the response."""
    bench, spring = true_bench(given)
    left = bench.response(np.zeros(8), [spring], FULL.oversampling)
    left = left - bench.data.measured
    assert np.sqrt(np.mean(left**2)) < 1e-3 * bench.data.measured.std()


def test_a_window_takes_the_laws_along_the_measured_motion(given: RecordSet) -> None:
    """At the truth both motions are the same, so that both residuals are noise."""
    bench, spring = true_bench(given)
    bench = bench.refine(np.zeros(8), [spring])
    for resolution in (FULL, Resolution(0.005)):
        r = bench.residual(np.zeros(8), [spring], resolution)
        assert r @ r < 1.5 * bench.blocks.dof


def test_the_noise_is_that_which_was_added(given: RecordSet) -> None:
    """2e-7 m, from the top of the spectrum of the residual."""
    bench, spring = true_bench(given)
    sigma = bench.refine(np.zeros(8), [spring]).sigma
    np.testing.assert_allclose(sigma, 2e-7, rtol=0.25)


def test_scales_are_those_of_a_port(given: RecordSet) -> None:
    """The stiffness of a port is the inverse of its static compliance."""
    bench, _ = true_bench(given)
    across = np.array([-1.0, 1.0])
    compliance = across @ np.linalg.solve(STIFFNESS, across)
    assert bench.scale("stiffness@joint") == pytest.approx(1 / compliance, rel=1e-6)


def test_periods_are_averaged_and_show_the_noise() -> None:
    """Five periods after a lead; one precedes as the new lead."""
    rng = np.random.default_rng(2)
    one = np.sin(2 * np.pi * np.arange(64) / 64)
    rows = np.tile(one, 6)[None]
    noisy = rows + 0.01 * rng.standard_normal(rows.shape)
    record = one_period(LevelRecord("r", "1 N", rows, noisy, lead=64), 64)
    assert record.lead == 128
    assert record.force.shape == (1, 192)
    np.testing.assert_allclose(record.force[0, -64:], one)
    assert record.noise == pytest.approx(0.01 / np.sqrt(5), rel=0.15)


def test_a_record_without_a_whole_period_is_refused() -> None:
    """The message names the samples, the lead and the period."""
    rows = np.zeros((1, 100))
    with pytest.raises(SamplingError, match="no whole period"):
        one_period(LevelRecord("r", "1 N", rows, rows, lead=50), 64)


def test_ports_sensors_and_levels_are_checked(given: RecordSet) -> None:
    """One line each, with the way out."""
    with pytest.raises(UsageError, match="two sensors"):
        replace(given, sensors=("a1", "a1"))
    with pytest.raises(UsageError, match="'a1' and 'a9'"):
        replace(given, ports=(Port("x", ("a1", "a9")),))
    with pytest.raises(UsageError, match="held out"):
        hidden = tuple(replace(r, held_out=True) for r in given.records)
        replace(given, records=hidden)
    with pytest.raises(BadData, match="NaN"):
        replace(given.records[0], response=np.full((2, SAMPLES), np.nan))
