"""Two small plates on two joints: model files, full matrices, and hits on them."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import scipy.linalg
import scipy.sparse

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.acquisition.records.session import new_session
from jointbench.acquisition.session_file.store import write_session
from jointbench.analysis.structures.matrices.structure import Structure, pick
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.structure_model import StructureModel, structure_of

RATE, QUIET, SAMPLES = 16_384.0, 256, 1280
FINE = 8
"""Steps of the integration in a sample: a pulse of straight pieces has other lines."""
STIFFNESS = {"normal": 2e8, "tangential_1": 6e7, "tangential_2": 6e7}
DAMPING = {"normal": 200.0, "tangential_1": 100.0, "tangential_2": 100.0}
FOOT, FOOT_DAMPING, RATIO = 4e4, 30.0, 0.01
MODEL = """
[materials.steel]
youngs_modulus = "206 GPa"
density = "7850 kg/m^3"
[bodies.lower]
box = ["200 mm", "100 mm", "12 mm"]
cells = [4, 2, 1]
material = "steel"
[bodies.upper]
box = ["160 mm", "80 mm", "10 mm"]
cells = [4, 2, 1]
origin = ["20 mm", "10 mm", "12 mm"]
material = "steel"
[joints.left]
between = ["lower", "upper"]
patches = [{ rectangle = [["25 mm", "55 mm"], ["20 mm", "80 mm"]] }]
[joints.right]
between = ["lower", "upper"]
patches = [
  { rectangle = [["145 mm", "175 mm"], ["20 mm", "45 mm"]] },
  { rectangle = [["145 mm", "175 mm"], ["55 mm", "80 mm"]] },
]
[sensors.a1]
body = "upper"
position = ["30 mm", "20 mm", "22 mm"]
direction = [0, 0, 1]
[sensors.a2]
body = "lower"
position = ["190 mm", "90 mm", "0 mm"]
direction = [0, 0, 1]
[sensors.a3]
body = "upper"
position = ["20 mm", "60 mm", "17 mm"]
direction = [1, 0, 0]
[hits.1]
body = "upper"
position = ["50 mm", "70 mm", "22 mm"]
direction = [0, 0, -1]
[hits.2]
body = "upper"
position = ["180 mm", "30 mm", "17 mm"]
direction = [-1, 0, 0]
[gap]
band = "2000 Hz"
damping_ratio = "1 %"
[gap.bolt]
normal = "100 MN/m"
tangential_1 = "30 MN/m"
tangential_2 = "30 MN/m"
normal_damping = "100 N s/m"
tangential_damping = "50 N s/m"
[gap.feet]
places = [
  { body = "lower", position = ["10 mm", "10 mm", "0 mm"] },
  { body = "lower", position = ["190 mm", "10 mm", "0 mm"] },
  { body = "lower", position = ["100 mm", "90 mm", "0 mm"] },
]
stiffness = "40 kN/m"
damping = "30 N s/m"
"""
"""The right joint has two patches, each with the values of [gap.bolt]; the left one has
half the stiffness of a joint of `STIFFNESS`."""
BOLTS = {"left": 0.5, "right": 1.0}
"""Stiffness of each joint over that of two bolts."""


def write_model(folder: Path, text: str = MODEL) -> tuple[Path, StructureModel]:
    """Write and read a model file."""
    path = folder / "model.toml"
    path.write_text(text, encoding="utf-8")
    return path, read_toml(path, StructureModel)


class FullPlates:
    """The plates by their full matrices.

    Args:
        model: of the plates.
        factors: on stiffness and damping of a joint, by name.
    """

    def __init__(self, model: StructureModel, factors: Mapping[str, float]) -> None:
        self.model = model
        self.structure: Structure = structure_of(model, Path())
        size = {n: BOLTS[n] * factors.get(n, 1.0) for n in self.structure.joints}
        order = ("normal", "tangential_1", "tangential_2")
        k = [size[n] * STIFFNESS[d] for n in self.structure.joints for d in order]
        c = [size[n] * DAMPING[d] for n in self.structure.joints for d in order]
        feet = scipy.sparse.vstack(
            [
                pick(self.structure, one.body, one.position)
                for one in (
                    model.gap.feet.places if model.gap and model.gap.feet else ()
                )
            ]
        )
        square = (feet.T @ feet).toarray()
        self.mass = self.structure.mass.toarray()
        self.stiffness = self.structure.with_joints(np.array(k)).toarray()
        self.stiffness += FOOT * square
        self.damping = FOOT_DAMPING * square + self._of_bodies()
        for value, spread in zip(c, self.structure.spread, strict=True):
            self.damping += value * spread.toarray()

    def _of_bodies(self) -> FloatArray:
        """Return the modal damping of the free bodies."""
        found = np.zeros_like(self.mass)
        for low, high in zip(
            self.structure.blocks, self.structure.blocks[1:], strict=False
        ):
            own = slice(int(low), int(high))
            k, m = self.structure.stiffness[own, own], self.mass[own, own]
            value, shape = scipy.linalg.eigh(k.toarray(), m)
            pushed = m @ shape
            ratio = 2 * RATIO * np.sqrt(np.maximum(value, 0.0))
            found[own, own] = (ratio * pushed) @ pushed.T
        return found

    def rows(self, kind: str) -> FloatArray:
        """Return rows of sensors or hits along their directions, (n, n_free)."""
        tables = self.model.sensors if kind == "sensors" else self.model.hits
        return np.array(
            [
                np.asarray(one.direction) @ pick(self.structure, one.body, one.position)
                for one in tables.values()
            ]
        )

    def response(self, s: ComplexArray) -> ComplexArray:
        """Return sensors per hit at Laplace variables [m/N], (n_lines, 3, 2)."""
        struck, read = self.rows("hits").T.astype(complex), self.rows("sensors")
        return np.array(
            [
                read
                @ np.linalg.solve(
                    self.stiffness + x * self.damping + x**2 * self.mass, struck
                )
                for x in s
            ]
        )

    def accelerations(self, hit: int, force: FloatArray) -> FloatArray:
        """Return accelerations at the samples, shape (n_sensors, n_samples).

        Args:
            hit: number of the point.
            force: straight between the steps, shape (FINE n_samples,).
        """
        _, shape = scipy.linalg.eigh(self.stiffness, self.mass, subset_by_index=[0, 59])
        k, c = shape.T @ self.stiffness @ shape, shape.T @ self.damping @ shape
        column, read = shape.T @ self.rows("hits")[hit], self.rows("sensors") @ shape
        n, h = 60, 1.0 / (FINE * RATE)
        whole = np.zeros((2 * n + 2, 2 * n + 2))
        whole[:n, n : 2 * n] = np.eye(n) * h
        whole[n : 2 * n, :n], whole[n : 2 * n, n : 2 * n] = -k * h, -c * h
        whole[n : 2 * n, 2 * n], whole[2 * n, 2 * n + 1] = column * h, 1.0
        step = scipy.linalg.expm(whole)
        a, first = step[: 2 * n, : 2 * n], step[: 2 * n, 2 * n]
        slope = step[: 2 * n, 2 * n + 1]
        y, found = np.zeros(2 * n), np.zeros((len(read), force.size // FINE))
        for t in range(force.size):
            if t % FINE == 0:
                moved = column * force[t] - k @ y[:n] - c @ y[n:]
                found[:, t // FINE] = read @ moved
            after = force[t + 1] if t + 1 < force.size else 0.0
            y = a @ y + first * force[t] + slope * (after - force[t])
        return found


def write_hits(
    path: Path, plates: FullPlates, seed: int = 3, *, overwrite: bool = False
) -> None:
    """Strike both points at three levels, and write a session."""
    rng = np.random.default_rng(seed)
    t = np.arange(FINE * (SAMPLES - QUIET)) / (FINE * RATE)
    pulse = np.where(t < 6e-4, np.sin(np.pi * t / 6e-4) ** 2, 0.0)
    moved = [plates.accelerations(hit, pulse) for hit in range(2)]
    recordings = []
    for number, (hit, level) in enumerate(
        (hit, level) for hit in range(2) for level in (50.0, 200.0, 800.0)
    ):
        data = level * np.concatenate([pulse[None, ::FINE], moved[hit]])
        data = np.pad(data, ((0, 0), (QUIET, 0)))
        data += 1e-2 * rng.standard_normal(data.shape)
        channels = (
            Channel("force", Quantity.FORCE, point=str(hit + 1), unit="N"),
            *(
                Channel(name, Quantity.ACCELERATION, unit="m/s^2")
                for name in plates.model.sensors
            ),
        )
        recordings.append(
            Recording(f"r{number}", data, RATE, channels, start_time=10.0 * number)
        )
    session = new_session(source="test", simulated=True, recordings=recordings)
    write_session(session, path, overwrite=overwrite)
