# SPDX-License-Identifier: MIT
"""Information of hammer hits on a jointed structure, sensor by sensor, point by point.

F = 2 Re sum over lines of dH^H dH / E|error|^2, with the noise of a hit over the
spectrum of its force.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.design.fisher_plan import PairInformation, pairs_of
from jointbench.analysis.structures.reduction.body_moduli import is_modulus
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.predict_response import predict_frf
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel


@dataclass(frozen=True, slots=True)
class HammerTest:
    """How a hit is made and recorded.

    Attributes:
        peak: of the force, a half sine [N].
        contact: its duration [s].
        noise: of an accelerometer, rms over the samples [m/s^2].
        sample_rate: [Hz].
        duration: of the record of a hit [s].
        band: of the lines used [Hz].
        lines: at most so many are used.
    """

    peak: float
    contact: float
    noise: float
    sample_rate: float
    duration: float
    band: tuple[float, float]
    lines: int = 200

    def frequency(self) -> FloatArray:
        """Return the lines [Hz], thinned evenly to at most `lines`.

        Raises:
            BadData: there is none in the band.
        """
        step = 1.0 / self.duration
        first, last = (
            int(np.ceil(self.band[0] / step)),
            int(np.floor(self.band[1] / step)),
        )
        found = np.arange(max(first, 1), last + 1) * step
        if not found.size:
            raise BadData(
                f"no line between {self.band[0]:g} and {self.band[1]:g} Hz in records "
                f"of {self.duration:g} s; widen the band or record longer"
            )
        return np.asarray(found[:: -(-found.size // self.lines)])

    def variance(self, frequency: FloatArray) -> FloatArray:
        """Return E|error|^2 of an accelerance from one hit [1/kg^2].

        Source:
            A white noise of variance v has the spectrum v dt T; the force is a half
            sine, (2 P tau/pi) cos(pi f tau)/(1 - 4 f^2 tau^2).
        """
        turn = frequency * self.contact
        near = np.abs(1.0 - 4.0 * turn**2) < 1e-6
        safe = np.where(near, 0.3, turn)
        shape = np.cos(np.pi * safe) / (1.0 - 4.0 * safe**2)
        force = (
            2.0 * self.peak * self.contact / np.pi * np.where(near, np.pi / 4.0, shape)
        )
        noise = self.noise**2 / self.sample_rate * self.duration
        return np.asarray(noise / np.maximum(force**2, 1e-300))


@dataclass(frozen=True, slots=True, eq=False)
class AddedMass:
    """A known mass at a point, which moves along one direction with it.

    Attributes:
        mass: [kg].
        row: of `readout` for the point, shape (r,).
    """

    mass: float
    row: FloatArray


@one_thread()
def pair_information(
    model: ReducedModel,
    values: JointValues,
    test: HammerTest,
    sensors: FloatArray,
    hits: FloatArray,
    added: AddedMass | None = None,
) -> PairInformation:
    """Return the information of one hit for all sensors and hit points.

    Args:
        model: the reduced structure.
        values: expected ones of its joints.
        test: how hits are made.
        sensors: rows of `readout` for the places of sensors, shape (n_sensors, r).
        hits: rows of `readout` for the hit points, shape (n_hits, r).
        added: a mass on the structure; None is none.

    Returns:
        Of `information_names(model)`, in ln.
    """
    frequency = test.frequency()
    laplace = np.asarray(2j * np.pi * frequency, complex)
    response, slopes = _slopes(model, values, laplace, (sensors, hits), added)
    weight = laplace**2 * np.sqrt(2.0 / test.variance(frequency))
    return pairs_of(np.moveaxis(slopes * weight, 0, -1), response * weight)


def _slopes(
    model: ReducedModel,
    values: JointValues,
    laplace: ComplexArray,
    rows: tuple[FloatArray, FloatArray],
    added: AddedMass | None,
) -> tuple[ComplexArray, ComplexArray]:
    """Return receptances and their derivatives by the logarithms of the parameters.

    Source:
        With m at a point, H - H_m H_m' / (1/(m s^2) + H_mm) (Sherman and Morrison).
    """
    sensors, hits = rows
    if added is not None:
        sensors = np.concatenate([sensors, added.row[None]])
        hits = np.concatenate([hits, added.row[None]])
    found = predict_frf(model, values, laplace, sensors, hits)
    damped = [at for at, name in enumerate(model.names) if not is_modulus(name)]
    slopes = np.concatenate(
        [
            found.by_stiffness * values.stiffness[:, None, None, None],
            (found.by_damping * values.damping[:, None, None, None])[damped],
        ]
    )
    h = found.response
    if added is None:
        return h, slopes
    left, right, own = h[:-1, -1:], h[-1:, :-1], h[-1, -1]
    inverse = 1.0 / (1.0 / (added.mass * laplace**2) + own)
    response = h[:-1, :-1] - left * right * inverse
    change = (
        slopes[:, :-1, :-1]
        - (slopes[:, :-1, -1:] * right + left * slopes[:, -1:, :-1]) * inverse
        + left * right * inverse**2 * slopes[:, -1:, -1:]
    )
    return response, change


def information_names(model: ReducedModel) -> tuple[str, ...]:
    """Return the names of the common parameters: stiffness, moduli, then damping."""
    stiffness = [
        name if is_modulus(name) else f"{name}_stiffness" for name in model.names
    ]
    damping = [f"{name}_damping" for name in model.names if not is_modulus(name)]
    return (*stiffness, *damping)
