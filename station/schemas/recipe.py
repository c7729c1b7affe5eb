# SPDX-License-Identifier: MIT
"""The recipe (TOML): how recorded sessions are read again, stage by stage.

Numbers carry their unit as text ("2 ms") and are parsed once, here. What is left out
is chosen by the data, as `jointbench modal` chooses it.
"""

import json
import re
from hashlib import sha256
from pathlib import Path, PureWindowsPath
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    Field,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
    model_validator,
)

from jointbench.acquisition.basics.errors import BadData, JointbenchError
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.analysis.contact.model_catalogue import (
    contact_law_code,
    contact_model,
)
from jointbench.analysis.gap.catalogue.catalogue import check_names
from jointbench.analysis.gap.catalogue.installed_effects import (
    effect_code,
    installed_catalogue,
)
from jointbench.signal.roughness.setting_classes import setting_class
from jointbench.signal.roughness.uncertain_parameters import instrument_errors
from jointbench.signal.surface.form_removal import HIGHEST_DEGREE
from jointbench.station.files.toml_file import (
    StrictTable,
    read_toml,
)
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.positive_quantities import Force, Length, Pressure
from jointbench.station.schemas.recipe_modal_parts import (
    FrfPart,
    HitsPart,
    KalmanPart,
    ModesPart,
    WindowsPart,
)

_NAME = re.compile(r"\w([\w .-]{0,58}\w)?")
"""A recipe's name becomes part of file names: of the results, of the ledger."""


def _beside(text: str) -> str:
    """Refuse a file that is not below the recipe's folder."""
    for path in (Path(text), PureWindowsPath(text)):
        if path.anchor or ".." in path.parts or not text.isprintable():
            raise ValueError("name a file beside the recipe, or in a folder below it")
    return text


_FileBeside = Annotated[str, Field(min_length=1), AfterValidator(_beside)]


class SurfacePart(StrictTable):
    """Whether surfaces are fitted, with which frequency ratio and after which steps.

    The steps are those of `SurfaceTreatment`; the direction holds for maps. With `iso`
    the standard parameters are computed, with the same cut-offs and form.
    """

    use: bool = True
    gamma: Annotated[float, Field(gt=1)] | None = None
    form: Annotated[int, Field(ge=1, le=HIGHEST_DEGREE)] | None = None
    outliers: Annotated[float, Field(gt=1)] | None = None
    lambda_s: Length | None = None
    lambda_c: Length | None = None
    direction: Annotated[float, Field(ge=-180, le=180)] | None = None
    iso: bool | None = None
    setting_class: str | None = None
    robust: bool | None = None
    scale_errors: str | None = None

    @field_validator("setting_class")
    @classmethod
    def _known_class(cls, name: str | None) -> str | None:
        """Refuse a class that ISO 21920-3 has not."""
        return None if name is None else setting_class(name).name

    @field_validator("scale_errors")
    @classmethod
    def _known_errors(cls, text: str | None) -> str | None:
        """Refuse errors that are no shares."""
        instrument_errors(text)
        return text

    @model_serializer(mode="wrap")
    def _only_steps_taken(self, whole: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out steps that are not taken: results of older recipes keep keys."""
        content: dict[str, Any] = whole(self)
        always = ("use", "gamma")
        return {k: v for k, v in content.items() if k in always or v is not None}


class ContactPart(StrictTable):
    """Input of the contact laws for the prediction of the joint from its surfaces.

    The apparent area [m^2] asks for the laws of measured surfaces as well.
    """

    modulus: Pressure
    hardness: Pressure
    preload: Force | None = None
    poisson: Annotated[float, Field(ge=0, lt=0.5)] = 0.25
    model: str = "ke_3d_modified"
    area: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None


class IdentificationPart(StrictTable):
    """The bench model whose links are identified, beside the recipe."""

    model: _FileBeside


class GapPart(StrictTable):
    """The bench model whose gap is examined, and effects left out."""

    model: _FileBeside
    without: tuple[str, ...] = ()


class Recipe(StrictTable):
    """A recipe as written; `models` holds what its model files say, by their names."""

    name: str = ""
    hits: HitsPart = HitsPart()
    windows: WindowsPart = WindowsPart()
    frf: FrfPart = FrfPart()
    kalman: KalmanPart = KalmanPart()
    modes: ModesPart = ModesPart()
    surface: SurfacePart = SurfacePart()
    contact: ContactPart | None = None
    identification: IdentificationPart | None = None
    gap: GapPart | None = None
    models: dict[str, BenchModel] = Field(default_factory=dict, exclude=True)

    @model_validator(mode="before")
    @classmethod
    def _models_are_ours(cls, content: Any) -> Any:
        if isinstance(content, dict) and "models" in content:
            raise ValueError("'models' is no table of a recipe")
        return content


def read_recipe(path: Path) -> Recipe:
    """Read a recipe and the model files that it names.

    Args:
        path: of the TOML file; model files lie beside it.

    Returns:
        The recipe, called after its file where it has no name.

    Raises:
        BadData: it or a model file breaks a rule; the message names file, key, value
            and rule.
    """
    recipe = read_toml(path, Recipe)
    name = recipe.name or path.stem
    if _NAME.fullmatch(name) is None:
        raise BadData(
            f"{named(path)}: the recipe's name is {shown(name)}, and becomes part of "
            "file names: write letters, digits, spaces, dots, - and _, 60 at "
            "the most, as name = '...' or as the file's own name"
        )
    _check_names(recipe, path)
    wanted = {
        part.model for part in (recipe.identification, recipe.gap) if part is not None
    }
    models = {model: read_toml(path.parent / model, BenchModel) for model in wanted}
    return recipe.model_copy(update={"models": models, "name": name})


def _check_names(recipe: Recipe, path: Path) -> None:
    """Refuse unknown names of contact models and effects, before any work."""
    key = ""
    try:
        if recipe.contact is not None:
            key = "contact.model"
            contact_model(recipe.contact.model)
        if recipe.gap is not None:
            key = "gap.without"
            check_names(recipe.gap.without, installed_catalogue())
    except JointbenchError as error:
        raise BadData(f"{named(path)}: key {key!r}: {error}") from error


def recipe_content(recipe: Recipe) -> dict[str, object]:
    """Return all that a result depends on: not the name, but what the models say.

    A contact law and effects of other packages count by version and code.
    """
    content = recipe.model_dump(mode="json", exclude={"name"})
    code = [
        *(contact_law_code(recipe.contact.model) if recipe.contact else ()),
        *(effect_code(recipe.gap.without) if recipe.gap else ()),
    ]
    return (
        content
        | ({"packages": code} if code else {})
        | {
            "models": {
                name: model.model_dump(mode="json")
                for name, model in sorted(recipe.models.items())
            }
        }
    )


def recipe_digest(recipe: Recipe) -> str:
    """Return the SHA-256 of what a recipe says, however it is written."""
    text = json.dumps(recipe_content(recipe), sort_keys=True)
    return sha256(text.encode()).hexdigest()
