# SPDX-License-Identifier: MIT
"""A bench whose residual is whitened under a discrepancy, line by line."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.model.policy import Policy
from jointbench.analysis.gap.model_error.discrepancy import (
    Discrepancy,
    Whitening,
    whitening,
)
from jointbench.analysis.gap.model_error.model_error_settings import (
    MODEL_ERROR_SETTINGS,
)
from jointbench.analysis.gap.model_error.spectral_frame import SpectralFrame
from jointbench.analysis.gap.residuals.bench_protocol import MeasuredBench
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Blocks


@dataclass(frozen=True, slots=True, eq=False)
class WhitenedBench:
    """Records with a discrepancy, for fits and directed tests.

    Attributes:
        inner: the bench that predicts the records.
        whitening: of its residual.
        blocks: rows by record; two rows for each line.
    """

    inner: MeasuredBench
    whitening: Whitening
    blocks: Blocks

    @property
    def base_names(self) -> tuple[str, ...]:
        """Names of the base parameters."""
        return self.inner.base_names

    @property
    def base_sd(self) -> FloatArray:
        """Prior sd of log(parameter / nominal), with a lower limit."""
        return np.maximum(self.inner.base_sd, MODEL_ERROR_SETTINGS.base_prior_sd)

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Force laws of links: linear effects are part of the discrepancy."""
        laws = {e.effect.name for e in self.inner.entries if e.law is not None}
        return tuple(c for c in self.inner.candidates if c.effect.name in laws)

    @property
    def probes(self) -> tuple[Candidate, ...]:
        """No further shapes."""
        return ()

    @property
    def policy(self) -> Policy:
        """Thresholds for its fits."""
        return self.inner.policy

    @property
    def expanded(self) -> bool:
        """Whether the model is expanded about one fit: it is not."""
        return False

    def scale(self, word: str) -> float:
        """Return the bench's scale of that word [SI]."""
        return self.inner.scale(word)

    def phases(self, candidate: Candidate) -> int:
        """Return the number of free phases that an effect fits."""
        return self.inner.phases(candidate)

    def hints(self, fit: object, candidate: Candidate) -> list[FloatArray]:
        """Return no starts beyond the grid."""
        return []

    @property
    def stiffness_sd(self) -> FloatArray:
        """Empty: settling is part of the discrepancy."""
        return np.zeros(0)

    def at_stiffness(self, settling: FloatArray) -> "WhitenedBench":
        """Return the bench unchanged."""
        return self

    def refine(
        self,
        base: FloatArray,
        terms: Sequence[Term],
        *,
        without: Sequence[int] = (),
    ) -> "WhitenedBench":
        """Return the bench unchanged; `law_race` estimates its discrepancy."""
        return self

    def spectrum(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> ComplexArray:
        """Return model minus measurement over sigma, (n_records, n_channels, n_lines).

        Noise has power 1 in each line.
        """
        r = self.inner.difference(base, terms, resolution.oversampling)
        self.inner.mask(r)
        return self.whitening.frame.spectrum(r)

    def residual(
        self, base: FloatArray, terms: Sequence[Term], resolution: Resolution
    ) -> FloatArray:
        """Return the whitened residual, real parts and imaginary parts."""
        white = self.whitening.white(self.spectrum(base, terms, resolution))
        rows = np.stack([white.real, white.imag], axis=-1)
        return np.asarray(np.sqrt(2.0) * rows.reshape(-1))

    def powers(self, rows: FloatArray) -> FloatArray:
        """Return the mean power of a whitened residual, 1 where it is white.

        Args:
            rows: shape (n_rows,).

        Returns:
            Shape (n_records, n_channels, n_bands).
        """
        records, channels, _ = self.blocks.shape
        power = np.sum(rows.reshape(records, channels, -1, 2) ** 2, axis=-1) / 2.0
        return self.whitening.frame.in_bands(power)


def whitened_bench(
    inner: MeasuredBench, frame: SpectralFrame, found: Discrepancy
) -> WhitenedBench:
    """Return a bench under a discrepancy.

    Args:
        inner: without an expansion about the settling of the hits.
        frame: its lines and bands.
        found: the discrepancy.
    """
    records, channels, _ = frame.signal.shape
    lines = frame.band.size
    group = np.repeat(np.arange(records), channels * 2 * lines)
    counted = 2 * int(np.sum(frame.counted * frame.count))
    blocks = Blocks(group, inner.blocks.labels, counted, (records, channels, 2 * lines))
    return WhitenedBench(inner, whitening(frame, found), blocks)
