# SPDX-License-Identifier: MIT
"""Whitening of the records of a bench for what is known of their errors.

A residual over sigma holds what is left of hum, the directions of each hit, and the
errors of an uncertain modal table: of residues, the same in all hits of a point, or of
bodies, the same in all records.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.slopes import SlopeArray
from jointbench.analysis.gap.structure_bench.table_whitening import (
    TableWhitening,
    point_whitening,
)
from jointbench.analysis.gap.structure_bench.whitening import (
    CommonWhitening,
    HitWhitening,
    HumWhitening,
    common_whitening,
    directions_found,
    hum_whitening,
    whitening_of,
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitRecords
from jointbench.analysis.gap.structure_response.residue_errors import ResidueErrors


@dataclass(frozen=True, slots=True, eq=False)
class RecordWhitening:
    """Inverse root of the covariance of all records.

    Attributes:
        hits: records.
        sigma: sd of the residual [m/s^2], shape (n_records, n_channels).
        directions: derivatives of the response by directions of unit sd, shape
            (n_records, n_directions, n_channels, n_samples); None before they are
            known, when nothing but hum is whitened.
        errors: of responses by those of an uncertain modal table; None as above, and
            if it is exact.
        bodies: responses to errors of the bodies, one sd each [m/s^2], shape
            (n_records, n_errors, n_channels, n_samples); None where the errors of
            residues stand for them.
        uncertain: whether the modal table is.
        kept: transforms and whitenings that are used again.
    """

    hits: HitRecords
    sigma: FloatArray
    directions: FloatArray | None
    errors: ResidueErrors | None
    bodies: FloatArray | None
    uncertain: bool
    kept: dict[Any, Any]

    def __call__(self, rows: FloatArray) -> FloatArray:
        """Whiten rows of records.

        Args:
            rows: model minus measurement [m/s^2], shape
                (n_records, n, n_channels, n_samples).

        Returns:
            Over sigma, white, of the same shape.
        """
        scaled = rows / self.sigma[:, None, :, None]
        self.in_place(scaled)
        return np.asarray(scaled)

    def in_place(self, rows: SlopeArray) -> None:
        """Whiten rows over sigma in place, (n_records, n, n_channels, n_samples)."""
        self._steady(rows)
        if self.directions is None:
            return
        count = rows.shape[3]
        # A view: channels and samples follow each other.
        self._white(count)(rows.reshape(*rows.shape[:2], -1))
        if self.bodies is not None:
            self._of_bodies(self.bodies[..., :count])(rows)

    def found(self, rows: FloatArray) -> FloatArray:
        """Return the most likely directions of each record, in units of their sd.

        Args:
            rows: model minus measurement [m/s^2], shape
                (n_records, n_channels, n_samples).

        Returns:
            Directions, shape (n_records, n_directions).
        """
        scaled = rows / self.sigma[:, :, None]
        self._steady(scaled)
        if self.uncertain:
            return self._of_table(rows.shape[2]).found(scaled)
        known = _flat(self._scaled(rows.shape[2]))
        return directions_found(known, scaled.reshape(len(rows), -1))

    def _steady(self, rows: SlopeArray) -> None:
        """Whiten rows over sigma for what is left of the hum of channels, in place.

        What is left of it is far below the errors of an uncertain modal table.

        Args:
            rows: shape (n_records, ..., n_channels, n_samples).
        """
        hits, count = self.hits, rows.shape[-1]
        if not hits.hum_left.size or self.uncertain:
            return
        found: HumWhitening = self._kept(
            ("hum_left", count),
            lambda: hum_whitening(hits.hum_left[:, :count], hits.noise / self.sigma),
        )
        found(rows)

    def _white(self, count: int) -> HitWhitening | TableWhitening:
        """Return the whitening of records of so many samples."""
        if self.uncertain:
            return self._of_table(count)
        found: HitWhitening = self._kept(
            ("white", count), lambda: whitening_of(_flat(self._scaled(count)))
        )
        return found

    def _of_table(self, count: int) -> TableWhitening:
        """Return the whitening for errors of the modal table and directions of hits."""
        found: TableWhitening = self._kept(
            ("table", count), lambda: self._made_of_table(count)
        )
        return found

    def _of_bodies(self, bodies: FloatArray) -> CommonWhitening:
        """Return the whitening for errors of the bodies, after that of records.

        Args:
            bodies: responses to them [m/s^2], in the window.
        """
        count = bodies.shape[3]

        def make() -> CommonWhitening:
            rows = bodies / self.sigma[:, None, :, None]
            self._white(count)(_flat(rows))
            return common_whitening(rows)

        found: CommonWhitening = self._kept(("bodies", count), make)
        return found

    def _made_of_table(self, count: int) -> TableWhitening:
        errors = self.errors
        if errors is None:
            raise ValueError("errors of the table are not known yet")
        scaled = self._scaled(count)
        groups = self.hits.of_points
        points = []
        for own in groups:
            of_record = self.sigma[own].mean(axis=1)
            of_channel = self.sigma[own[0]] / of_record[0]
            unit = errors.rows(own)[:, :, :count] / of_record[:, None, None]
            sd = errors.sd[self.hits.point[own[0]]] / of_channel[:, None]
            points.append(point_whitening(scaled[own], unit, sd))
        return TableWhitening(groups, tuple(points))

    def _scaled(self, count: int) -> FloatArray:
        """Return directions over sigma, (n_records, 5, n_channels, n_samples)."""
        if self.directions is None:
            raise ValueError("directions are not known yet")
        rows = self.directions[..., :count] / self.sigma[:, None, :, None]
        self._steady(rows)
        return rows

    def _kept(self, key: tuple[object, ...], make: Callable[[], Any]) -> Any:
        if key not in self.kept:
            self.kept[key] = make()
        return self.kept[key]


def _flat(rows: FloatArray) -> FloatArray:
    """Return rows of records, (n_records, n, ...) to (n_records, n, n_rows)."""
    return rows.reshape(*rows.shape[:2], -1)
