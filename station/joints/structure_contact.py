# SPDX-License-Identifier: MIT
"""The table [contact] of a structure model: what the contact law needs of one joint."""

from collections.abc import Sequence
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator

from jointbench.acquisition.basics.errors import BadData, JointbenchError
from jointbench.acquisition.basics.units import parse_value
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.models import Mode
from jointbench.analysis.contact.surface import ContactSurface
from jointbench.analysis.contact.torque_to_preload import Preload
from jointbench.station.pipeline.contact_prediction import surface_of
from jointbench.station.pipeline.contact_request import parse_hardness, parse_models

LADDER = ("ke_2d", "ke_3d", "ke_3d_modified")
"""The three models that Fig. 9 of the 2025 paper compares with the test."""

_KINDS = {
    "modulus": "pressure",
    "diameter": "length",
    "hardness_sd": "ratio",
}


class TheoryTable(BaseModel):
    """What the contact law needs of one joint beside what was measured.

    Modulus is the composite one [Pa]. The surface comes from one or two files,
    from D and G, or from surfaces in the sessions. Preloads come with the sessions;
    where they do not, `preloads` gives them by state. Bolts turn them into torques.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    joint: str | None = None
    models: tuple[str, ...] = Field(default=LADDER, min_length=1)
    mode: Mode = Mode.CORRECTED
    modulus: float
    hardness: float
    hardness_sd: float = 0.0
    poisson: float = Field(default=0.25, ge=0, lt=0.5)
    surfaces: tuple[Path, ...] = ()
    columns: str | None = None
    dimension: float | None = None
    dimension_sd: float = Field(default=0.0, ge=0)
    roughness: str | None = None
    roughness_sd: str = "0 %"
    preloads: dict[str, float] = {}
    bolts: int = Field(default=1, ge=1)
    diameter: float | None = None
    nut_factor: float = Field(default=0.2, gt=0)
    nut_factor_sd: float = Field(default=0.0, ge=0)

    @field_validator("modulus", "diameter", "hardness_sd", mode="before")
    @classmethod
    def _with_unit(cls, value: object, info: ValidationInfo) -> float:
        return _read(value, _KINDS[str(info.field_name)])

    @field_validator("hardness", mode="before")
    @classmethod
    def _hardness(cls, value: object) -> float:
        try:
            return parse_hardness(_text(value))
        except JointbenchError as error:
            raise ValueError(str(error)) from error

    @field_validator("preloads", mode="before")
    @classmethod
    def _forces(cls, value: object) -> dict[str, float]:
        if not isinstance(value, dict):
            raise ValueError('write { "state" = "25 kN" }')  # noqa: TRY004
        return {str(key): _read(one, "force") for key, one in value.items()}

    @field_validator("models")
    @classmethod
    def _known_models(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        try:
            parse_models(value, Mode.CORRECTED, None)
        except JointbenchError as error:
            raise ValueError(str(error)) from error
        return value

    @property
    def material(self) -> ContactMaterial:
        """Both bodies as the contact law takes them."""
        return ContactMaterial(
            effective_modulus=self.modulus,
            hardness=self.hardness,
            poisson=self.poisson,
        )

    def spread_preload(self, value: float, measured_sd: float | None = None) -> Preload:
        """Return a preload with its uncertainty.

        Args:
            value: [N].
            measured_sd: by load washers or bolt elongation [N]; None where a torque
                gave the preload, which leaves open what the nut factor does.
        """
        if measured_sd is not None:
            return Preload(value, measured_sd)
        return Preload(value, value * self.nut_factor_sd / self.nut_factor)

    def torque(self, preload: float) -> float | None:
        """Return the torque on each bolt [N m]; None if no diameter is given."""
        if self.diameter is None:
            return None
        return preload * self.nut_factor * self.diameter / self.bolts


def _text(value: object) -> str:
    if not isinstance(value, str):
        # pydantic turns a ValueError, not a TypeError, into a named problem.
        raise ValueError(f"write the number with its unit, as text: '{value} ...'")  # noqa: TRY004
    return value


def _read(value: object, kind: str) -> float:
    try:
        number = parse_value(_text(value), kind)
    except JointbenchError as error:
        raise ValueError(str(error)) from error
    if number < 0:
        raise ValueError(f"{value!r} is below zero")
    return number


def joint_of(table: TheoryTable, joints: Sequence[str]) -> str:
    """Return the name of the joint that a table is about.

    Raises:
        ValueError: it is not named and there are several, or unknown.
    """
    if table.joint is None and len(joints) == 1:
        return joints[0]
    if table.joint is None or table.joint not in joints:
        raise ValueError(
            f"contact.joint is {table.joint!r}; name one of {list(joints)}, not glued"
        )
    return table.joint


def theory_surface(
    table: TheoryTable, folder: Path, files: list[Path], sessions: list[Path]
) -> ContactSurface:
    """Return the equivalent surface of the joint.

    Args:
        table: of the model file.
        folder: of the model file; its surface files are relative to it.
        files: surface files of the command line, which precede those of the table.
        sessions: in which surfaces are looked for when nothing else is given.

    Raises:
        BadData: no surface is given anywhere, or it has no scaling range.
    """
    if not files and (table.dimension is not None or table.roughness is not None):
        return surface_of(
            table.dimension,
            table.roughness,
            [],
            None,
            dimension_sd=table.dimension_sd,
            roughness_sd=table.roughness_sd,
        )
    files = files or [folder / one for one in table.surfaces] or sessions
    if not files:
        raise BadData(
            "[contact] has no surface; give --surface FILE once (both alike) "
            "or twice for two, or dimension and roughness in the table"
        )
    return surface_of(None, None, files, table.columns)
