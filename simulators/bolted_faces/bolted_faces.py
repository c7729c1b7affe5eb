# SPDX-License-Identifier: MIT
"""Stiffness of two bodies that bolts press together, from their own surfaces.

The pressure under the bolts is that of thick layers, the bodies are elastic half-spaces
around the contact, the waviness is pressed flat as far as the bolts do it, and the
roughness is a layer with the gap that boundary elements give it.
"""

from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.bolted_faces.rough_layer import RoughLayer

GRID = 64
"""Cells along one side of a surface."""
_MOST_STEPS = 60
_LEAST = 1e-9
"""Pressure over the mean one below which a cell bears nothing [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FaceDesign:
    """Two bodies with square surfaces on four bolts.

    Attributes:
        side: of the surfaces [m].
        thickness: of each body at the bolts [m].
        bolt_place: of the bolts from both centre lines [m].
        bolt_diameter: [m].
        head_diameter: [m].
        bolt_length: free length of a bolt [m].
        bolt_modulus: of the bolts [Pa].
        modulus: E* of both bodies [Pa].
        wave_height: rms height of the waviness of both surfaces [m].
        wave_lengths: shortest and longest wave of it [m].
        nut_factor: true one [-].
        seed: of the waviness.
    """

    side: float = 0.060
    thickness: float = 0.030
    bolt_place: float = 0.018
    bolt_diameter: float = 0.008
    head_diameter: float = 0.013
    bolt_length: float = 0.150
    bolt_modulus: float = 2.1e11
    modulus: float = 2.933e10
    wave_height: float = 0.6e-6
    wave_lengths: tuple[float, float] = (0.010, 0.030)
    nut_factor: float = 0.2
    seed: int = 1

    def preload(self, torque: float) -> float:
        """Return the force of all bolts [N] at a torque on each [N m]."""
        return 4.0 * torque / (self.nut_factor * self.bolt_diameter)


@dataclass(frozen=True, slots=True)
class JointStiffness:
    """Normal stiffness of a joint at one preload, built up cause by cause [N/m].

    Attributes:
        preload: of all bolts [N].
        rough: roughness alone, under an even pressure on the whole surface.
        patch: roughness under the pressure of the bolts.
        bodies: the same with the compliance of the bodies.
        waves: the same with the waviness.
        bolted: the same with the bolts in parallel: what the bench has.
    """

    preload: float
    rough: float
    patch: float
    bodies: float
    waves: float
    bolted: float

    @property
    def factors(self) -> dict[str, float]:
        """Factor of each cause, in this order [-]."""
        return {
            "bolt pressure": self.patch / self.rough,
            "bodies": self.bodies / self.patch,
            "waviness": self.waves / self.bodies,
            "bolts": self.bolted / self.waves,
        }


@dataclass(frozen=True, slots=True, eq=False)
class BoltedFaces:
    """Two surfaces on bolts, ready to be loaded.

    Attributes:
        design: sizes and materials.
        layer: gap of the roughness over the pressure.
    """

    design: FaceDesign
    layer: RoughLayer
    _green: FloatArray = field(init=False, repr=False)
    _share: FloatArray = field(init=False, repr=False)
    _waves: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Prepare influence, pressure of the bolts and waviness."""
        object.__setattr__(self, "_green", _influence(self.design))
        object.__setattr__(self, "_share", _bolt_pressure(self.design))
        object.__setattr__(self, "_waves", _waviness(self.design))

    def stiffness(self, preload: float) -> JointStiffness:
        """Return the stiffness at a preload [N]."""
        design = self.design
        cell = (design.side / GRID) ** 2
        even = np.full((GRID, GRID), preload / design.side**2)
        under = self._share * preload / cell
        rough = float(self._per_area(even).sum() * cell)
        patch = float(self._per_area(under).sum() * cell)
        bodies = self._with_bodies(self._per_area(under))
        waves = self._with_bodies(self._pressed(under, preload))
        area = np.pi * design.bolt_diameter**2 / 4
        bolts = 4 * design.bolt_modulus * area / design.bolt_length
        return JointStiffness(preload, rough, patch, bodies, waves, waves + bolts)

    def _moved(self, pressure: FloatArray) -> FloatArray:
        """Return the displacement of the surfaces towards the bodies [m]."""
        wide = np.fft.rfft2(pressure, s=(2 * GRID, 2 * GRID))
        return np.asarray(np.fft.irfft2(wide * self._green)[:GRID, :GRID])

    def _per_area(self, pressure: FloatArray) -> FloatArray:
        """Return the stiffness of the roughness per area at pressures [N/m^3]."""
        log_p = np.log(self.layer.pressure)
        slope = np.gradient(log_p, self.layer.gap)
        inner = np.interp(np.log(np.maximum(pressure, 1e-30)), log_p, -slope)
        return np.asarray(pressure * inner)

    def _with_bodies(self, per_area: FloatArray) -> float:
        """Return the stiffness of a layer between elastic bodies [N/m]."""
        cell = (self.design.side / GRID) ** 2
        solved = self._solve(per_area, np.ones((GRID, GRID)))
        return float(solved.sum() * cell)

    def _solve(self, per_area: FloatArray, right: FloatArray) -> FloatArray:
        """Return the pressures p of U p + p/per_area = right by conjugate gradients."""
        soft = 1.0 / np.maximum(per_area, _LEAST * per_area.max())
        scale = 1.0 / (soft + self._green[0, 0].real / GRID)

        def act(p: FloatArray) -> FloatArray:
            return np.asarray(self._moved(p) + soft * p)

        p = np.zeros_like(right)
        rest = right.copy()
        z = scale * rest
        direction, size = z, float(np.sum(rest * z))
        first = size
        for _ in range(500):
            image = act(direction)
            step = size / float(np.sum(direction * image))
            p = p + step * direction
            rest = rest - step * image
            z = scale * rest
            size, before = float(np.sum(rest * z)), size
            if size < 1e-14 * first:
                break
            direction = z + size / before * direction
        return np.asarray(p)

    def _pressed(self, under: FloatArray, preload: float) -> FloatArray:
        """Return the stiffness per area where bolts press the waves together.

        The bolts bend the bodies so that even surfaces would bear `under`; the waves
        move the pressure from their valleys to their hills.
        """
        cell = (self.design.side / GRID) ** 2
        log_p = np.log(self.layer.pressure)
        mean = max(preload / self.design.side**2, float(self.layer.pressure[0]))
        gap = np.full((GRID, GRID), np.interp(np.log(mean), log_p, self.layer.gap))
        gap = gap + self._waves - self._waves.min()
        for _ in range(_MOST_STEPS):
            p, per_area = self.layer.pressure_at(gap)
            # Unknown: change of the pressure and of the approach of the bodies.
            form = self._waves + self._moved(p - under) - gap
            one = self._solve(per_area, np.ones((GRID, GRID)))
            other = self._solve(per_area, -form)
            missing = preload / cell - p.sum()
            shift = (missing - other.sum()) / one.sum()
            change = other + shift * one
            step = -change / np.maximum(per_area, _LEAST * per_area.max())
            length = min(1.0, 0.5 * self._length / float(np.abs(step).max()))
            gap = gap + length * step
            if np.abs(step).max() < 1e-4 * self._length:
                break
        return self.layer.pressure_at(gap)[1]

    @property
    def _length(self) -> float:
        """Gap over which the pressure changes by a factor of e [m]."""
        log_p = np.log(self.layer.pressure)
        return float(np.ptp(self.layer.gap) / np.ptp(log_p))


def _places() -> FloatArray:
    """Return the centres of the cells over the side [-], shape (GRID,)."""
    return (np.arange(GRID) + 0.5) / GRID - 0.5


def _influence(design: FaceDesign) -> FloatArray:
    """Return the transform of the displacement under a pressure on one cell [m/Pa].

    Source:
        Johnson, Contact Mechanics (1985), eq. (3.25), of a square; 1/(pi E* r) beyond.
    """
    step = design.side / GRID
    offset = np.fft.fftfreq(2 * GRID, 1.0 / (2 * GRID)) * step
    r = np.hypot(offset[:, None], offset[None, :])
    kernel = step**2 / (np.pi * design.modulus * np.maximum(r, step))
    kernel[0, 0] = 4.0 * step * np.log(1.0 + np.sqrt(2.0)) / (np.pi * design.modulus)
    return np.asarray(np.fft.rfft2(kernel))


def _bolt_pressure(design: FaceDesign) -> FloatArray:
    """Return the share of the preload in each cell, (GRID, GRID).

    Each bolt presses two layers of equal thickness; between them its pressure is that
    of the middle of one thick layer, without the tension further out, which no joint
    bears.

    Source:
        Sneddon 1946, Proc. Cambridge Phil. Soc. 42, 260 (symmetric load on a layer).
    """
    from scipy.special import j0, j1

    h, hole, head = design.thickness, design.bolt_diameter / 2, design.head_diameter / 2
    q = np.linspace(1e-6, 60.0, 4000) / h
    ring = (head * j1(q * head) - hole * j1(q * hole)) / q
    x = q * h
    low = np.exp(-x)
    through = (
        2 * low * ((1 - low**2) + x * (1 + low**2)) / ((1 - low**4) + 4 * x * low**2)
    )
    r = np.linspace(0.0, 2.0 * design.side, 400)
    kernel = j0(np.outer(r, q)) * (ring * through * q)
    pressure = np.maximum(np.trapezoid(kernel, q, axis=1), 0.0)
    # Beyond its first zero there is a gap, not a second ring of pressure.
    ends = np.flatnonzero(pressure == 0)
    if ends.size:
        pressure[ends[0] :] = 0.0
    places = _places() * design.side
    total = np.zeros((GRID, GRID))
    for sx in (-1, 1):
        for sy in (-1, 1):
            dx, dy = places - sx * design.bolt_place, places - sy * design.bolt_place
            distance = np.hypot(dx[:, None], dy[None, :])
            one = np.interp(distance, r, pressure)
            one[distance < hole] = 0.0
            total += one
    return np.asarray(total / total.sum())


def _waviness(design: FaceDesign) -> FloatArray:
    """Return the heights of the long waves, hills negative: less gap [m]."""
    rng = np.random.default_rng([design.seed, 42])
    shortest, longest = design.wave_lengths
    wave = np.hypot(
        np.fft.fftfreq(2 * GRID, design.side / GRID)[:, None],
        np.fft.rfftfreq(2 * GRID, design.side / GRID)[None, :],
    )
    inside = (wave >= 1.0 / longest) & (wave <= 1.0 / shortest)
    noise = np.fft.rfft2(rng.standard_normal((2 * GRID, 2 * GRID)))
    shape = np.where(inside, np.maximum(wave, 1e-9) ** -1.5, 0.0)
    heights = np.fft.irfft2(noise * shape, s=(2 * GRID, 2 * GRID))[:GRID, :GRID]
    return np.asarray((heights - heights.mean()) * design.wave_height / heights.std())
