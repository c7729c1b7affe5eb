# SPDX-License-Identifier: MIT
"""Records of surface texture: what was filtered how, and the parameters."""

from dataclasses import dataclass, field

from jointbench.acquisition.basics.array_checks import require_positive, require_shape
from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, freeze
from jointbench.signal.roughness.material_ratio import MaterialRatio


@dataclass(frozen=True, slots=True)
class TextureSettings:
    """How texture is separated from form and waves.

    Attributes:
        short: nesting index of the S-filter [m]; None for none.
        long: nesting index of the L-filter [m]; None for none.
        form: degree of the polynomial of the F-operation [-].
        robust: whether the L-filter is the robust Gaussian regression.
        setting_class: name of the class that gave the indices, ``""`` for stated ones.
    """

    short: float | None
    long: float | None
    form: int = 1
    robust: bool = False
    setting_class: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Texture:
    """The scale-limited profile or map that parameters are computed from.

    Attributes:
        heights: about the reference line or plane [m]; 0 where not `valid`.
        valid: False where a point is missing, same shape.
        spacing: [m], of a map along (rows, columns).
        reference: what the filters took from the primary profile or map [m].
        settings: nesting indices and form.
        sections: of the evaluation length [-]; 1 for a map.
        remarks: departures from the default settings, one sentence each.
        offset: index of the first evaluated point in the surface as measured.
    """

    heights: FloatArray
    valid: BoolArray
    spacing: tuple[float, ...]
    reference: FloatArray
    settings: TextureSettings
    sections: int = 1
    remarks: tuple[str, ...] = ()
    offset: tuple[int, ...] = field(default=(0,))

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_shape("valid", self.valid, self.heights.shape)
        for one in self.spacing:
            require_positive("spacing", one)
        freeze(self, "heights", "valid", "reference")


@dataclass(frozen=True, slots=True, eq=False)
class TextureParameters:
    """Parameters of one texture.

    Attributes:
        values: by name; None where a parameter is not defined, SI units.
        curve: material ratio curve.
    """

    values: dict[str, float | None]
    curve: MaterialRatio
