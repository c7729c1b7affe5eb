# SPDX-License-Identifier: MIT
"""Modes from responses alone, with uncertainty: the force is not measured.

A running spindle excites a machine over a broad band without a force channel. The poles
of the structure are in the correlations of its responses (`correlations`, `subspace`);
residues, and with them modal masses, are not.

The poles are estimated again with each block of the record left out in turn. Unlike a
formula for one order, this jackknife over blocks includes the noise of the correlations
with its correlation over lags, channels and modes. A pole that scatters from order to
order or from block to block is no mode.
"""

from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.acquisition.basics.errors import NoModeFound, UsageError
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.records.provenance import Provenance, step
from jointbench.acquisition.records.recordings import Recording, response_rows
from jointbench.signal.modal.stabilisation import (
    Stabilisation,
    StabilityLimits,
    candidates,
    stabilise,
)
from jointbench.signal.output_only.correlations import Correlations, correlate_responses
from jointbench.signal.output_only.harmonics import sine_like
from jointbench.signal.output_only.pole_jackknife import correlation_poles, judge_poles
from jointbench.signal.output_only.spindle_lines import (
    SpindleLines,
    without_spindle_lines,
)
from jointbench.signal.output_only.stochastic_subspace import most_states

NO_LINES = SpindleLines(np.empty(0), np.empty(0))
# Default upper end of the band, as a share of the sample rate.
_HIGHEST = 1.0 / 2.56


@dataclass(frozen=True, slots=True)
class OutputOnlySettings:
    """Settings of the identification from responses alone.

    Attributes:
        band: lowest and highest frequency [Hz], or None for all up to the limit of the
            sample rate.
        highest_order: states of the largest model, two a mode; even.
        rows: block rows of the Hankel matrix; the lags used are twice as many.
        blocks: of the record, whose scatter gives the uncertainty.
        stability: criteria of a stable pole.
        take_out_sines: whether steady sines are taken out of the record first.
    """

    band: tuple[float, float] | None = None
    highest_order: int = 40
    rows: int = 50
    blocks: int = 24
    stability: StabilityLimits = field(
        default_factory=lambda: StabilityLimits(
            frequency=0.005, damping=0.3, persistence=0.2
        )
    )
    take_out_sines: bool = True

    def __post_init__(self) -> None:
        """Refuse numbers too small for a fit."""
        for name, value, least in (
            ("highest order", self.highest_order, 4),
            ("rows", self.rows, 4),
            ("blocks", self.blocks, 4),
        ):
            if value < least:
                raise UsageError(f"{name} is {value}; give {least} or more")


@dataclass(frozen=True, slots=True, eq=False)
class OutputOnlyModes:
    """Modes found in responses alone, by ascending frequency.

    Attributes:
        natural_frequency: [Hz], shape (n_modes,).
        frequency_sd: standard uncertainty [Hz], shape (n_modes,).
        damping_ratio: [-], shape (n_modes,).
        damping_ratio_sd: standard uncertainty [-], shape (n_modes,).
        shapes: largest component 1, not scaled by mass, shape (n_modes, n_outputs).
        stable_orders: at how many orders it was stable, shape (n_modes,).
        sine_like: True where the response around the mode is a steady sine, such as
            that of a rotating spindle, and no resonance; shape (n_modes,).
        outputs: labels of the outputs.
        band: that was searched [Hz].
        stabilisation: poles of all orders.
        correlations: the data of the fit.
        provenance: origin and processing steps.
        sines: taken out of the record before the fit.
    """

    natural_frequency: FloatArray
    frequency_sd: FloatArray
    damping_ratio: FloatArray
    damping_ratio_sd: FloatArray
    shapes: ComplexArray
    stable_orders: IntArray
    sine_like: BoolArray
    outputs: tuple[str, ...]
    band: tuple[float, float]
    stabilisation: Stabilisation
    correlations: Correlations
    provenance: Provenance = field(default=())
    sines: SpindleLines = NO_LINES

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        n_modes = self.natural_frequency.size
        one_each = ("frequency_sd", "damping_ratio", "damping_ratio_sd")
        for name in (*one_each, "stable_orders", "sine_like"):
            require_shape(name, getattr(self, name), (n_modes,))
            freeze(self, name)
        require_shape("shapes", self.shapes, (n_modes, len(self.outputs)))
        freeze(self, "natural_frequency", "shapes")


@one_thread()
def identify_output_only(
    recording: Recording, settings: OutputOnlySettings | None = None
) -> OutputOnlyModes:
    """Identify modes from the responses of a recording.

    Args:
        recording: stationary broadband excitation; a force channel is not used.
        settings: None for the defaults.

    Returns:
        Modes whose frequency and damping are the same at many orders and in all blocks.
        The uncertainties are a jackknife over blocks, widened so that 1.96 of them
        cover as Student's t does.

    Raises:
        NoModeFound: no pole is steady.
        BadData: the record is too short, or a response is constant.
        UsageError: the band is not inside 0 to the limit of the sample rate.

    Source:
        Peeters and De Roeck (1999), see `subspace`; Efron and Stein, Annals of
        Statistics 9 (1981) 586 (jackknife).
    """
    settings = settings or OutputOnlySettings()
    band = _band(recording, settings)
    lines = NO_LINES
    if settings.take_out_sines:
        recording, lines = without_spindle_lines(recording, band)
    data = correlate_responses(
        recording,
        highest=band[1],
        n_lags=2 * settings.rows,
        n_blocks=settings.blocks,
    )
    highest = min(settings.highest_order, most_states(data.mean))
    orders = tuple(range(2, highest + 1, 2))
    table = stabilise(
        correlation_poles(data, data.mean, orders, band), settings.stability
    )
    found = candidates(table, settings.stability)
    modes = judge_poles(data, found, table, band)
    if not modes:
        raise NoModeFound(
            f"none of {len(found)} stable poles between {band[0]:g} and {band[1]:g} Hz "
            f"is steady over {settings.blocks} blocks of the record; record longer, "
            "or give the --band in which the structure responds"
        )
    pole, sd = np.array([m.pole for m in modes]), np.array([m.sd for m in modes])
    done = step(
        "identify_output_only",
        band=f"{band[0]:g} to {band[1]:g} Hz",
        highest_order=highest,
        rows=settings.rows,
        blocks=settings.blocks,
        candidates=len(found),
        modes=len(modes),
    )
    return OutputOnlyModes(
        natural_frequency=np.abs(pole) / (2.0 * np.pi),
        frequency_sd=sd[:, 0],
        damping_ratio=-pole.real / np.abs(pole),
        damping_ratio_sd=sd[:, 1],
        shapes=np.array([m.shape for m in modes]),
        stable_orders=np.array([m.candidate.stable_orders for m in modes], np.int64),
        sine_like=sine_like(recording, pole),
        outputs=_labels(recording),
        band=band,
        stabilisation=table,
        correlations=data,
        provenance=(*recording.provenance, done),
        sines=lines,
    )


def _band(recording: Recording, settings: OutputOnlySettings) -> tuple[float, float]:
    carried = recording.sample_rate * _HIGHEST
    # A span of the lags below two periods resolves no mode.
    low, high = settings.band or (carried / settings.rows, carried)
    if not 0.0 <= low < high <= 0.5 * recording.sample_rate:
        raise UsageError(
            f"the band {low:g} to {high:g} Hz is not within 0 to "
            f"{0.5 * recording.sample_rate:g} Hz, half the sample rate"
        )
    return low, high


def _labels(recording: Recording) -> tuple[str, ...]:
    channels = [recording.channels[row] for row in response_rows(recording)]
    return tuple(f"{c.name}@{c.point}" for c in channels)
