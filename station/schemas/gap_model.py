# SPDX-License-Identifier: MIT
"""From a bench model file to nominal parameters with priors of the gap engine."""

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.model.nominal import NominalParameters
from jointbench.analysis.gap.model.stated_scatter import StatedScatter
from jointbench.station.schemas.bench_model import BenchModel, lumped_model


def nominal_parameters(bench: BenchModel) -> NominalParameters:
    """Return the model of a bench whose every value has a prior, and its hit points.

    Raises:
        BadData: a value or its standard deviation is missing, no body has a channel,
            or no link is a joint.
    """
    if all(body.channel is None for body in bench.bodies.values()):
        raise BadData(
            "no body of the model has a channel; add channel = 'a1' to the bodies that "
            "an accelerometer sits on"
        )
    if not any(link.joint for link in bench.links.values()):
        raise BadData(
            "no link of the model is a joint; add joint = true to each link where an "
            "effect may sit"
        )
    for name, body in bench.bodies.items():
        _require_prior(f"bodies.{name}", "mass", body.mass, body.mass_sd)
    for name, link in bench.links.items():
        where = f"links.{name}"
        _require_prior(where, "stiffness", link.stiffness, link.stiffness_sd)
        _require_prior(where, "damping", link.damping, link.damping_sd)
    points = {
        point: index
        for index, body in enumerate(bench.bodies.values())
        for point in body.points
    }
    return NominalParameters(
        lumped_model(bench),
        points,
        bench.gap.preload_reference,
        bench.gap.repeatability,
        StatedScatter(**bench.gap.scatter.model_dump()),
    )


def _require_prior(
    where: str, what: str, value: float | None, sd: float | None
) -> None:
    """Raise unless a value and its standard deviation are stated, above zero."""
    for key, number in ((what, value), (f"{what}_sd", sd)):
        if number is None or number <= 0:
            said = "is missing" if number is None else "is 0"
            raise BadData(
                f"{where}.{key} {said}; gap weighs every nominal value by its standard "
                f"deviation: give {what} and {what}_sd, above zero"
            )
