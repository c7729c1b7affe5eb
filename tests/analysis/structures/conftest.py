"""Two small marble plates on each other, reduced once for all tests."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import (
    Joint,
    solid_body,
)
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    build_structure,
)
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.reduction.mounted_sensors import (
    MountedSensor,
    readout,
    sensor_rows,
)
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel

PLATE = (0.5, 0.3, 0.05)


@pytest.fixture(scope="session")
def marble() -> Material:
    """Marble of the 2025 paper's Table 1."""
    return Material(youngs_modulus=55e9, poisson_ratio=0.25, density=2600.0)


@pytest.fixture(scope="session")
def oracle() -> Callable[[str, str], list[float]]:
    """Frequencies of another code on the same mesh, by case and mesh [Hz]."""
    place = Path(__file__).parents[4] / "shared" / "data" / "oracle" / "public.json"
    if not place.is_file():
        pytest.skip("the reference frequencies (data/oracle) are not beside the code")
    cases = json.loads(place.read_text(encoding="utf-8"))["cases"]

    def look_up(case: str, mesh: str) -> list[float]:
        whole = next(one for one in cases if one["case"] == case)
        row = next(one for one in whole["convergence"] if one["mesh"] == mesh)
        found: list[float] = row["python_own_hz"]
        return found

    return look_up


@pytest.fixture(scope="session")
def plates(marble: Material) -> Structure:
    """Two free plates, a joint over the whole face."""
    cells = (4, 3, 1)
    upper = box_mesh(PLATE, cells, origin=(0.0, 0.0, 0.05))
    bodies = [
        solid_body("lower", box_mesh(PLATE, cells), marble),
        solid_body("upper", upper, marble),
    ]
    return build_structure(bodies, [Joint("joint", ("lower", "upper"))])


@pytest.fixture(scope="session")
def sensors() -> tuple[MountedSensor, ...]:
    """Five accelerometers, on both plates and along all axes."""
    return (
        MountedSensor("a1", "lower", (0.0, 0.0, 0.0), (0, 0, 1)),
        MountedSensor("a2", "lower", (0.5, 0.3, 0.0), (1, 0, 0)),
        MountedSensor("a3", "upper", (0.05, 0.05, 0.1), (0, 0, 1)),
        MountedSensor("a4", "upper", (0.5, 0.05, 0.1), (0, 1, 0)),
        MountedSensor("a5", "upper", (0.25, 0.3, 0.1), (0, 0, 1)),
    )


@pytest.fixture(scope="session")
def reduced(plates: Structure, sensors: tuple[MountedSensor, ...]) -> ReducedModel:
    """The plates, reduced for six rigid and eight elastic modes."""
    loads = sensor_rows(plates, sensors)
    return reduce_structure(plates, modes=14, box=(1e6, 1e10), loads=loads)


@pytest.fixture(scope="session")
def rows(
    plates: Structure, reduced: ReducedModel, sensors: tuple[MountedSensor, ...]
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Readout of the sensors."""
    return readout(plates, reduced, sensors)


@pytest.fixture(scope="session")
def truth() -> JointValues:
    """Stiffness and damping that the tests look for."""
    return JointValues(np.array([6e8, 9e7, 2e8]), np.array([4e3, 1.5e3, 2e3]))
