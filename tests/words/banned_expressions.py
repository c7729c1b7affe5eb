"""Expressions that the glossary replaces, and where they stand in the tree.

`python tests/words/banned_expressions.py [PATH...]` lists them.
"""

import ast
import io
import re
import sys
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
FOLDERS = (
    "acquisition",
    "signal",
    "analysis",
    "simulators",
    "station",
    "library",
    "benchmarks",
    "examples",
    "tests",
)
# The list itself, and the page that explains it, name what they ban.
EXEMPT = {
    "tests/words/banned_expressions.py",
    "tests/words/test_words.py",
    "docs/glossary.md",
}


@dataclass(frozen=True, slots=True)
class Banned:
    """One expression that is not used.

    Attributes:
        expression: as the glossary page lists it.
        pattern: what finds it in a text; letter case does not count.
        say: the standard term.
        fine: what the pattern may find in another sense; "" for nothing.
        only: paths must begin with one of these; () for everywhere.
        elsewhere: paths that begin with one of these are left out.
    """

    expression: str
    pattern: str
    say: str
    fine: str = ""
    only: tuple[str, ...] = ()
    elsewhere: tuple[str, ...] = ()


_CODE = ("acquisition/", "signal/", "analysis/", "simulators/", "station/", "library/")
_MESHES = (
    "analysis/structures/",
    "tests/analysis/structures/",
    "docs/joint-",
    "benchmarks/structures/",
)
_GAP = ("analysis/gap/", "station/gap/", "docs/gap", "tests/analysis/gap/")

BANNED = (
    Banned(
        "tell, tells, told, telling",
        r"\b(tells?|telling|told|untold)\b",
        "report, state, show; distinguish (tell apart); recognise (tell by)",
    ),
    Banned("foretell, foretold", r"\bforet(ell|old)\w*", "predict, predicted"),
    Banned(
        "say so, says why, is said to",
        r"\b(says?|said|saying) (so|why|how|what|where|which|who|whether)\b"
        r"|\bsays? (nothing|little)\b|\b(is|are|was|be) said\b",
        "report, state, show, give the reason",
    ),
    Banned(
        "behind (of a score; of anything that comes later)",
        r"\bbehind\b",
        "delta chi2, delta score; after, following; underlying",
        fine=r"(left|fall|falls|fell) behind|behind the (wheel|plate)",
    ),
    Banned("misfit", r"\bmisfit\w*", "residual"),
    Banned(
        "hand, hands (of a person); hand over",
        r"\bhand(s|ed|ing)?\b",
        "operator; pass",
        fine=r"by hand|hands-free|(right|left|other|one)[- ]hand|hand-(held|kept)",
    ),
    Banned(
        "race, heat, finalist, runner",
        r"\b(rac(e|es|ed|ing)|finalists?|heats|runners?)\b",
        "selection round, candidate",
        fine=r"race condition|test runner|CI runner",
    ),
    Banned(
        "exhibit, hero, telling, wishes",
        r"\b(exhibits?|hero|wish(es)?)\b",
        "evidence, summary figure, representative record, per-record estimate",
    ),
    Banned("twin", r"\btwins?\b", "simulator, simulated instrument"),
    Banned(
        "gate (a rule; of samples)",
        r"\bgates?\b",
        "acceptance criterion; time gate",
        fine=r"quality gates?|time gates?",
    ),
    Banned(
        "face (of a joint)",
        r"\bfaces?\b(?!-)",
        "contact surface",
        fine=r"faces? of (an? )?(element|mesh)|(element|boundary) faces?"
        r"|face = |(structure of|surface) face\b|face: caution",
        elsewhere=_MESHES,
    ),
    Banned(
        "sheet (of a model)",
        r"\bsheets?\b",
        "nominal parameters with priors",
        fine=r"sheet\\?\.json|bench-sheet|"  # names of files that others write
        r"data ?sheets?|sheet metal|formula sheets?|style ?sheets?",
    ),
    Banned(
        "pull (of a parameter)",
        r"\bpull(s|ed|ing)?\b",
        "prior deviation [sd]",
        fine=r"pull request|pull(ed|s)? (back|off|out|apart)|cannot pull|unlike pull",
    ),
    Banned("visit", r"\bvisits?\b", "session, measurement campaign"),
    Banned("nobody", r"\bnobody\w*", "none, not given, no one"),
    Banned(
        "astray, hopeless, happiest, lone",
        r"\b(astray|hopeless|happiest|happier|lone)\b",
        "diverged, pruned, optimal, single",
    ),
    Banned(
        "march",
        r"\bmarch(es|ed|ing)?\b",
        "time integration, integrate in time",
        fine=r"\d March|March \d",
    ),
    Banned("great (of a size)", r"\bgreat\b", "large"),
    Banned(
        "stage (of a window, a step)",
        r"\bstages?\b",
        "resolution, step",
        fine=r"(Kalman|pipeline|joint|gap) stages?|stages? of the pipeline|stage keys?",
        only=_GAP,
    ),
    Banned(
        "page (of a report, in code)",
        r"\bpages?\b",
        "report",
        fine=r"page of the doc\w+|(docs|memory|man|web|code) pages?|/pages",
        only=_CODE,
        elsewhere=("station/browser/",),  # pages that a browser shows
    ),
    Banned(
        "rotten",
        r"\brotten\b",
        "corrupted",
    ),
    Banned(
        "stranger, strangers",
        r"\bstrangers?\b",
        "foreign file, other program, first-time reader",
    ),
    Banned("honest", r"\bhonest\w*", "realistic, correct, calibrated"),
    Banned(
        "how sure, sure",
        r"\bhow sure\b|\bas sure\b",
        "standard deviation, uncertainty, confidence",
    ),
    Banned(
        "laid beside, lays",
        r"\b(laid|lays)\b(?! out)|\blay (it|them|two|an|one|the)\b|\blaying\b(?! out)",
        "compare with, list next to",
    ),
    Banned(
        "of ours, of one's own",
        r"\bof ours\b|\bof one's own\b|\bof theirs\b",
        "of the station; custom, user-defined",
    ),
    Banned("anew", r"\banew\b", "again"),
    Banned(
        "goes on, gone on",
        r"\b(goes|go|went|gone|going) on(?! (the|a|an|top|screen|disk)\b)",
        "continue",
    ),
    Banned("reckon", r"\breckon\w*", "calculate, count"),
    Banned(
        "without a word, silent of",
        r"\bwithout (a word|words)\b|\bsilent of\b",
        "without a message",
    ),
    Banned(
        "leave in peace, for nobody, give in to",
        r"\bin peace\b|\bfor ever\b|\bcome to terms\b",
        "leave unchanged; without limit",
    ),
    Banned("loud (of a record)", r"\bloud(er|est)?\b", "large-amplitude, strong"),
    Banned("maker (of a device)", r"\bmakers?\b(?!')", "manufacturer, vendor"),
    Banned(
        "slowly bend, give way (of a model)",
        r"\b(gives? way|bends? away|led back|climbed a wall)\b",
        "change, adapt; return",
    ),
    Banned("by itself, all by themselves", r"\ball by (it|them)sel(f|ves)\b", "alone"),
    Banned(
        "blame, guilty, innocent, suspect",
        r"\b(blam(e|es|ed)|guilty|innocent|culprit)\b",
        "attribute to; cause",
    ),
)
_ANY = re.compile("|".join(f"(?:{ban.pattern})" for ban in BANNED), re.IGNORECASE)
"""Any banned expression: most lines hold none, and are read once."""

# Names of variables, functions, classes and files are made of these words.
BANNED_NAMES = {
    "told": "reported, distinguished",
    "untold": "undistinguished",
    "tells": "shows",
    "telling": "representative",
    "foretold": "predicted",
    "foretell": "predict",
    "foretells": "predicts",
    "misfit": "residual",
    "misfits": "residuals",
    "race": "selection",
    "races": "selection_rounds",
    "raced": "selected",
    "racing": "selecting",
    "heat": "round",
    "heats": "rounds",
    "finalist": "candidate",
    "finalists": "candidates",
    "exhibit": "evidence",
    "exhibits": "evidence",
    "hero": "summary_figure",
    "wishes": "per_record_estimates",
    "wish": "per_record_estimate",
    "twin": "simulator",
    "twins": "simulators",
    "sheet": "nominal",
    "sheets": "nominal",
    "pull": "prior_deviation",
    "pulls": "prior_deviations",
    "pulled": "deviating",
    "visit": "session, campaign",
    "visits": "sessions, campaigns",
    "nobody": "none",
    "astray": "diverged",
    "hopeless": "pruned",
    "lone": "single",
    "march": "integrate",
    "marches": "integrations",
    "marched": "integrated",
    "marching": "integrating",
    "great": "large",
    "rotten": "corrupted",
    "behind": "delta_score",
    "gate": "criterion, time_gate",
    "gates": "criteria, time_gates",
    "stranger": "foreign",
}
# Names of the contract: keys of files and results that stay as they are.
CONTRACT_NAMES: frozenset[str] = frozenset()
_WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+")


@dataclass(frozen=True, slots=True)
class Finding:
    """One banned expression in a text or a name."""

    path: str
    line: int
    found: str
    say: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.found!r}; say {self.say}"


def findings(paths: list[Path]) -> Iterator[Finding]:
    """Yield what the glossary bans in files and folders."""
    for path in _files(paths):
        relative = path.relative_to(ROOT).as_posix()
        if relative in EXEMPT:
            continue
        if path.suffix == ".py":
            source = path.read_text(encoding="utf-8")
            nodes = list(ast.walk(ast.parse(source)))
            yield from _in_texts(relative, _python_texts(source, nodes))
            yield from _in_names(relative, nodes)
        else:
            yield from _in_texts(relative, _page_texts(path))


def _files(paths: list[Path]) -> Iterator[Path]:
    """Yield the Python files and pages at paths."""
    for path in paths:
        if path.is_dir():
            for found in sorted(path.rglob("*")):
                if found.suffix in {".py", ".md"} and "fixtures" not in found.parts:
                    yield found
        elif path.exists():
            yield path


def _python_texts(source: str, nodes: list[ast.AST]) -> Iterator[tuple[int, str]]:
    """Yield comments, docstrings and every string of more than one word."""
    # Splitting a file into tokens takes most of the time, and few files hold a match.
    if any(_ANY.search(_without_code(text)) for text in _after_hashes(source)):
        for token in tokenize.generate_tokens(io.StringIO(source).readline):
            if token.type == tokenize.COMMENT:
                yield token.start[0], token.string
    for node in nodes:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            if " " in node.value.strip():
                for number, line in enumerate(node.value.split("\n")):
                    yield node.lineno + number, line


def _after_hashes(source: str) -> Iterator[str]:
    """Yield the rest of the line after every hash: comments, and parts of strings."""
    for line in source.split("\n"):
        for hash_sign in re.finditer("#", line):
            yield line[hash_sign.start() :]


def _without_code(text: str) -> str:
    """Return a text without the code that it quotes."""
    return re.sub(r"``?[^` ]+``?", "", text)


def _page_texts(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the lines of a page, without addresses of links."""
    for number, line in enumerate(path.read_text(encoding="utf-8").split("\n"), 1):
        yield number, re.sub(r"\]\([^)]*\)|`[^` ]*`", "]", line)


def _in_texts(path: str, texts: Iterator[tuple[int, str]]) -> Iterator[Finding]:
    """Yield the banned expressions of texts."""
    for number, text in texts:
        plain = _without_code(text)
        if not _ANY.search(plain):
            continue
        for ban in BANNED:
            if ban.only and not path.startswith(ban.only):
                continue
            if ban.elsewhere and path.startswith(ban.elsewhere):
                continue
            left = re.sub(ban.fine, "", plain, flags=re.I) if ban.fine else plain
            for match in re.finditer(ban.pattern, left, re.I):
                yield Finding(path, number, match.group(), ban.say)


def _in_names(path: str, nodes: list[ast.AST]) -> Iterator[Finding]:
    """Yield the banned words of the names that a module or its file defines."""
    names = {(1, Path(path).stem)}
    for node in nodes:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            names.add((node.lineno, node.name))
        elif isinstance(node, ast.arg):
            names.add((node.lineno, node.arg))
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add((node.lineno, node.id))
    for number, name in sorted(names):
        for word in _WORD.findall(name.replace("time_gate", "")):
            if word.lower() in BANNED_NAMES and name not in CONTRACT_NAMES:
                yield Finding(path, number, name, BANNED_NAMES[word.lower()])


def everywhere() -> list[Path]:
    """Return the folders and pages that the glossary holds for."""
    pages = [*ROOT.glob("*.md"), ROOT / "docs"]
    return [ROOT / folder for folder in FOLDERS] + pages


if __name__ == "__main__":
    wanted = [Path(name).resolve() for name in sys.argv[1:]] or everywhere()
    listed = list(findings(wanted))
    for finding in listed:
        sys.stdout.write(f"{finding}\n")
    sys.stdout.write(f"{len(listed)} banned expressions\n")
