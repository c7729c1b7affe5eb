# SPDX-License-Identifier: MIT
"""Plates as the structure of a chain: two meshed stones, struck at every preload.

The measured plates have a finer mesh than the model, and lose energy in stone and
joint. Hits are pulses at two points with six accelerometers and noise; they go through
a session file, as those of a bench do: hits, FRFs, modes, joint of every state. An
effect in the plates is a stone of another modulus or a heavier accelerometer.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import write_session
from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import (
    Joint,
    PointMass,
    solid_body,
)
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    build_structure,
)
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.meshes.polygons import rectangle
from jointbench.analysis.structures.reduction.full_modes import solve_full
from jointbench.analysis.structures.reduction.mounted_sensors import (
    MountedSensor,
    sensor_rows,
)

PLATES = ("modulus", "added_mass")
PLATE_STATES = 5
"""Preloads at which the plates are struck at most."""
RATE = 16384.0
"""Of the recordings [Hz]."""
HIT = 8192
"""Samples of a hit."""
SENSOR_MASS = 0.05
"""Of a triaxial accelerometer with its magnet, by the data sheet [kg]."""
_MODES = 28
"""Modes of the measured plates, rigid ones included."""
_RIGID = 10.0
"""Angular frequency below which a mode is a rigid motion [rad/s]."""
FREQUENCY_SD = 0.005
"""What the mesh of the model is good for [-]; bending modes are up to 0.4 % high."""
_PLACES = (
    ("a1", "lower", (0.0, 0.0, 0.0), (0, 0, 1)),
    ("a2", "lower", (1.0, 1.0, 0.0), (1, 0, 0)),
    ("a3", "upper", (0.0, 0.5, 2.0), (0, 0, 1)),
    ("a4", "upper", (1.0, 0.0, 2.0), (0, 1, 0)),
    ("a5", "upper", (1.0, 1.0, 2.0), (1, 0, 0)),
    ("a6", "upper", (0.5, 1.0, 2.0), (0, 0, 1)),
    ("h1", "upper", (0.0, 0.0, 2.0), (0, 0, -1)),
    ("h2", "upper", (0.7, 0.0, 2.0), (0, 0, -1)),
)
"""Sensors and hit points: body, place in sizes of a plate, direction.

Sensors are at nodes of both meshes: their masses sit there.
"""


@dataclass(frozen=True)
class Plates:
    """Two plates on each other.

    Attributes:
        size: of the lower plate [m].
        upper: thickness of the upper plate [m].
        material: of the model.
        factors: on the moduli of the measured stones [-].
        masses: of the accelerometers as they are [kg].
        patch: sides of the contact over those of a plate [-].
        tangential: stiffness over the normal one [-].
        damping: of the joint over its stiffness [s].
    """

    size: tuple[float, float, float]
    upper: float
    material: Material
    factors: tuple[float, float]
    masses: tuple[float, ...]
    patch: tuple[float, float]
    tangential: tuple[float, float]
    damping: float

    def place(self, at: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return a place given in sizes: 1 in z is the joint, 2 the top."""
        length, width, height = self.size
        z = at[2] * height if at[2] <= 1 else height + (at[2] - 1) * self.upper
        return (at[0] * length, at[1] * width, z)

    def box(self, upper: int) -> tuple[tuple[float, float, float], float]:
        """Return size and height of the lower side of a plate [m]."""
        length, width, height = self.size
        if upper:
            return (length, width, self.upper), height
        return self.size, 0.0


@dataclass(frozen=True, eq=False)
class PlateModes:
    """Full modes of the measured plates with one joint.

    Attributes:
        omega: natural, rigid ones near 0 [rad/s], shape (n_modes,).
        shapes: at sensors and hit points [kg^-1/2], shape (n_modes, 8).
        joint: k_d phi' G_d phi of each direction [1/s^2], shape (3, n_modes).
    """

    omega: np.ndarray
    shapes: np.ndarray
    joint: np.ndarray


def draw_plates(seed: int, effect: str) -> Plates:
    """Return plates with an effect of `PLATES`, or with none."""
    rng = np.random.default_rng([seed, 31])
    size = (rng.uniform(0.34, 0.5), rng.uniform(0.2, 0.3), rng.uniform(0.03, 0.05))
    stone = Material(
        youngs_modulus=rng.uniform(5e10, 7e10),
        poisson_ratio=0.25,
        density=rng.uniform(2550.0, 2800.0),
        loss_factor=rng.uniform(0.004, 0.01),
    )
    factors, masses = [1.0, 1.0], [SENSOR_MASS] * 6
    off, extra = rng.uniform(0.08, 0.2), rng.uniform(0.14, 0.195)
    place = int(rng.integers(12))
    if effect == "modulus":
        factors[place % 2] += off * (1.0 if place < 6 else -1.0)
    if effect == "added_mass":
        masses[place % 6] += extra
    ratio = 0.84 * np.exp(0.1 * rng.standard_normal(2))
    return Plates(
        size,
        float(size[2] * rng.uniform(0.6, 0.8)),
        stone,
        (factors[0], factors[1]),
        tuple(masses),
        (float(rng.uniform(0.55, 0.8)), float(rng.uniform(0.5, 0.8))),
        (float(ratio[0]), float(ratio[1])),
        float(np.exp(rng.uniform(np.log(5e-7), np.log(3e-6)))),
    )


def middle_stiffness(plates: Plates) -> float:
    """Return a stiffness at which plate on plate is near the first bending [N/m]."""
    length, width, height = plates.size
    stone = plates.material
    speed = np.sqrt(stone.youngs_modulus / stone.density)
    first = 2 * np.pi * 1.03 * height / length**2 * speed
    return float(0.5 * stone.density * length * width * height * first**2)


def write_plates(
    plates: Plates,
    preload: np.ndarray,
    states: list[PlateModes],
    folder: Path,
    rng: np.random.Generator,
) -> tuple[Path, Path]:
    """Strike the plates at every preload; return session and model.

    Args:
        plates: that are measured.
        preload: [N], shape (n_states,).
        states: modes at each preload.
        folder: of the files.
        rng: of hits and noise.
    """
    found = []
    for p, modes in zip(preload, states, strict=True):
        response = _accelerance(plates, modes)
        for point in range(2):
            found.append(_recording(f"hit-{p:.0f}-{point}", p, point, response, rng))
    session, model = folder / "plates.h5", folder / "plates.toml"
    whole = Session("1", "2026-01-01T00:00:00Z", "count", True, recordings=tuple(found))
    write_session(whole, session)
    model.write_text(_model(plates), encoding="utf-8")
    return session, model


def full_modes(plates: Plates, stiffness: np.ndarray) -> list[PlateModes]:
    """Return the modes of every state.

    Args:
        plates: that are measured.
        stiffness: normal, of the joint [N/m], shape (n_states,).
    """
    places = [
        MountedSensor(name, body, plates.place(at), way)
        for name, body, at, way in _PLACES
    ]
    structure = _measured_plates(plates, places[:6])
    rows = sensor_rows(structure, places)
    bare = structure.with_joints(np.zeros(3))
    units = [structure.with_joints(one) - bare for one in np.eye(3)]
    found = []
    for k in stiffness:
        own = k * np.array([1.0, *plates.tangential])
        modes = solve_full(structure, own, _MODES)
        shapes = modes.shapes.T
        flex = np.array([np.sum((unit @ shapes) * shapes, axis=0) for unit in units])
        omega = 2 * np.pi * modes.natural_frequency
        found.append(PlateModes(omega, modes.shapes @ rows.T, own[:, None] * flex))
    return found


def expected_margin(
    plates: Plates, stiffness: np.ndarray, states: list[PlateModes]
) -> float:
    """Return chi2 of the fault over the frequencies of one state, its joint free [-].

    Against the same plates without the fault; the mesh's trust is the sd. The median
    of all states.

    Args:
        plates: with a fault.
        stiffness: normal, of the joint in each state [N/m], shape (n_states,).
        states: their modes.
    """
    sound = replace(plates, factors=(1.0, 1.0), masses=(SENSOR_MASS,) * 6)
    found = []
    for with_fault, without in zip(states, full_modes(sound, stiffness), strict=True):
        omega = without.omega
        own = (omega > _RIGID) & (omega < 2 * np.pi * _highest(plates))
        moved = np.log(with_fault.omega[own] / omega[own]) / FREQUENCY_SD
        by_joint = 0.5 * (without.joint[:, own] / omega[own] ** 2).T / FREQUENCY_SD
        left = moved - by_joint @ np.linalg.lstsq(by_joint, moved, rcond=None)[0]
        found.append(float(left @ left))
    return float(np.median(found))


def _accelerance(plates: Plates, modes: PlateModes) -> np.ndarray:
    """Return the accelerance of a state, shape (6, 2, n_lines)."""
    omega, natural = 2 * np.pi * np.fft.rfftfreq(HIT, 1 / RATE), modes.omega
    elastic, joint = natural > _RIGID, modes.joint.sum(axis=0)
    # Viscous joint, hysteretic stone: both to first order.
    rest = np.maximum(natural**2 - joint, 0.0)
    loss = plates.damping * joint * natural + plates.material.loss_factor * rest
    twice = np.where(elastic, loss / np.where(elastic, natural, 1.0), 0.0)
    stiff = natural**2 - omega[:, None] ** 2 + 1j * omega[:, None] * twice
    stiff[0] = np.inf
    at = modes.shapes
    gain = omega[:, None] ** 2 / stiff
    return -np.einsum("mi,mj,lm->ijl", at[:, :6], at[:, 6:], gain)


def _measured_plates(plates: Plates, sensors: list[MountedSensor]) -> Structure:
    """Return the plates as they are, on a finer mesh than that of the model."""
    bodies = []
    for k, name in enumerate(("lower", "upper")):
        stone = Material(
            plates.material.youngs_modulus * plates.factors[k],
            plates.material.poisson_ratio,
            plates.material.density,
            plates.material.loss_factor,
        )
        size, low = plates.box(k)
        mesh = box_mesh(size, (12, 8, 2), origin=(0.0, 0.0, low))
        bodies.append(solid_body(name, mesh, stone))
    masses = [
        PointMass(one.body, one.position, m)
        for one, m in zip(sensors, plates.masses, strict=True)
    ]
    patch = rectangle(*_patch(plates))
    joint = Joint("joint", ("lower", "upper"), (patch,))
    return build_structure(bodies, [joint], masses=masses)


def _patch(plates: Plates) -> list[tuple[float, float]]:
    """Return the ends of the contact along and across the plates [m]."""
    return [
        (0.5 * size * (1 - share), 0.5 * size * (1 + share))
        for size, share in zip(plates.size, plates.patch, strict=False)
    ]


def _recording(
    name: str,
    preload: float,
    point: int,
    response: np.ndarray,
    rng: np.random.Generator,
) -> Recording:
    """Return three hits at a point."""
    time = np.arange(HIT) / RATE
    parts = []
    for _ in range(3):
        length = 4e-4 * np.exp(0.1 * rng.standard_normal())
        since = time - 0.03
        pulse = np.where((since > 0) & (since < length), 1.0, 0.0)
        force = rng.uniform(150, 400) * pulse * np.sin(np.pi * since / length) ** 2
        rings = np.fft.irfft(response[:, point] * np.fft.rfft(force), HIT, axis=1)
        parts.append(np.vstack([force, rings]))
    samples = np.concatenate(parts, axis=1)
    size = np.abs(samples).max(axis=1, keepdims=True)
    samples = samples + 3e-4 * size * rng.standard_normal(samples.shape)
    force = Channel("force", Quantity.FORCE, point=f"h{point + 1}")
    others = [
        Channel(name, Quantity.ACCELERATION, point=name) for name, *_ in _PLACES[:6]
    ]
    return Recording(name, samples, RATE, (force, *others), preload=float(preload))


def _model(plates: Plates) -> str:
    """Return the model file: what the data sheets say."""
    length, width, _ = plates.size
    stone, lines = plates.material, []
    middle = middle_stiffness(plates)
    low, high = 0.08 * middle, 12 * middle
    lines.append(
        f"""
[materials.stone]
youngs_modulus = "{stone.youngs_modulus:.6e} Pa"
poisson_ratio = {stone.poisson_ratio}
density = "{stone.density:.6g} kg/m^3"
loss_factor = {stone.loss_factor:.6g}

[joints.joint]
between = ["lower", "upper"]
patches = [{{ rectangle = {[[f"{x} m" for x in side] for side in _patch(plates)]} }}]

[identify]
data = "modes"
damping_sd = "20 %"
band = ["100 Hz", "{_highest(plates):.0f} Hz"]
stiffness_box = ["{low:.4g} N/m", "{high:.4g} N/m"]
frequency_sd = "{100 * FREQUENCY_SD} %"

[bolted_joint]
link = "joint"
bolts = 4
diameter = "8 mm"
area = "{1e4 * length * width:.6g} cm^2"
modulus = "{stone.youngs_modulus:.6e} Pa"
poisson = {stone.poisson_ratio}
hardness = "1.5 GPa"
"""
    )
    for k, name in enumerate(("lower", "upper")):
        size, low_side = plates.box(k)
        lines.append(
            f"""
[bodies.{name}]
box = ["{length} m", "{width} m", "{size[2]} m"]
cells = [10, 7, 2]
origin = ["0 m", "0 m", "{low_side} m"]
material = "stone"
"""
        )
    for name, body, at, way in _PLACES:
        place = ", ".join(f'"{x} m"' for x in plates.place(at))
        kind = "sensors" if name.startswith("a") else "hits"
        mass = f'mass = "{1e3 * SENSOR_MASS} g"\n' if kind == "sensors" else ""
        lines.append(
            f"""
[{kind}.{name}]
body = "{body}"
position = [{place}]
direction = {list(way)}
{mass}"""
        )
    return "".join(lines)


def _highest(plates: Plates) -> float:
    """Return the end of the band: some modes above the first bending [Hz]."""
    length, _, height = plates.size
    stone = plates.material
    speed = np.sqrt(stone.youngs_modulus / stone.density)
    return float(min(1.9 * 1.03 * height / length**2 * speed, 0.4 * RATE))
