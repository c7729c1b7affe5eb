# SPDX-License-Identifier: MIT
"""A flexible bench as a model file of meshed bodies (TOML)."""

import numpy as np

from jointbench.simulators.flexible.flexible_bench import FlexibleBench
from jointbench.simulators.flexible.flexible_specimen import (
    BodyPlace,
    ElasticBody,
    Vector,
)
from jointbench.simulators.flexible.hit_plan import AIM_SIGMA, TILT_SIGMA
from jointbench.simulators.flexible.joint_values import (
    BOLT_SIGMA,
    DAMPING_SIGMA,
    FEET_SIGMA,
    MODULUS_SIGMA,
    STIFFNESS_SIGMA,
)

_CELL = 0.02  # largest side of an element in the plane of a body [m]
_RADIUS = 0.006  # of the area that stands for a bolt, a point in the simulation [m]
_BAND = 2000.0  # modes beyond the simulated ones matter above [Hz]
_SHAPE_ERROR = 0.005  # of the mesh beside the simulated bodies [-]


def mesh_model_text(bench: FlexibleBench) -> str:
    """Return the bench as ``gap`` takes it, with nominal values.

    Args:
        bench: as drawn; what is hidden is not stated.
    """
    specimen = bench.specimen
    lines = [line for body in specimen.bodies for line in _body(body)]
    spots = ", ".join(
        f"{{ centre = [{_mm(x)}, {_mm(y)}], radius = {_mm(_RADIUS)} }}"
        for x, y, _ in specimen.bolts
    )
    lines += ["[joints.bolts]", 'between = ["bottom", "top"]', f"patches = [{spots}]"]
    for table, places in (("sensors", specimen.sensors), ("hits", specimen.points)):
        lines += [line for place in places for line in _place(table, place)]
    return "\n".join([*lines, *_gap(bench), ""])


def _body(body: ElasticBody) -> list[str]:
    block = body.block
    cells = [max(round(side / _CELL), 2) for side in block.size]
    return [
        f"[materials.{body.name}] # {body.material}",
        f'youngs_modulus = "{1e-9 * block.youngs_modulus:g} GPa"',
        f"poisson_ratio = {block.poisson_ratio:g}",
        f'density = "{block.density:g} kg/m^3"',
        f"[bodies.{body.name}]",
        f"box = {_vector(block.size)}",
        f"cells = {cells}",
        f"origin = {_vector(body.corner)}",
        f'material = "{body.name}"',
    ]


def _place(table: str, place: BodyPlace) -> list[str]:
    return [
        f"[{table}.{place.name}]",
        f'body = "{("bottom", "top")[place.body]}"',
        f"position = {_vector(place.position)}",
        f"direction = {list(place.direction)}",
    ]


def _gap(bench: FlexibleBench) -> list[str]:
    nominal, specimen = bench.nominal, bench.specimen
    names = ("tangential_1", "tangential_2", "normal")
    values = zip(names, nominal.stiffness[0].tolist(), strict=True)
    feet = ", ".join(
        f'{{ body = "bottom", position = {_vector(at)} }}' for at in specimen.feet
    )
    return [
        "[gap]",
        f'band = "{_BAND:g} Hz"',
        f'damping_ratio = "{nominal.damping_ratio[0]:g}"',
        f'damping_sd = "{DAMPING_SIGMA:g}"',
        f'modulus_sd = "{MODULUS_SIGMA:g}"',
        f'shape_sd = "{_SHAPE_ERROR:g}"',
        f'aim_sd = "{1e3 * AIM_SIGMA:g} mm"',
        f'tilt_sd = "{np.degrees(TILT_SIGMA):g} deg"',
        "[gap.bolt]",
        *(
            f'{name} = "{"rigid" if np.isinf(k) else f"{k:g} N/m"}"'
            for name, k in values
        ),
        f'normal_damping = "{nominal.damping[0, 2]:g} N s/m"',
        f'tangential_damping = "{nominal.damping[0, 0]:g} N s/m"',
        f'stiffness_sd = "{STIFFNESS_SIGMA:g}"',
        f'damping_sd = "{DAMPING_SIGMA:g}"',
        f'scatter = "{BOLT_SIGMA:g}"',
        "[gap.feet]",
        f"places = [{feet}]",
        f'stiffness = "{nominal.feet_stiffness:g} N/m"',
        f'damping = "{nominal.feet_damping:g} N s/m"',
        f'stiffness_sd = "{FEET_SIGMA:g}"',
        f'damping_sd = "{DAMPING_SIGMA:g}"',
    ]


def _vector(place: Vector) -> str:
    return f"[{', '.join(_mm(value) for value in place)}]"


def _mm(value: float) -> str:
    return f'"{1e3 * value:g} mm"'
