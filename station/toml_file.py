# SPDX-License-Identifier: MIT
"""Read a TOML file into a pydantic model; what is wrong is one line with its key."""

import tomllib
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from jointbench.acquisition.errors import BadData

Model = TypeVar("Model", bound=BaseModel)
MOST_BYTES = 1_000_000


def read_toml(path: Path, model: type[Model]) -> Model:
    """Read `path` as `model`.

    Raises:
        BadData: the file is missing, too large, not TOML, or breaks a rule; the
            message names the file, the key, the value and the rule.
    """
    try:
        if path.stat().st_size > MOST_BYTES:
            raise BadData(f"{path}: larger than {MOST_BYTES} bytes, not a model file")
        content = tomllib.loads(path.read_text(encoding="utf-8-sig"))
        return model.model_validate(content)
    except FileNotFoundError as error:
        raise BadData(f"{path}: no such file; check the path") from error
    except ValidationError as error:
        raise BadData(f"{path}: {_first(error)}") from error
    except (ValueError, RecursionError) as error:  # TOMLDecodeError is a ValueError
        raise BadData(f"{path}: not a TOML file ({error})") from error


def _first(error: ValidationError) -> str:
    problem = error.errors(include_url=False)[0]
    key = ".".join(str(part) for part in problem["loc"]) or "(top level)"
    more = error.error_count() - 1
    also = f" (and {more} more)" if more else ""
    value = repr(problem["input"])
    shown = value if len(value) <= 60 else value[:57] + "..."
    return f"key {key!r}, value {shown}: {problem['msg']}{also}"
