# SPDX-License-Identifier: MIT
"""A structure of known modes, hit by a known hammer: closed forms for the tests."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.signal.frf.frf import Frf, FrfKind, estimate_frf
from jointbench.signal.modal.modes import ModalResult, identify_modes

SHARED = Path(__file__).parents[3] / "shared" / "data"


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Modes, and residue constants phi_out phi_in, shape (n_modes, n_out, n_in)."""

    frequency: FloatArray
    damping: FloatArray
    constant: FloatArray

    @property
    def poles(self) -> ComplexArray:
        """Poles [rad/s]."""
        omega, ratio = 2.0 * np.pi * self.frequency, self.damping
        return np.asarray(omega * (-ratio + 1j * np.sqrt(1.0 - ratio**2)))

    def residues(self) -> ComplexArray:
        """Receptance residues of a proportionally damped structure."""
        damped = self.poles.imag[:, None, None]
        return np.asarray(self.constant / (2j * damped))

    def response(self, frequency: FloatArray, derivatives: int) -> ComplexArray:
        """FRF at lines [Hz], shape (n_out, n_in, n_lines)."""
        s = 2j * np.pi * frequency
        own, mirrored = (
            1.0 / (s - p[:, None]) for p in (self.poles, self.poles.conj())
        )
        residue = self.residues()
        terms = np.einsum("rl,roi->oil", own, residue)
        terms += np.einsum("rl,roi->oil", mirrored, residue.conj())
        return np.asarray(s**derivatives * terms)


@pytest.fixture
def structure() -> Callable[..., Truth]:
    """Make a structure of given modes; by default one output and one input."""

    def make(
        frequency: tuple[float, ...],
        damping: tuple[float, ...],
        constant: tuple[float, ...] | FloatArray | None = None,
    ) -> Truth:
        parts = np.ones(len(frequency)) if constant is None else np.asarray(constant)
        shaped = parts[:, None, None] if parts.ndim == 1 else parts
        return Truth(np.array(frequency), np.array(damping), shaped)

    return make


@pytest.fixture
def noisy_frf() -> Callable[..., Frf]:
    """Make the FRF of a structure with white noise of a share of its rms."""

    def make(
        truth: Truth,
        frequency: FloatArray,
        *,
        noise: float,
        seed: int,
        kind: FrfKind = FrfKind.ACCELERANCE,
    ) -> Frf:
        clean = truth.response(frequency, kind.derivatives)
        rms = np.sqrt(np.mean(np.abs(clean) ** 2, axis=2, keepdims=True))
        rng = np.random.default_rng(seed)
        error = rng.normal(size=clean.shape) + 1j * rng.normal(size=clean.shape)
        return Frf(frequency, clean + noise * rms * error / np.sqrt(2.0), kind)

    return make


@pytest.fixture
def hammered() -> Callable[..., Recording]:
    """Hit a structure with half-sine pulses and record force and response.

    The response is a convolution by the transform of a record long enough for every
    decay; only what lies beyond half the sample rate is missing from it.
    """

    def make(
        truth: Truth,
        *,
        sample_rate: float = 8192.0,
        interval: float = 1.0,
        peaks: tuple[float, ...] = (100.0,),
        noise: float = 0.0,
        seed: int = 0,
        width: float = 0.6e-3,
        first: int = 200,
        quantity: Quantity = Quantity.ACCELERATION,
        point: str = "1",
        name: str = "hits",
    ) -> Recording:
        pitch = round(interval * sample_rate)
        total, long = pitch * len(peaks), 8 * pitch
        samples = max(4, round(width * sample_rate))
        shape = np.sin(np.pi * np.arange(samples + 1) / samples)
        line = np.fft.rfftfreq(long, 1.0 / sample_rate)
        order = {"displacement": 0, "velocity": 1, "acceleration": 2}[quantity.value]
        transfer = truth.response(line, order)[:, 0]
        single = np.fft.irfft(np.fft.rfft(shape, long) * transfer, long)
        force = np.zeros(total)
        response = np.zeros((transfer.shape[0], total + long))
        for i, peak in enumerate(peaks):
            at = first + i * pitch
            force[at : at + samples + 1] += peak * shape
            response[:, at : at + long] += (peak * single)[:, : total + long - at]
        response = response[:, :total]
        rng = np.random.default_rng(seed)
        force = force + noise * max(peaks) * rng.normal(size=total)
        level = np.abs(response).max(axis=1, keepdims=True)
        response = response + noise * level * rng.normal(size=response.shape)
        channels = (
            Channel("force", Quantity.FORCE, point=point),
            *(
                Channel(f"a{i + 1}", quantity, point=str(i + 1))
                for i in range(response.shape[0])
            ),
        )
        return Recording(name, np.vstack((force, response)), sample_rate, channels)

    return make


@pytest.fixture(scope="session")
def real_hits() -> tuple[Recording, ...]:
    """Three hammer hits on a real structure, one a recording."""
    folder = SHARED / "hits"
    if not folder.is_dir():
        pytest.skip(f"{folder} is not there: real hits have no licence to be copied")
    channels = (
        Channel("force", Quantity.FORCE, point="1", unit="N"),
        Channel("a1", Quantity.ACCELERATION, point="1", unit="m/s^2"),
    )
    return tuple(
        Recording(
            f"hit {i}",
            np.load(folder / f"measurements_{i}.npy")[1:],
            25_600.0,
            channels,
        )
        for i in (1, 2, 3)
    )


@pytest.fixture(scope="session")
def modes_of_real_hits(real_hits: tuple[Recording, ...]) -> ModalResult:
    """The modes of the three real hits together; several tests judge them."""
    return identify_modes(estimate_frf(real_hits))


@pytest.fixture
def tool_frf() -> Frf:
    """Receptance of a real tool at five points, one input."""
    folder = SHARED / "frf"
    if not folder.is_dir():
        pytest.skip(f"{folder} is not there: real FRFs have no licence to be copied")
    tables = [
        np.loadtxt(folder / f"Point_{i}_Channel_1_CH1.txt").T for i in range(1, 6)
    ]
    response = np.array([t[1] + 1j * t[2] for t in tables])[:, None]
    return Frf(tables[0][0], response, FrfKind.RECEPTANCE)
