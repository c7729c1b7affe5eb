# SPDX-License-Identifier: MIT
"""Bodies of a machine that were measured alone, among meshed ones."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.structures.measured.fitted_frfs import FittedFrfs
from jointbench.analysis.structures.measured.measured_body import modal_body
from jointbench.analysis.structures.reduction.component import (
    BodySource,
    Component,
    Residual,
)
from jointbench.analysis.structures.reduction.reduce_body import shift_of_band

# Stiffness of a rigid link over that of the measured body at its point.
_RIGID = 1e2


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPart:
    """A free body that was struck alone.

    Attributes:
        name: of the body.
        fits: of its FRFs: the best description of the modes above the band, and one
            with a further power, whose difference is part of the uncertainty.
        labels: of its points.
    """

    name: str
    fits: tuple[FittedFrfs, FittedFrfs]
    labels: tuple[str, ...]

    def component(self, band_hz: float) -> Component:
        """Return the body for a machine that is reduced for a band."""
        return self._body(self.fits[0], band_hz)

    def drawn(self, random: np.random.Generator, band_hz: float) -> Component:
        """Return the body drawn from its uncertainty."""
        return self._body(self.fits[int(random.integers(2))].drawn(random), band_hz)

    def _body(self, fit: FittedFrfs, band_hz: float) -> Component:
        ports = {label: [at] for at, label in enumerate(self.labels)}
        found = modal_body(fit.table(), ports, BodySource.FRF_BLOCK)
        return with_exact_residual(
            replace(found, name=self.name), shift_of_band(band_hz)
        )


@dataclass(frozen=True, slots=True)
class MachineLink:
    """A spring and damper along a direction from a point of a measured body.

    Attributes:
        name: of the link.
        first: measured body and label of its point.
        second: the same of another one; or a modelled body, with `position`; None is
            the ground.
        position: on the modelled body [m].
        direction: in which the measured body was struck.
        stiffness: one value [N/m].
        damping: one value [N s/m].
        deviations: relative standard deviations of both [-].
    """

    name: str
    first: tuple[str, str]
    second: tuple[str, str] | None
    position: tuple[float, float, float] | None
    direction: tuple[float, float, float]
    stiffness: tuple[float]
    damping: tuple[float] = (0.0,)
    deviations: tuple[float, float] = (0.0, 0.0)

    @property
    def matrices(self) -> None:
        """A link has single values."""
        return


def with_exact_residual(body: Component, shift: float) -> Component:
    """Return a body that is its coordinates and no more, with the norm of residuals.

    Args:
        body: of measured modes.
        shift: of the machine [1/s^2].
    """
    level = np.diag(body.stiffness)
    loads = [rows.T for rows in body.rows.values()]
    stack = np.concatenate([body.stiffness, np.eye(level.size), *loads], axis=1)
    return replace(
        body,
        residual=Residual(
            root=stack / np.sqrt(level + shift)[:, None],
            patterns={name: np.eye(rows.shape[0]) for name, rows in body.rows.items()},
            compliance=dict.fromkeys(body.rows, 0.0),
            shift=shift,
        ),
    )


def rigid_link_stiffness(bodies: Sequence[Component], link: MachineLink) -> float:
    """Return a stiffness that is rigid compared with the measured body [N/m]."""
    body = next(one for one in bodies if one.name == link.first[0])
    level = np.diag(body.stiffness)
    elastic = level > 0.0
    rows = body.port(link.first[1])[0, elastic]
    flexibility = float(np.sum(rows**2 / level[elastic]))
    return _RIGID * max(1.0 / max(flexibility, 1e-300), link.stiffness[0])


def require_points(parts: Sequence[MeasuredPart], links: Sequence[MachineLink]) -> None:
    """Check that the points of links exist.

    Raises:
        UsageError: there is no such measured body or point.
    """
    labels = {part.name: part.labels for part in parts}
    for link in links:
        ends = [link.first]
        if link.second is not None and link.position is None:
            ends.append(link.second)
        for body, label in ends:
            if label not in labels.get(body, ()):
                raise UsageError(
                    f"link {link.name!r}: no point {label!r} of measured body "
                    f"{body!r}; there are {dict(labels)}"
                )
