"""The plant against the development campaigns, made by an integrator it never met."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

from jointbench.simulators.measuring.converter import AntiAlias, decimate
from jointbench.simulators.mechanics.joint_laws import JointLaw, LawKind
from jointbench.simulators.mechanics.plant import Plant, PlantLink, two_bodies
from jointbench.simulators.mechanics.plant_integration import step_plant
from jointbench.simulators.mechanics.sliders import jenkins_bank

DATA = Path(__file__).parents[4] / "shared" / "data" / "gap-campaigns"
RATE, OVERSAMPLING = 16384.0, 16
# The development filter is closed by 0.4375 of the rate.
FILTER = AntiAlias(
    oversampling=OVERSAMPLING, pass_band=0.42, stop_band=0.46, attenuation=100.0
)

pytestmark = pytest.mark.skipif(
    not DATA.exists(), reason=f"development campaigns are not at {DATA}"
)


def _half_steps(force):
    """Interpolate a recorded hit band-limited to every half step of the plant."""
    peak = int(np.argmax(force))
    gated = np.zeros(force.size + 256)
    gated[peak - 64 : peak + 64] = force[peak - 64 : peak + 64]
    fine = gated.size * 2 * OVERSAMPLING
    spectrum = np.zeros(fine // 2 + 1, dtype=complex)
    spectrum[: gated.size // 2 + 1] = np.fft.rfft(gated)
    return np.append(np.fft.irfft(spectrum, fine) * 2 * OVERSAMPLING, 0.0)


def _chi2(case, change):
    """Squared residual over the noise, at the true values, mean over all records."""
    truth = json.loads((DATA / "truth.json").read_text())[case]
    plant = two_bodies(**truth["physical"])
    (parameters,) = truth["effects"].values() or ({},)
    plant = change(plant, parameters)
    total = []
    with h5py.File(DATA / f"{case}.h5") as file:
        for record in file["records"].values():
            acceleration, _ = step_plant(
                plant,
                _half_steps(record["force"][:].astype(float)),
                body=int(record.attrs["hit_dof"]),
                time_step=1 / (RATE * OVERSAMPLING),
            )
            (samples,) = decimate([acceleration[:2]], FILTER)
            residual = record["accel"][:, :1900] - samples[:, :1900]
            total.append(np.mean(residual**2) / truth["noise_rms"] ** 2)
    return float(np.mean(total))


def _with_law(plant, law, *, taken=0.0):
    ground, joint = plant.links
    own = PlantLink(joint.first, joint.second, joint.stiffness - taken, joint.damping)
    return Plant(plant.masses, (ground, own), (law,))


CHANGES = {
    "case_08": lambda m, p: _with_law(
        m, JointLaw(LawKind.ODD_POWER, 0, 1, (p["k3"], 3.0))
    ),
    "case_10": lambda m, p: _with_law(
        m, JointLaw(LawKind.STOP, 0, 1, (p["k"], p["g"]))
    ),
    "case_13": lambda m, p: _with_law(
        m,
        JointLaw(
            LawKind.SLIDERS,
            0,
            1,
            sliders=jenkins_bank(kt=p["kt"], slip_force=p["Fs"], sharpness=12.0),
        ),
        taken=p["kt"],
    ),
    "case_00": lambda m, p: _with_law(
        m, JointLaw(LawKind.MAXWELL, 0, 1, (p["k"], p["tau"]))
    ),
    "case_12": lambda m, p: _with_law(
        m, JointLaw(LawKind.SQUARE_DAMPING, 0, 1, (p["c"],))
    ),
    "case_15": lambda m, p: _with_law(
        m,
        JointLaw(LawKind.BOUC_WEN, 0, 1, (p["k"], p["n"], p["b"], p["g"], p["zy"])),
        taken=p["k"],
    ),
}


@pytest.mark.parametrize("case", CHANGES)
def test_the_plant_at_the_true_values_leaves_only_noise(case):
    """chi2 per sample within 5 % of 1: force noise adds a little, errors nothing."""
    assert abs(_chi2(case, CHANGES[case]) - 1) < 0.05
