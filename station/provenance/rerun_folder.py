# SPDX-License-Identifier: MIT
"""A folder with all that is needed to run a result again."""

import csv
import io
import json
import shutil
from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import named
from jointbench.station.files.computing_environment import LIBRARIES, NOT_INSTALLED
from jointbench.station.files.output_paths import make_folder, write_text
from jointbench.station.provenance.result_provenance import ResultProvenance
from jointbench.station.provenance.uncertainty_budget import BudgetRow
from jointbench.station.schemas.stored_recipe import stored_recipe

FILES = (
    "README.md",
    "provenance.json",
    "recipe.json",
    "requirements.txt",
    "uncertainty.csv",
)
"""What the folder holds besides the session and the result."""


def write_rerun(found: ResultProvenance, folder: Path, *, overwrite: bool) -> Path:
    """Write session, result, recipe, versions and the commands to a folder.

    Args:
        found: the provenance.
        folder: made if need be.
        overwrite: replace files that are there.

    Returns:
        The README, which has the commands.

    Raises:
        UsageError: the result has no recipe (`modal` wrote it), its session is not
            beside it unchanged, or the folder holds something.
    """
    if not found.result.recipe:
        raise UsageError(
            f"{named(found.result.path)} was written by `modal` and holds no recipe; "
            "`jointbench process` writes a result that can be run again"
        )
    if found.session is None:
        raise UsageError(
            f"{named(found.result.facts['input_file'])} does not lie beside "
            f"{named(found.result.path)} as it was processed (SHA-256 "
            f"{found.result.facts['input_sha256'][:12]}...); put it there"
        )
    if folder.exists() and any(folder.iterdir()) and not overwrite:
        raise UsageError(f"{named(folder)} is not empty; name another, or add --force")
    make_folder(folder)
    shutil.copyfile(found.session, folder / found.session.name)
    shutil.copyfile(found.result.path, folder / _first(found))
    name = found.result.facts["recipe_name"]
    texts = {
        "recipe.json": stored_recipe(name, found.result.recipe),
        "provenance.json": json.dumps(_plain(found.as_json()), indent=2) + "\n",
        "requirements.txt": _requirements(found.environment),
        "uncertainty.csv": _budget(found.budget),
        "README.md": _readme(found),
    }
    for name, text in texts.items():
        write_text(folder / name, text)
    return folder / "README.md"


def _first(found: ResultProvenance) -> str:
    """Return the name of the copy of the result, unlike that of the new one."""
    return f"first-{found.result.path.name}"


def _requirements(environment: Mapping[str, str]) -> str:
    pinned = {
        name: environment[name]
        for name in ("jointbench", *LIBRARIES)
        if environment.get(name, NOT_INSTALLED) != NOT_INSTALLED
    }
    return "".join(f"{name}=={version}\n" for name, version in pinned.items())


def _budget(rows: tuple[BudgetRow, ...]) -> str:
    buffer = io.StringIO()
    names = [field.name for field in fields(BudgetRow)]
    writer = csv.DictWriter(buffer, names, lineterminator="\n")
    writer.writeheader()
    writer.writerows(asdict(row) for row in rows)
    return buffer.getvalue()


def _readme(found: ResultProvenance) -> str:
    session = found.session.name if found.session is not None else ""
    facts, environment = found.result.facts, found.environment
    build = environment.get("build_sha256", "not known")
    return (
        f"# {found.result.path.name}, run again\n"
        f"Made on {facts['created']} by {facts['software']}, build {build[:12]}, on "
        f"{environment.get('python', 'an unknown Python')}.\n"
        "```sh\n"
        "python3 -m venv again && again/bin/pip install -r requirements.txt\n"
        f"again/bin/jointbench process {json.dumps(session)} --recipe recipe.json "
        "--out again.results.h5\n"
        f"again/bin/jointbench compare {json.dumps(_first(found))} again.results.h5\n"
        "```\n"
        "`compare` lists every number that differs. `provenance.json` has inputs, "
        "versions, sensors and the keys of all stages; `uncertainty.csv` the "
        "contributions to each standard deviation.\n"
    )


def _plain(value: Any) -> Any:
    """Return data for JSON; numbers that are none become null."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_plain(one) for one in value]
    return None if isinstance(value, float) and value != value else value
