"""The commands of README, pages and examples, as a reader would type them."""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"^```sh\n(.*?)^```", re.DOTALL | re.MULTILINE)
REASONS = (
    "needs hardware",
    "needs a cluster",
    "needs data of others",
    "needs the source tree",
    "needs an interrupted recording",
    "runs until Ctrl-C",
    "takes minutes",
    "installs",
)
"""What a comment says of a command that the tests do not run."""
GENERATED = ROOT / "docs" / "command-line.md"
"""The page of first examples of the help, which has no comments."""
OF_COMMANDS = {
    "agreement": "takes minutes",
    "bench": "needs hardware",
    "demo": "takes minutes",
    "design": "takes minutes",
    "desk": "runs until Ctrl-C",
    "doctor": "needs hardware",
    "export-joint": "takes minutes",
    "measure": "needs hardware",
    "profile": "needs hardware",
    "record": "takes minutes",
    "recover": "needs an interrupted recording",
    "send": "needs hardware",
    "simulate": "runs until Ctrl-C",
}
"""Why first examples of the help are not run."""
INSTALLERS = ("python3 -m venv", ".venv", "pip ", "source ", "git ", "_JOINTBENCH")


@dataclass(frozen=True, slots=True)
class PageCommand:
    """One command of a page.

    Attributes:
        text: as it stands there, lines joined, without its comment.
        remark: its comment.
    """

    text: str
    remark: str

    @property
    def words(self) -> list[str]:
        """The words of the command."""
        return shlex.split(self.text)

    @property
    def reason(self) -> str:
        """Why it is not run; empty if it is."""
        if self.text.startswith(INSTALLERS):
            return "installs"
        return next((one for one in REASONS if one in self.remark), "")


def pages() -> list[Path]:
    """Return README, pages and the texts of the examples."""
    found = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    found += (ROOT / "examples").glob("*/README.md")
    return [path for path in sorted(found) if BLOCK.search(_text(path))]


def commands(path: Path) -> list[PageCommand]:
    """Return the commands of all shell blocks of a page, in their order."""
    return [one for block in BLOCK.findall(_text(path)) for one in _split(block)]


def not_run(path: Path) -> Iterator[tuple[str, str]]:
    """Yield the commands of a page that are not run, with the reason."""
    for one in commands(path):
        reason = one.reason
        if path == GENERATED and one.text.startswith("jointbench "):
            reason = OF_COMMANDS.get(one.words[1], "")
        if reason not in {"", "installs"}:
            yield one.text, reason


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _split(block: str) -> Iterator[PageCommand]:
    for line in block.replace("\\\n", " ").splitlines():
        text, _, remark = line.partition(" #")
        if text.strip() and not text.startswith("#"):
            for one in text.split(" && "):
                yield PageCommand(" ".join(one.split()), remark.strip())
