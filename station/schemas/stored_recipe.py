# SPDX-License-Identifier: MIT
"""The recipe of a result as JSON, by which the result is made again.

All numbers are in SI units and exact, and the models are part of it: it has the key of
the recipe that it was stored from.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import read_bytes
from jointbench.station.files.toml_file import IN_SI, first_problem
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.recipe import Recipe

SCHEMA_OF_RECIPES = "jointbench-recipe/1"
_MOST_BYTES = 10_000_000
_CODE = "packages"
"""Key under which the code of contact laws and effects of other packages counts."""


def stored_recipe(name: str, content: Mapping[str, Any]) -> str:
    """Return the recipe of a result as JSON that `read_stored_recipe` reads.

    Args:
        name: of the recipe.
        content: as `recipe_content` gave it.
    """
    whole = {"schema": SCHEMA_OF_RECIPES, "name": name, "content": content}
    return json.dumps(whole, indent=1) + "\n"


def read_stored_recipe(path: Path) -> Recipe:
    """Read a recipe that `stored_recipe` wrote.

    Raises:
        BadData: it is none, or breaks a rule of recipes.
    """
    try:
        found = json.loads(read_bytes(path, limit=_MOST_BYTES))
        _require_schema(found["schema"])
        content = {k: v for k, v in found["content"].items() if k != _CODE}
        models = {
            str(name): BenchModel.model_validate(model, context=IN_SI)
            for name, model in content.pop("models", {}).items()
        }
        named_so = {"name": str(found["name"])}
        recipe = Recipe.model_validate(content | named_so, context=IN_SI)
    except ValidationError as error:
        raise BadData(f"{named(path)}: {first_problem(error, Recipe)}") from error
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise BadData(
            f"{named(path)} is no recipe of a result ({shown(error)}); `jointbench "
            "provenance RESULT --out FOLDER` writes one"
        ) from error
    return recipe.model_copy(update={"models": models})


def _require_schema(schema: object) -> None:
    if schema != SCHEMA_OF_RECIPES:
        raise ValueError(f"its schema is {schema!r}, not {SCHEMA_OF_RECIPES!r}")
