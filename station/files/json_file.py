# SPDX-License-Identifier: MIT
"""Read a JSON file into a pydantic model; what is wrong is one line with its key."""

import json
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.text_files import read_bytes
from jointbench.station.files.toml_file import first_problem

_Model = TypeVar("_Model", bound=BaseModel)
_MAX_BYTES = 1_000_000


def read_json(path: Path, model: type[_Model]) -> _Model:
    """Read `path` as `model`.

    Raises:
        BadData: the file is missing, not JSON, or breaks a rule; the message names the
            file, the key, the value and the rule.
        HostileFile: it is larger than a megabyte.
    """
    content = read_bytes(path, limit=_MAX_BYTES)
    try:
        return model.model_validate(json.loads(content.decode("utf-8")))
    except ValidationError as error:
        raise BadData(f"{named(path)}: {first_problem(error, model)}") from error
    except (ValueError, RecursionError) as error:  # JSONDecodeError is a ValueError
        raise BadData(f"{named(path)}: not a JSON file ({error})") from error
