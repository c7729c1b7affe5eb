# SPDX-License-Identifier: MIT
"""The lines of one band of all ring-downs, and how a slow signal becomes such lines.

A decay is transformed as it is, without filter or window. A model signal that varies
slowly beside its carrier needs no sample at every sample of the record: its transform
is an integral over a few hundred nodes. What the integral leaves out (the ends of the
sum, the image at negative frequency, modes far away) is smooth over the band: a
polynomial of degree 2 of each hit and channel, which is projected out of data and
model alike, together with the decays of known modes beside the band.
"""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.signal.amplitude.panels import Panels, panels
from jointbench.signal.amplitude.ring_downs import RingDowns

# Degree of the polynomial that stands for far modes.
_DEGREE = 2
# Hits whose tail is quietest: this quantile over hits is the noise.
_QUIET = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class BandLines:
    """One band of all ring-downs, whitened: real and imaginary noise have variance 1.

    Attributes:
        omega: of the lines [rad/s], shape (n_lines,).
        data: shape (n_hits, n_virtual, n_lines), smooth background projected out.
        mixing: channel = mixing @ virtual channel [unit], shape (n_channels,
            n_virtual).
        reduction: virtual channel = reduction @ channel [1/unit], shape (n_virtual,
            n_channels).
        panels: nodes of the quadrature over time.
        centre: carrier that the model signals leave out [rad/s].
        transform: model signal on the nodes to lines, background projected out, shape
            (n_lines, n_nodes).
        background: orthonormal columns that were projected out, shape (n_lines, n).
        duration: of the decays [s].
    """

    omega: FloatArray
    data: ComplexArray
    mixing: ComplexArray
    reduction: ComplexArray
    panels: Panels
    centre: float
    transform: ComplexArray
    background: ComplexArray
    duration: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(
            self,
            "omega",
            "data",
            "mixing",
            "reduction",
            "transform",
            "background",
        )

    @property
    def time(self) -> FloatArray:
        """Nodes of the quadrature [s], shape (n_nodes,)."""
        return self.panels.time

    @property
    def freedom(self) -> int:
        """Real numbers that the data hold after the projection."""
        hits, virtual, lines = self.data.shape
        return int(2 * hits * virtual * (lines - self.background.shape[1]))


def band_lines(
    decays: RingDowns,
    band: tuple[float, float],
    *,
    duration: float,
    beside: ComplexArray,
    modes: int,
    like: "BandLines | None" = None,
) -> BandLines:
    """Transform the ring-downs and keep one band.

    Args:
        decays: of all hits.
        band: lowest and highest frequency [Hz].
        duration: wanted of the decays [s]; less where the records are shorter.
        beside: poles of modes outside the band whose flanks reach into it [rad/s].
        modes: that will be fitted; channels are reduced to two more than these.
        like: lines of the same decays from another start, whose carrier, virtual
            channels and noise are taken over; None derives them from the decays.
    """
    available = decays.samples.shape[2]
    # A multiple of 64 has a fast transform.
    size = min(available, max(64, round(duration * decays.sample_rate))) // 64 * 64
    omega, lines = _lines(decays.samples[:, :, :size], decays.sample_rate, band)
    length = size / decays.sample_rate
    if like is None:
        noise = _tail_noise(decays, size, band)
        left = _strongest(lines / noise[:, None], modes + 2)
        mixing, reduction = noise[:, None] * left, left.conj().T / noise
        centre = float(omega.mean())
    else:
        louder = np.sqrt(length / like.duration)
        mixing, reduction = like.mixing * louder, like.reduction / louder
        centre = like.centre
    virtual = np.einsum("vc,hcm->hvm", reduction, lines)
    nodes = panels(length, (omega[-1] - omega[0]) / 2 / np.pi)
    kernel = np.exp(1j * np.outer(centre - omega, nodes.time)) * nodes.weight
    transform = 0.5 * decays.sample_rate * kernel
    background = _background(omega, transform, nodes.time, beside - 1j * centre)
    return BandLines(
        omega=omega,
        data=_without(virtual, background),
        mixing=mixing,
        reduction=reduction,
        panels=nodes,
        centre=centre,
        transform=np.asarray(_without(transform.T, background).T),
        background=background,
        duration=length,
    )


def _lines(
    samples: FloatArray, rate: float, band: tuple[float, float]
) -> tuple[FloatArray, ComplexArray]:
    """Return omega and transform on the lines within a band."""
    frequency = scipy.fft.rfftfreq(samples.shape[-1], 1.0 / rate)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    spectra = scipy.fft.rfft(samples, axis=-1)[..., inside]
    return 2 * np.pi * frequency[inside], np.asarray(spectra)


def _tail_noise(decays: RingDowns, size: int, band: tuple[float, float]) -> FloatArray:
    """Return the sd of real and imaginary part of a line, one a channel.

    From what follows the decay where the record continues, else from its last quarter;
    that of the quietest hits, since a decay may not be over.
    """
    available = decays.samples.shape[2]
    after = available - size
    first = size if after >= size // 4 else available - available // 4
    tail = decays.samples[:, :, first:]
    wide = max(band[1] - band[0], 8.0 * decays.sample_rate / tail.shape[2])
    middle = 0.5 * (band[0] + band[1])
    near = (max(0.0, middle - 0.5 * wide), middle + 0.5 * wide)
    lines = _lines(tail, decays.sample_rate, near)[1]
    power = np.mean(np.abs(lines) ** 2, axis=2) * size / tail.shape[2]
    noise = np.sqrt(0.5 * np.quantile(power, _QUIET, axis=0))
    floor = 1e-9 * np.abs(decays.samples).max() * np.sqrt(size)
    return np.asarray(np.maximum(noise, floor))


def _strongest(white: ComplexArray, most: int) -> ComplexArray:
    """Return the combinations of whitened channels that hold the signal, as columns."""
    hits, channels, lines = white.shape
    flat = white.transpose(1, 0, 2).reshape(channels, hits * lines)
    return np.asarray(np.linalg.svd(flat @ flat.conj().T)[0][:, :most])


def _background(
    omega: FloatArray, transform: ComplexArray, time: FloatArray, beside: ComplexArray
) -> ComplexArray:
    """Return an orthonormal basis of far modes and of known modes beside the band.

    A known mode brings its decay and the change of it with its pole: where it depends
    on amplitude itself, that is most of the difference.
    """
    x = (omega - omega.mean()) / (0.5 * (omega[-1] - omega[0]))
    columns = [x.astype(complex) ** power for power in range(_DEGREE + 1)]
    for pole in beside:
        decay = np.exp(pole * time)
        columns += [transform @ decay, transform @ (time * decay)]
    columns = [c / np.linalg.norm(c) for c in columns]
    left, size, _ = np.linalg.svd(np.array(columns).T, full_matrices=False)
    return np.asarray(left[:, size > 1e-6 * size[0]])


def _without(rows: ComplexArray, background: ComplexArray) -> ComplexArray:
    """Project the background out of rows of lines."""
    return np.asarray(rows - (rows @ background.conj()) @ background.T)
