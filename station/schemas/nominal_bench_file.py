# SPDX-License-Identifier: MIT
"""The nominal parameters: what is known of two bolted plates before the hits (JSON)."""

import math
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.quoting import named, visible
from jointbench.analysis.gap.intake.free_modes import PlannedPoint
from jointbench.analysis.gap.structure_response.jointed_bodies import NominalBench
from jointbench.station.files.json_file import read_json

NOMINAL_SCHEMA = "bench-sheet/1"
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Sigma = Annotated[float, Field(gt=0, le=3, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Stiffness = Positive | Literal["rigid"]


class _NominalPart(BaseModel):
    """A part of the nominal parameters; keys that are not used here are allowed."""

    model_config = ConfigDict(extra="ignore", frozen=True)


class _Plates(_NominalPart):
    modulus_sigma: Sigma = Field(alias="E_rel_sigma")
    mass_rel_sigma: Sigma


class _NominalPoint(_NominalPart):
    direction: tuple[Finite, Finite, Finite]
    body: str
    position_mm: tuple[Finite, Finite, Finite] | None = None


class _Sigmas(_NominalPart):
    k: Sigma
    c: Sigma


class _Joint(_NominalPart):
    normal: Stiffness = Field(alias="kn_N_per_m")
    along_x: Stiffness = Field(alias="ktx_N_per_m")
    along_y: Stiffness = Field(alias="kty_N_per_m")
    normal_damping: Positive = Field(alias="cn_Ns_per_m")
    tangential_damping: Positive = Field(alias="ct_Ns_per_m")
    rel_sigma: _Sigmas
    bolt_to_bolt_rel_sigma: Sigma


class _Feet(_NominalPart):
    stiffness: Positive = Field(alias="k_N_per_m")
    damping: Positive = Field(alias="c_Ns_per_m")
    rel_sigma: _Sigmas


class _ModalTable(_NominalPart):
    frequency_rel_sigma: Annotated[float, Field(ge=0, le=0.1)] = 0.0
    shape_rel_sigma: Annotated[float, Field(ge=0, le=0.3)] = 0.0


class NominalFile(_NominalPart):
    """the nominal parameters as written."""

    schema_: Literal["bench-sheet/1"] = Field(alias="schema")
    plates: _Plates
    bolts_mm: Annotated[
        tuple[tuple[Finite, Finite, Finite], ...], Field(max_length=1000)
    ] = ()
    torques: Annotated[
        tuple[Positive, ...], Field(alias="torques_Nm", min_length=1, max_length=100)
    ]
    hammer_points: Annotated[
        dict[str, _NominalPoint], Field(min_length=1, max_length=100)
    ]
    aim_sigma_mm: Positive
    tilt_sigma_deg: Positive
    joint_per_bolt: _Joint
    plate_damping_ratio: Positive
    plate_damping_rel_sigma: Sigma
    feet: _Feet
    modal_table: _ModalTable = _ModalTable()


def read_nominal(path: Path) -> tuple[NominalBench, dict[str, PlannedPoint]]:
    """Read nominal parameters.

    Returns:
        Nominal parameters, and hammer points by name.

    Raises:
        BadData: the file is missing, no JSON, or breaks a rule; the message names the
            key, the value and the rule.
    """
    found = read_json(path, NominalFile)
    points = {}
    for name, point in found.hammer_points.items():
        length = math.hypot(*point.direction)
        if length == 0:
            raise BadData(
                f"{named(path)}: hammer point {visible(name)} has direction 0 0 0; "
                "write the direction of the hit"
            )
        x, y, z = (v / length for v in point.direction)
        points[name] = PlannedPoint((x, y, z), point.body, _metres(point.position_mm))
    return _nominal(found), points


def _metres(
    place: tuple[float, float, float] | None,
) -> tuple[float, float, float] | None:
    if place is None:
        return None
    x, y, z = (1e-3 * value for value in place)
    return x, y, z


def _nominal(found: NominalFile) -> NominalBench:
    joint, feet = found.joint_per_bolt, found.feet
    stiffness = [
        math.inf if k == "rigid" else k
        for k in (joint.along_x, joint.along_y, joint.normal)
    ]
    across, normal = joint.tangential_damping, joint.normal_damping
    return NominalBench(
        stiffness=np.array(stiffness),
        damping=np.array([across, across, normal]),
        stiffness_sd=joint.rel_sigma.k,
        damping_sd=joint.rel_sigma.c,
        bolt_sd=joint.bolt_to_bolt_rel_sigma,
        foot=(feet.stiffness, feet.damping),
        foot_sd=(feet.rel_sigma.k, feet.rel_sigma.c),
        loss=(found.plate_damping_ratio, found.plate_damping_rel_sigma),
        modulus_sd=found.plates.modulus_sigma,
        mass_sd=found.plates.mass_rel_sigma,
        aim_sd=1e-3 * found.aim_sigma_mm,
        tilt_sd=math.radians(found.tilt_sigma_deg),
        torque_reference=float(np.median(found.torques)),
        bolt_places=1e-3 * np.array(found.bolts_mm).reshape(-1, 3)[:, :2],
        table_sd=(
            found.modal_table.frequency_rel_sigma,
            found.modal_table.shape_rel_sigma,
        ),
    )
