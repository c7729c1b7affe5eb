"""What a release states is the same everywhere."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_version_and_licence_are_those_of_the_project() -> None:
    """A citation names the version that was used."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    facts = dict(re.findall(r"^(\S+): (\S+)$", citation, re.MULTILINE))
    assert facts["version"] == project["version"]
    assert facts["license"] == project["license"]
