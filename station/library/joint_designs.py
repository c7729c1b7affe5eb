# SPDX-License-Identifier: MIT
"""Hit points and sensors before the first hit, and the next step after it."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointbench.station.design.design_output import (
    design_json,
    next_remarks,
    parameter_rows,
    plan_text,
)
from jointbench.station.design.design_records import DesignedTest, DesignRequest
from jointbench.station.design.run_design import designed_test
from jointbench.station.files.output_paths import write_text
from jointbench.station.library.argument_checks import one_path
from jointbench.station.library.result_view import ResultView, Shown


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PlannedTest(Shown):
    """A test plan with what it is expected to give.

    Attributes:
        result: points, expected deviations, and what one more step buys.
    """

    result: DesignedTest

    @property
    def sensors(self) -> tuple[str, ...]:
        """Names of the points with a sensor."""
        return tuple(self.result.points[at] for at in self.result.plan.sensors)

    @property
    def hits(self) -> tuple[str, ...]:
        """Names of the points that are struck."""
        return tuple(self.result.points[at] for at in self.result.plan.hits)

    def write_plan(self, template: str | Path, path: str | Path) -> None:
        """Write a plan of ``measure`` with these points.

        Args:
            template: plan with as many sensors, whose points are replaced.
            path: of the plan to write.
        """
        text = Path(template).read_text(encoding="utf-8")
        write_text(Path(path), plan_text(self.result, text))

    def to_dict(self) -> dict[str, Any]:
        """Return the plan as plain data, as ``design --json`` writes it."""
        return design_json(self.result)

    @property
    def view(self) -> ResultView:
        """Points, expected intervals, and the best step of each kind."""
        title = f"Sensors {', '.join(self.sensors)}; hits {', '.join(self.hits)}"
        columns = ("parameter", "expected 95 % [± %]", "evenly spread [± %]")
        rows = tuple(parameter_rows(self.result))
        return ResultView(title, columns, rows, tuple(next_remarks(self.result)))


def design(
    model: str | Path,
    *,
    values: str | Path | None = None,
    state: str | None = None,
    measured: bool = False,
    deviation: float | None = None,
    mass: float | None = None,
    torques: Sequence[float] = (),
) -> PlannedTest:
    """Choose hit points and sensors, or the next step of a measured plan.

    Args:
        model: structure model (TOML) with [design] and [reachable.*].
        values: JSON of ``identify``; None takes the expected values of the model.
        state: label in it, where it holds several.
        measured: [sensors] and [hits] of the model are measured: what would help most
            next.
        deviation: wanted relative standard deviation; the hits that reach it.
        mass: with `measured`, a mass that could be added [kg].
        torques: with `measured`, torques that could be next, beside those of the model
            [N m].

    Raises:
        BadData: the model lacks what a design needs.
        UsageError: more points are asked for than there are.
    """
    request = DesignRequest(
        None if values is None else Path(values),
        state,
        measured,
        deviation,
        mass,
        plan_torques=tuple(torques),
    )
    return PlannedTest(designed_test(one_path(model, "a model"), request))
