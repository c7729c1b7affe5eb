# SPDX-License-Identifier: MIT
"""Nonlinear laws at the bolts, as forces beyond their linear springs."""

from dataclasses import dataclass, field
from enum import IntEnum
from functools import lru_cache

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.structure_response.port_law_settings import PORT_LAWS


class LawForm(IntEnum):
    """Kind of a law; the comment gives the force at a relative motion r."""

    FRICTION = 0  # share k (sum of weight times clipped stretch - r)
    STOP = 1  # k max(r - g, 0)
    CUBIC = 2  # k3 r^3
    QUADRATIC = 3  # k2 r^2
    SQUARE_DAMPING = 4  # c2 v |v|


@dataclass(frozen=True, slots=True, eq=False)
class PortLaws:
    """One law at some ports, each a joint freedom of a bolt.

    Attributes:
        ports: joint freedoms with the law, shape (n_ports,).
        size: share of the linear stiffness of the port that sliders hold [-], k [N/m],
            k3 [N/m^3], k2 [N/m^2] or c2 [N s^2/m^2], as the kind states.
        slips: displacement at which each slider slips [m], shape (n_sliders,).
        weights: share of each slider in them; they sum to 1, shape (n_sliders,).
        gradual: number of sliders that yield gradually, the last ones; the others
            yield at once.
        kind: of the law.
        gap: clearance of a stop [m].
        preload: power of the slip displacements in the bolt torque [-].
    """

    ports: tuple[int, ...]
    size: float
    slips: FloatArray = field(default_factory=lambda: np.zeros(0))
    weights: FloatArray = field(default_factory=lambda: np.zeros(0))
    kind: LawForm = LawForm.FRICTION
    gap: float = 0.0
    preload: float = 0.0
    gradual: int = 0

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "slips", "weights")

    @property
    def sharp(self) -> int:
        """Number of sliders that yield at once."""
        return self.slips.size - self.gradual


def law_ports(laws: tuple[PortLaws, ...]) -> tuple[int, ...]:
    """Return the joint freedoms of all laws, in their order."""
    return tuple(port for law in laws for port in law.ports)


def spread_sliders(
    slip: float, early: float, tail: float
) -> tuple[FloatArray, FloatArray]:
    """Return slip displacements [m] and weights of sliders with spread strengths.

    The stiffness that does not yet slip at a displacement phi is (1 + h u)^(-1/h) of
    the whole, u = (phi / scale)^shape and h = tail / (1 - abs(tail)): Weibull's
    exp(-u) at h = 0, strengths with an end below it, with a long tail above it. Cells
    end at a constant ratio, so that soft hits, which slip the weak sliders alone, meet
    as many as hard ones; a slider sits at the mean slip displacement of its cell.

    Args:
        slip: mean slip displacement: limiting force over stiffness [m].
        early: stiffness that slips below half of it, of the whole [-]; much where
            yielding begins with the smallest motion, little where all slip at once.
        tail: -1 to 1 [-].

    Source:
        Picoli et al. 2003, Physica A 324, 678, for the strengths; Iwan 1966, J. Appl.
        Mech. 33, 893, for their sum.
    """
    way = _signed(tail)
    shape = _shape_of(early, way)
    mean = _mean(shape, way)
    below, above = PORT_LAWS.outer_sliders
    weakest, last = (_quantile(q, way) ** (1.0 / shape) for q in (below, 1.0 - above))
    first = max(weakest, PORT_LAWS.least_slip * mean)
    edges = np.geomspace(first, last, PORT_LAWS.sliders - 1)
    left = np.concatenate([[1.0], _unslipped(edges**shape, way), [0.0]])
    left[-2] = above  # exact even where strengths end as abruptly as Coulomb's
    held = np.concatenate([[0.0], _held(edges, shape, way), [mean]])
    held -= np.concatenate([[0.0], edges, [0.0]]) * left
    weights = -np.diff(left)
    return slip / mean * np.diff(held) / weights, weights


def _signed(tail: float) -> float:
    """Return h of a tail; Weibull's strengths are those of a very small one."""
    h = tail / (1.0 - abs(tail))
    least = PORT_LAWS.least_tail
    return float(np.copysign(max(abs(h), least), h))


def _unslipped(u: FloatArray | float, h: float) -> FloatArray:
    """Return the stiffness that does not yet slip, of the whole [-]."""
    return np.asarray(np.maximum(1.0 + h * np.asarray(u), 0.0) ** (-1.0 / h))


def _quantile(slipped: float, h: float) -> float:
    """Return u below which so much of the stiffness slips."""
    return float(np.expm1(-h * np.log1p(-slipped)) / h)


def _mean(shape: float, h: float) -> float:
    """Return the mean of the strengths over their scale [-]."""
    from scipy.special import gammaln  # slow to import

    order, far = 1.0 / shape, _far_order(shape, h)
    log_beta = gammaln(order) + gammaln(far) - gammaln(order + far)
    return float(np.exp(log_beta - order * np.log(abs(h))) * order)


def _far_order(shape: float, h: float) -> float:
    """Return the second order of the beta function of strengths."""
    return 1.0 / h - 1.0 / shape if h > 0.0 else 1.0 - 1.0 / h


def _held(motion: FloatArray, shape: float, h: float) -> FloatArray:
    """Return the force of all sliders over their stiffness and the scale [-]."""
    from scipy.special import betainc  # slow to import

    reached = abs(h) * motion**shape
    z = reached / (1.0 + reached) if h > 0.0 else np.minimum(reached, 1.0)
    share = betainc(1.0 / shape, _far_order(shape, h), z)
    return np.asarray(_mean(shape, h) * share)


@lru_cache(maxsize=256)
def _shape_of(early: float, h: float) -> float:
    """Return the shape with which so much slips below half the slip displacement."""
    from scipy.optimize import brentq  # slow to import

    def beyond(log_shape: float) -> float:
        shape = float(np.exp(log_shape))
        u = (0.5 * _mean(shape, h)) ** shape
        return float(np.log((1.0 - _unslipped(u, h)) / early))

    least, most = PORT_LAWS.shapes
    # Below h the strengths have no mean.
    low, high = np.log(max(least, 1.02 * h)), np.log(most)
    if beyond(low) <= 0.0:
        return float(np.exp(low))
    if beyond(high) >= 0.0:
        return float(np.exp(high))
    return float(np.exp(brentq(beyond, low, high, xtol=1e-13)))
