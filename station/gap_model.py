# SPDX-License-Identifier: MIT
"""From a bench model file to the sheet of the gap engine: values with priors."""

from collections.abc import Sequence

from jointbench.acquisition.errors import BadData
from jointbench.analysis.gap.model import Body, Channel, Link, LumpedModel, Output
from jointbench.analysis.gap.sheet import Sheet
from jointbench.station.bench_model import GROUND, BenchModel, BodyTable, LinkTable

OUTPUTS = {
    "displacement": Output.DISPLACEMENT,
    "velocity": Output.VELOCITY,
    "acceleration": Output.ACCELERATION,
}


def gap_sheet(bench: BenchModel) -> Sheet:
    """Return bodies, links and channels with priors, as the gap engine takes them.

    Raises:
        BadData: a value or its standard deviation is missing, no body has a channel,
            or no link is a joint.
    """
    names = list(bench.bodies)
    channels = tuple(
        Channel(body.channel, index)
        for index, body in enumerate(bench.bodies.values())
        if body.channel is not None
    )
    if not channels:
        raise BadData(
            "no body of the model has a channel; add channel = 'a1' to the bodies that "
            "an accelerometer sits on"
        )
    if not any(link.joint for link in bench.links.values()):
        raise BadData(
            "no link of the model is a joint; add joint = true to each link where an "
            "effect may sit"
        )
    model = LumpedModel(
        bodies=tuple(_body(name, body) for name, body in bench.bodies.items()),
        links=tuple(_link(name, link, names) for name, link in bench.links.items()),
        channels=channels,
        output=OUTPUTS[bench.gap.output],
    )
    points = {
        point: index
        for index, body in enumerate(bench.bodies.values())
        for point in body.points
    }
    return Sheet(model, points, bench.gap.preload_reference, bench.gap.repeatability)


def _body(name: str, body: BodyTable) -> Body:
    spread = _spread(f"bodies.{name}", "mass", body.mass, body.mass_sd)
    return Body(name, body.mass, spread)


def _link(name: str, link: LinkTable, bodies: Sequence[str]) -> Link:
    first, second = link.between
    if second == GROUND:
        first, second = second, first
    where = f"links.{name}"
    stiffness_spread = _spread(where, "stiffness", link.stiffness, link.stiffness_sd)
    damping_spread = _spread(where, "damping", link.damping, link.damping_sd)
    return Link(
        name,
        -1 if first == GROUND else bodies.index(first),
        bodies.index(second),
        link.stiffness or 0.0,
        link.damping or 0.0,
        stiffness_spread,
        damping_spread,
        joint=link.joint,
    )


def _spread(where: str, what: str, value: float | None, sd: float | None) -> float:
    """Return the sd of log(parameter / nominal) [-]."""
    for key, number in ((what, value), (f"{what}_sd", sd)):
        if number is None or number <= 0:
            said = "is missing" if number is None else "is 0"
            raise BadData(
                f"{where}.{key} {said}; gap weighs every nominal value by its standard "
                f"deviation: give {what} and {what}_sd, above zero"
            )
    return float((sd or 0.0) / (value or 1.0))
