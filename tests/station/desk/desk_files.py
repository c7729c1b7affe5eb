"""Files for the desk: FRFs with known poles, as text."""

from pathlib import Path

import numpy as np

FREQUENCY = (90.0, 300.0, 520.0)
DAMPING = (0.02, 0.005, 0.01)
SHAPES = np.array([[1.0, 0.6, -0.4], [0.7, -0.9, 0.8], [-0.5, 0.9, 1.0]])
COLUMNS = "frequency:Hz,real:m/s^2/N,imaginary:m/s^2/N"


def write_frfs(folder: Path, names: tuple[str, ...] = ("p1", "p2", "p3")) -> list[Path]:
    """Write accelerances of three points struck at the first, with 0.1 % noise."""
    rng, lines = np.random.default_rng(7), np.arange(1.0, 700.0, 0.5)
    omega = 2.0 * np.pi * np.array(FREQUENCY)
    pole = omega * (-np.array(DAMPING) + 1j * np.sqrt(1.0 - np.array(DAMPING) ** 2))
    s = 2j * np.pi * lines
    files = []
    for point, name in enumerate(names):
        residue = SHAPES[point] * SHAPES[0] / (2j * omega)
        frf = sum(
            r / (s - p) + np.conj(r) / (s - np.conj(p))
            for r, p in zip(residue, pole, strict=True)
        )
        frf = frf * s**2
        noise = rng.normal(size=lines.size) + 1j * rng.normal(size=lines.size)
        frf = frf + 1e-3 * np.sqrt(np.mean(np.abs(frf) ** 2)) * noise
        table = np.stack((lines, frf.real, frf.imag), axis=1)
        path = folder / f"{name}.txt"
        np.savetxt(path, table, delimiter=",")
        files.append(path)
    return files
