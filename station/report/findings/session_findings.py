# SPDX-License-Identifier: MIT
"""What a session showed, in sentences: they stand before any number or figure."""

from collections.abc import Sequence

from jointbench.acquisition.records.recordings import Verdict
from jointbench.analysis.lumped.identified import Identification
from jointbench.signal.amplitude.amplitude_curve import AmplitudeMode, Dependence
from jointbench.station.report.findings.interval_words import between
from jointbench.station.report.findings.surface_findings import surface_sentence
from jointbench.station.report.joint_section import side_by_side
from jointbench.station.report.session_analysis import PreloadAnalysis, SessionAnalysis
from jointbench.station.screen.joint_text import interval_text

_MOST_LISTED = 4
_ORIGIN = "Modes from "
"""How a remark begins that names the results which the report shows."""


def session_findings(analysis: SessionAnalysis, link: str) -> tuple[str, ...]:
    """Return what was found: modes, joint, surfaces, hits; the reason for none.

    Args:
        analysis: of the session.
        link: whose stiffness is the joint's; empty without a model.
    """
    found = [*_modes(analysis.preloads), *_joint(analysis, link)]
    found += [surface_sentence(chain) for chain in analysis.surfaces]
    found += _hits(analysis)
    if not found:
        found = ["Neither modes nor surfaces were found; the remarks state why."]
    failed = [said for said in analysis.remarks if not said.startswith(_ORIGIN)]
    if failed:
        more = "" if len(failed) == 1 else f"; {len(failed) - 1} more under Remarks"
        found.append(f"Not complete: {failed[0].rstrip('.')}{more}.")
    return tuple(found)


def _modes(preloads: Sequence[PreloadAnalysis]) -> list[str]:
    if not preloads:
        return []
    first = preloads[0].modal
    frequency = first.result.model.natural_frequency
    if len(preloads) > 1:
        every = [one.preload for one in preloads if one.preload is not None]
        counts = [one.modal.result.model.natural_frequency.size for one in preloads]
        span = f" from {min(every):g} to {max(every):g} N" if every else ""
        many = " to ".join(str(n) for n in sorted({min(counts), max(counts)}))
        return [
            f"Modes were identified at {len(preloads)} preloads{span}: {many} at each."
        ]
    low, high = first.result.band
    if not frequency.size:
        return [f"No mode was found between {low:.0f} and {high:.0f} Hz."]
    listed = ", ".join(f"{value:.5g}" for value in frequency[:_MOST_LISTED])
    more = "" if frequency.size <= _MOST_LISTED else " and higher"
    noun = "mode" if frequency.size == 1 else "modes"
    span = f"{frequency.size} {noun} between {low:.0f} and {high:.0f} Hz"
    words = f"{span}: {listed} Hz{more}"
    return [f"{words}{_amplitude(first.amplitude or ())}."]


def _amplitude(modes: Sequence[AmplitudeMode]) -> str:
    """Return which modes depend on amplitude."""
    moved = [
        str(at)
        for at, mode in enumerate(modes, 1)
        if mode.dependence is Dependence.DEPENDS
    ]
    if moved:
        return f"; dependent on amplitude: mode {', '.join(moved)}"
    if modes and all(mode.dependence is Dependence.NONE for mode in modes):
        return "; none depends on amplitude"
    return ""


def _joint(analysis: SessionAnalysis, link: str) -> list[str]:
    if analysis.contact is not None:
        return [side_by_side(analysis.contact, analysis.joint, link)]
    if analysis.joint is None or not link:
        return []
    return [f"The modes give {parameter_words(analysis.joint, link)}."]


def parameter_words(joint: Identification, link: str) -> str:
    """Return the stiffness of a link with its interval, or its admissible range.

    Args:
        joint: the identification.
        link: by name.
    """
    value = joint.parameter(f"{link}.stiffness")
    if not value.identifiable:
        ends = interval_text(value.interval)
        return f"no single {value.name}; admissible, in N/m: {ends}"
    low, high = value.interval
    if low is None or high is None:
        return f"{value.name} = {value.value:.4g} N/m"
    words, interval = between(value.value, low, high, value.unit)
    return f"{value.name} = {words} ({interval})"


def _hits(analysis: SessionAnalysis) -> list[str]:
    verdicts = [hit.verdict for one in analysis.recordings for hit in one.hits]
    if not verdicts:
        return []
    good = sum(verdict is Verdict.OK for verdict in verdicts)
    text = f"{good} of {len(verdicts)} hits were accepted"
    why = rejected_words(verdicts)
    return [f"{text}; rejected: {why}." if why else f"{text}."]


def rejected_words(verdicts: Sequence[Verdict]) -> str:
    """Return how many hits were rejected for each reason.

    >>> rejected_words([Verdict.OK, Verdict.OVERLOAD, Verdict.OVERLOAD])
    '2 overload'
    """
    bad = [verdict.value for verdict in verdicts if verdict is not Verdict.OK]
    return ", ".join(f"{bad.count(word)} {word}" for word in dict.fromkeys(bad))
