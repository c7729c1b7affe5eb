# SPDX-License-Identifier: MIT
"""Contact laws as functions of the preload: asperities, fractal, linear, power.

Tangential stiffness is that of contacts that stick, 2 (1 - nu)/(2 - nu) times the
normal one (Mindlin 1949), except where a law gives its own.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.spectral.summit_laws import (
    LineMoments,
    greenwood_williamson,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.preload_law import LawParameter


def mindlin_ratio(poisson: float) -> float:
    """Return tangential over normal stiffness of contacts that stick [-]."""
    return 2.0 * (1.0 - poisson) / (2.0 - poisson)


@dataclass(frozen=True, slots=True)
class PowerPreloadLaw:
    """k = k_ref (P/P_ref)^m, for a law that is known by its result only.

    Attributes:
        parameters: ``stiffness`` [N/m] at the reference and ``exponent`` [-].
        reference: P_ref [N].
        poisson: Poisson ratio of the bodies [-].
        name: of the law.
        factor_sd: of ln(stiffness of the contact over that of the law) [-].
        roughness_alone: None: a law of numbers makes no statement of waves.
    """

    parameters: tuple[LawParameter, ...]
    reference: float
    poisson: float
    name: str = "power"
    factor_sd: float = CONTACT.law_factor_sd
    roughness_alone: float | None = None

    def log_stiffness(
        self, log_preload: FloatArray, coordinates: FloatArray
    ) -> FloatArray:
        """Return ln of normal and tangential stiffness, shape (2, n)."""
        stiffness, exponent = (
            p.value * np.exp(c)
            for p, c in zip(self.parameters, coordinates, strict=True)
        )
        rise = exponent * (log_preload - np.log(self.reference))
        return _with_tangential(np.log(stiffness) + rise, self.poisson)


@dataclass(frozen=True, slots=True)
class LinearPreloadLaw:
    """k = P/u_0 with u_0 = share times the rms height.

    Attributes:
        parameters: ``rms_height`` [m] and ``share`` u_0/h_rms [-].
        poisson: Poisson ratio of the bodies [-].
        name: of the law.
        factor_sd: of ln(stiffness of the contact over that of the law) [-].
        roughness_alone: None: a law of numbers makes no statement of waves.

    Source:
        Persson 2007, Phys. Rev. Lett. 99, 125502: p = p_0 exp(-u/u_0), where u_0 is 0.4
        to 0.5 of the rms height.
    """

    parameters: tuple[LawParameter, ...]
    poisson: float
    name: str = "linear"
    factor_sd: float = CONTACT.law_factor_sd
    roughness_alone: float | None = None

    def log_stiffness(
        self, log_preload: FloatArray, coordinates: FloatArray
    ) -> FloatArray:
        """Return ln of normal and tangential stiffness, shape (2, n)."""
        nominal = np.array([p.value for p in self.parameters])
        length = float(np.sum(np.log(nominal) + coordinates))
        return _with_tangential(log_preload - length, self.poisson)


@dataclass(frozen=True, slots=True)
class AsperityPreloadLaw:
    """Hertz contacts of Gaussian summits, from the spectral moments of a surface.

    Attributes:
        parameters: ``rms_height`` [m], ``rms_slope`` [-], ``rms_curvature`` [1/m] of
            the combined surface along a line, and ``modulus`` E* [Pa].
        area: apparent area [m^2].
        poisson: Poisson ratio of the bodies [-].
        name: of the law.
        factor_sd: of ln(stiffness of the contact over that of the law) [-].
        roughness_alone: None: a law of numbers makes no statement of waves.

    Source:
        `greenwood_williamson` of the laws of measured surfaces.
    """

    parameters: tuple[LawParameter, ...]
    area: float
    poisson: float
    name: str = "asperities"
    factor_sd: float = CONTACT.law_factor_sd
    roughness_alone: float | None = None

    def log_stiffness(
        self, log_preload: FloatArray, coordinates: FloatArray
    ) -> FloatArray:
        """Return ln of normal and tangential stiffness, shape (2, n)."""
        height, slope, curvature, modulus = (
            p.value * np.exp(c)
            for p, c in zip(self.parameters, coordinates, strict=True)
        )
        moments = LineMoments(
            *(np.array([value**2]) for value in (height, slope, curvature))
        )
        bandwidth = float(moments.breadth[0])
        if bandwidth <= 1.5:
            raise BadData(
                f"height, slope and curvature give a bandwidth of {bandwidth:.3g}; a "
                "random surface has more than 1.5: check their units and wavelengths"
            )
        pressure = np.exp(log_preload) / self.area
        state = greenwood_williamson(moments, pressure, np.array([modulus]))
        log_k = np.log(self.area * state.stiffness[0])
        return _with_tangential(log_k, self.poisson)


@dataclass(frozen=True, slots=True)
class FractalPreloadLaw:
    """One of the papers' fractal laws.

    Attributes:
        parameters: ``dimension`` [-], ``roughness`` G [m], ``hardness`` [Pa].
        model: name in `CONTACT_MODELS`.
        material: modulus and Poisson ratio.
        name: of the law.
        factor_sd: of ln(stiffness of the contact over that of the law) [-].
        roughness_alone: None: a law of numbers makes no statement of waves.
    """

    parameters: tuple[LawParameter, ...]
    model: str
    material: ContactMaterial
    name: str = "fractal"
    factor_sd: float = CONTACT.law_factor_sd
    roughness_alone: float | None = None

    def log_stiffness(
        self, log_preload: FloatArray, coordinates: FloatArray
    ) -> FloatArray:
        """Return ln of normal and tangential stiffness, shape (2, n).

        Raises:
            BadData: the surface bears nothing in this model.
        """
        dimension, roughness, hardness = (
            p.value * np.exp(c)
            for p, c in zip(self.parameters, coordinates, strict=True)
        )
        sums = contact_curve(
            self.model,
            dimension=dimension,
            roughness=roughness,
            material=self.material,
            preload=np.exp(log_preload),
            hardness=hardness,
        )
        stiffness = sums.stiffness.sum(axis=0)
        if not np.all(stiffness > 0):
            raise BadData(
                f"law {self.model!r} predicts no stiffness at this preload: every "
                "contact is fully plastic; check dimension, roughness and hardness"
            )
        return _with_tangential(np.log(stiffness), self.material.poisson)


def fractal_parameters(
    dimension: tuple[float, float],
    roughness: tuple[float, float],
    hardness: tuple[float, float],
) -> tuple[LawParameter, ...]:
    """Return the parameters of a fractal law from values with relative sd."""
    names = (("dimension", "-"), ("roughness", "m"), ("hardness", "Pa"))
    given = (dimension, roughness, hardness)
    return tuple(
        LawParameter(name, unit, value, sd)
        for (name, unit), (value, sd) in zip(names, given, strict=True)
    )


def asperity_parameters(
    height: tuple[float, float],
    slope: tuple[float, float],
    curvature: tuple[float, float],
    modulus: tuple[float, float],
    hurst: float = CONTACT.hurst,
) -> tuple[LawParameter, ...]:
    """Return the parameters of an asperity law from values with relative sd.

    Args:
        height: rms of the combined surface [m].
        slope: rms along a line [-].
        curvature: rms along a line [1/m].
        modulus: E* [Pa].
        hurst: exponent by which slope and curvature depend on the instrument's cut.
    """
    return (
        LawParameter("rms_height", "m", *height),
        LawParameter("rms_slope", "-", *slope, per_cut=hurst - 1.0),
        LawParameter("rms_curvature", "1/m", *curvature, per_cut=hurst - 2.0),
        LawParameter("modulus", "Pa", *modulus),
    )


def _with_tangential(log_normal: FloatArray, poisson: float) -> FloatArray:
    """Return ln k_n and ln k_t, shape (2, n)."""
    return np.stack([log_normal, log_normal + np.log(mindlin_ratio(poisson))])
