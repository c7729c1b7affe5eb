# SPDX-License-Identifier: MIT
"""Records of the band-limited fit of a surface."""

from dataclasses import dataclass
from enum import StrEnum

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.signal.band_limited.lay_spectrum import LaySpectrum
from jointbench.signal.band_limited.matern_spectrum import BandLimited


class RollOffVerdict(StrEnum):
    """Verdict on the longest waves of a self-affine surface."""

    SATURATED = "saturated"
    UNDECIDED = "fractal, or saturated: too short to decide"
    FRACTAL = "fractal over the whole length"
    NO_BAND = "no self-affine band"


@dataclass(frozen=True, slots=True)
class Interval95:
    """One number of a surface with its 95 % interval.

    Attributes:
        value: best estimate.
        low: 2.5 % point.
        high: 97.5 % point.
    """

    value: float
    low: float
    high: float

    def times(self, factor: float) -> "Interval95":
        """Return the estimate in another unit."""
        return Interval95(factor * self.value, factor * self.low, factor * self.high)

    def covers(self, truth: float) -> bool:
        """Return whether the interval covers a value."""
        return self.low <= truth <= self.high


@dataclass(frozen=True, slots=True)
class RoughnessMoments:
    """Root mean squares along a line, of waves between two wavelengths.

    Of a map the waves are those of all directions, and slope and curvature those along
    a line, averaged over directions: the root of half the mean square gradient, and of
    3/8 of the mean square Laplacian.

    Attributes:
        shortest: wavelength [m].
        longest: wavelength [m].
        height: [m].
        slope: [-].
        curvature: [1/m].
        modelled: from the fitted spectrum; False where they are sums of the measured
            one.
    """

    shortest: float
    longest: float
    height: Interval95
    slope: Interval95
    curvature: Interval95
    modelled: bool


@dataclass(frozen=True, slots=True)
class DrawnModels:
    """Models of the posterior of a fit.

    Attributes:
        models: in units of the fit's scale and pitch.
        weight: of each, sum 1.
    """

    models: tuple[BandLimited, ...]
    weight: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False)
class LineDensity:
    """Two-sided density of heights along a line, known filters divided out.

    Attributes:
        wavenumber: of the bins [rad/m], shape (n_bins,).
        density: [m^3/rad], same shape.
        count: independent ordinates in each [-], same shape.
    """

    wavenumber: FloatArray
    density: FloatArray
    count: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "wavenumber", "density", "count")


@dataclass(frozen=True, slots=True)
class SurfaceLay:
    """Direction of a map along which heights vary least, and what differs across it.

    Attributes:
        angle: of the lay from the rows towards the columns [rad], within -pi/2 to pi/2
            for its value.
        ratio: wavelength along over that across of equal density [-], in the middle of
            the band.
        hurst_along: H of lines along the lay [-].
        hurst_across: H of lines across it [-].
        roll_off_along: wavelength above which the spectrum is level along the lay [m];
            None where the map does not show it.
        roll_off_across: the same across it [m].
    """

    angle: Interval95
    ratio: Interval95
    hurst_along: Interval95
    hurst_across: Interval95
    roll_off_along: Interval95 | None
    roll_off_across: Interval95 | None


@dataclass(frozen=True, slots=True)
class BandLimitedFit:
    """The band-limited self-affine surface that describes a line or a map of heights.

    Of a map with a lay, `hurst` and `roll_off` are those between both directions, and
    `lay` has each; slope and curvature are means over all directions.

    Attributes:
        verdict: on the longest waves.
        reason: one line with the numbers.
        hurst: H [-]; None without a self-affine band.
        roll_off: wavelength above which the spectrum is level [m]; None where the
            trace does not show it.
        roll_off_beyond: wavelength up to which no roll-off is compatible with the
            heights, at 95 % [m]; None without a self-affine band.
        height: root mean square of all waves [m]; None where the trace does not show
            the longest.
        short_cut: wavelength at which the spectrum is cut by half in amplitude beyond
            what is known of the instrument [m]; its low end is 0 where none is found.
        tip_deviation: distance of the fitted blur from that of a stated stylus
            [standard deviations]; None where no radius is stated.
        noise: standard deviation of each height [m].
        moments: within the stated wavelengths; None where no wave is resolved.
        tolerance: by which ln density differs from the model beyond its scatter [-].
        model: spectrum of a line in units of `scale` and `pitch`; None without a
            self-affine band.
        pitch: [m].
        scale: [m].
        draws: of the model; None without a self-affine band.
        density: within the wavelengths of the moments; None where the model has it.
        mapped: whether a map was fitted over both wavenumbers.
        lay: of a map; None for profiles and for maps without one.
        map_model: spectrum of a map over both wavenumbers, in the same units; None for
            lines.
    """

    verdict: RollOffVerdict
    reason: str
    hurst: Interval95 | None
    roll_off: Interval95 | None
    roll_off_beyond: float | None
    height: Interval95 | None
    short_cut: Interval95 | None
    tip_deviation: float | None
    noise: float
    moments: RoughnessMoments | None
    tolerance: float
    model: BandLimited | None
    pitch: float
    scale: float
    draws: DrawnModels | None = None
    density: LineDensity | None = None
    mapped: bool = False
    lay: SurfaceLay | None = None
    map_model: LaySpectrum | None = None

    @property
    def roll_off_likeliest(self) -> float | None:
        """The most likely roll-off, whether or not the trace shows one [m].

        It is far beyond the line where none is likelier; None without a self-affine
        band.
        """
        return None if self.model is None else self.model.roll_off * self.pitch
