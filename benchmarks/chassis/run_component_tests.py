r"""Run NI's component tests for analogue input against the simulated chassis.

    python benchmarks/chassis/run_component_tests.py ../nidaqmx-python \
        --examples examples.json > docs/chassis-conformance.md

With the verdicts of run_examples.py the page has both. The tests need a copy of
https://github.com/ni/nidaqmx-python; they run unchanged, in a process of their own.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

HERE = Path(__file__).parent
FILES = (
    "test_interpreter.py",
    "test_task.py",
    "test_task_events.py",
    "test_task_properties.py",
    "test_task_resource_warnings.py",
    "stream_readers/test_analog_multi_channel_reader.py",
    "stream_readers/test_analog_single_channel_reader.py",
    "stream_readers/test_analog_unscaled_reader.py",
    "system/test_device.py",
    "system/test_device_properties.py",
    "system/test_physical_channel.py",
    "system/test_physical_channel_properties.py",
    "system/test_system.py",
    "system/_collections/test_device_collection.py",
    "system/_collections/test_physical_channel_collection.py",
    "task/test_in_stream.py",
    "task/test_in_stream_buffer_properties.py",
    "task/test_in_stream_read_properties.py",
    "task/test_task_read_ai.py",
    "task/test_task_read_waveform_ai.py",
    "task/test_timing.py",
    "task/test_timing_properties.py",
    "task/test_triggers.py",
    "task/test_triggers_properties.py",
    "task/channels/test_ai_channel.py",
    "task/channels/test_channel_properties.py",
)

# Why a test fails, by words in its message.
REASONS = {
    "IndexError": "analogue output, digital lines or counters: not simulated",
    "UNIMPLEMENTED": (
        "a call that is not served: calibration, virtual TEDS and TEDS writing, "
        "bridges, temperature, states of outputs"
    ),
    "-200431": "a measurement that no simulated device offers: temperature, current",
    "-200378": "custom scales that NI's configuration file saves: none are simulated",
    "-200220": "a device of NI's configuration file that is not simulated",
    "Could not find an installation of NI-DAQmx": "the test uses the local driver",
}


@dataclass(frozen=True, slots=True)
class Result:
    """Verdict on one test.

    Attributes:
        file: of the test.
        name: of the test.
        verdict: ``passed``, ``failed`` or ``skipped``.
        reason: first line of the message; empty if it passed.
    """

    file: str
    name: str
    verdict: str
    reason: str


def run(copy: Path) -> list[Result]:
    """Run the tests and return their verdicts."""
    with tempfile.TemporaryDirectory() as scratch:
        log = Path(scratch) / "log.xml"
        command = [sys.executable, "-m", "pytest", "-q", "-p", "component_plugin"]
        command += [
            "-p",
            "no:cacheprovider",
            "-p",
            "no:randomly",
            "--import-mode=prepend",
        ]
        command += [
            "--continue-on-collection-errors",
            "-W",
            "ignore",
            f"--junitxml={log}",
            "--rootdir",
            str(copy),
        ]
        command += [f"--basetemp={scratch}/base", "--tb=short"]
        command += [str(copy / "tests" / "component" / name) for name in FILES]
        path = f"{HERE}:{copy}"
        environment = {"PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1"}
        ended = subprocess.run(
            command, cwd=scratch, env=environment, check=False, capture_output=True
        )
        sys.stderr.write(ended.stdout.decode()[-2000:])
        return list(_results(log))


def _results(log: Path) -> Iterator[Result]:
    for case in ElementTree.parse(log).iter("testcase"):
        file = case.get("classname", "").replace("tests.component.", "")
        verdict, reason = "passed", ""
        for child in case:
            if child.tag in {"failure", "error", "skipped"}:
                verdict = "skipped" if child.tag == "skipped" else "failed"
                message = child.get("message") or ""
                reason = _reason(message, child.text or "")
        yield Result(file, case.get("name", ""), verdict, reason)


def _reason(message: str, text: str) -> str:
    """Return what a message says in one line, with the error number if it has one."""
    lines = [line.strip() for line in message.splitlines() if line.strip()]
    code = next((line for line in lines if line.startswith("Status Code:")), "")
    detail = next((line for line in lines if line.startswith("Property:")), "")
    first = lines[0] if lines else text.strip().splitlines()[-1]
    known = next((why for words, why in REASONS.items() if words in message), "")
    parts = [known] if known else [first.split(". Cannot proceed")[0], detail, code]
    return "; ".join(part for part in parts if part).replace("|", "/")[:200]


def page(results: list[Result], examples: list[list[str]]) -> str:
    """Return the page."""
    lines = [*_head(), *_examples(examples), *_tests(results), *_reasons(results)]
    return "\n".join(lines) + "\n"


def _head() -> list[str]:
    return [
        "# Programs of others on the simulated chassis",
        "NI's own files of [nidaqmx-python](https://github.com/ni/nidaqmx-python), "
        "unchanged, run against the [simulated chassis](chassis.md). Its devices take "
        "the names that the files use; signals are a noisy sine, as in NI's simulated "
        "devices.",
        "Written by `benchmarks/chassis/run_examples.py` and `run_component_tests.py`.",
        "",
    ]


def _examples(examples: list[list[str]]) -> list[str]:
    runs = sum(verdict == "runs" for _, verdict, _ in examples)
    lines = [
        f"## Examples: {runs} of {len(examples)} run",
        "| file | verdict | last line, or the reason |",
        "|---|---|---|",
    ]
    lines += [f"| {n} | {v} | {w.replace('|', '/')} |" for n, v, w in examples]
    return [*lines, ""]


def _tests(results: list[Result]) -> list[str]:
    counts: dict[str, Counter[str]] = defaultdict(Counter)
    for result in results:
        counts[result.file][result.verdict] += 1
    total = Counter(result.verdict for result in results)
    lines = [
        f"## Component tests: {total['passed']} passed, {total['failed']} failed, "
        f"{total['skipped']} skipped",
        "Skipped by NI's own conditions: a device is absent, or the test is for the "
        "local driver.",
        "",
        "| file | passed | failed | skipped |",
        "|---|---|---|---|",
    ]
    for file, of in counts.items():
        lines.append(f"| {file} | {of['passed']} | {of['failed']} | {of['skipped']} |")
    return [*lines, ""]


def _reasons(results: list[Result]) -> list[str]:
    lines = ["## Every failure", "| reason | tests |", "|---|---|"]
    lines += _grouped(results, "failed")
    lines += ["", "## Why tests are skipped", "| reason | tests |", "|---|---|"]
    counts = Counter(r.reason for r in results if r.verdict == "skipped")
    lines += [f"| {reason} | {count} |" for reason, count in counts.most_common()]
    return lines


def _grouped(results: list[Result], verdict: str) -> Iterator[str]:
    groups: dict[str, list[str]] = defaultdict(list)
    for result in results:
        if result.verdict == verdict:
            name = result.name.replace("[grpc_init_kwargs]", "").removeprefix("test___")
            groups[result.reason].append(f"`{result.file}` {name}")
    for reason, names in sorted(groups.items(), key=lambda item: -len(item[1])):
        yield f"| {reason} | {len(names)}: {'; '.join(names)} |"


def main() -> None:
    """Run the tests and print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("copy", type=Path, help="copy of nidaqmx-python")
    parser.add_argument("--examples", type=Path, help="verdicts of run_examples.py")
    arguments = parser.parse_args()
    given = arguments.examples
    examples = json.loads(given.read_text()) if given else []
    print(page(run(arguments.copy.resolve()), examples), end="")


if __name__ == "__main__":
    main()
