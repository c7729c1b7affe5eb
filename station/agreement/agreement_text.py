# SPDX-License-Identifier: MIT
"""The comparison of a measured structure with its model on the terminal."""

from collections.abc import Mapping

from jointbench.analysis.structures.agreement.compare_structure import Agreement
from jointbench.analysis.structures.agreement.paired_modes import (
    ModeDifference,
    unpaired,
)
from jointbench.analysis.structures.agreement.suspect_coordinates import Suspect
from jointbench.station.screen.terminal import console, table

_LEAST = 0.001  # [%], the last digit of a difference
PAIR_COLUMNS = (
    "measured [Hz]",
    "computed [Hz]",
    "difference, 95 % [%]",
    "MAC",
    "measured damping [%]",
    "damping difference, 95 % [%]",
)


def show_agreement(results: Mapping[str, Agreement], json_target: str | None) -> None:
    """Print pairs, coordinates and suspects, state by state."""
    screen = console(json_target)
    for label, one in results.items():
        rows = pair_rows(one)
        title = f"{label}: measured and computed modes"
        screen.print(table(title, PAIR_COLUMNS, rows, words=frozenset()))
        columns, cells = coordinate_rows(one)
        screen.print(table("Coordinates", columns, cells))
        for sentence in sentences(one):
            screen.print(sentence, markup=False)


def pair_rows(found: Agreement) -> list[tuple[str, ...]]:
    """Return a row for each pair."""
    return [_pair_row(found, one) for one in found.pairs]


def _pair_row(found: Agreement, one: ModeDifference) -> tuple[str, ...]:
    return (
        f"{found.measured.frequency[one.measured]:.6g}",
        f"{found.computed.frequency[one.computed]:.6g}",
        _with_interval(one.frequency, one.frequency_interval),
        f"{one.mac:.3f}",
        f"{100 * found.measured.damping[one.measured]:.3g}",
        _with_interval(one.damping, one.damping_interval),
    )


def coordinate_rows(found: Agreement) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return CoMAC and FRAC of each output."""
    columns = ("output", "CoMAC", "ECOMAC", *(f"FRAC, hit {n}" for n in found.inputs))
    rows = [
        (
            name,
            f"{found.comac[at]:.3f}",
            f"{found.enhanced_comac[at]:.3f}",
            *(f"{value:.3f}" for value in found.frac[at]),
        )
        for at, name in enumerate(found.outputs)
    ]
    return columns, rows


def sentences(found: Agreement) -> list[str]:
    """Return what is missing and what is suspected, a sentence each."""
    lines = []
    missing = unpaired(found.pairs, found.measured.frequency.size, "measured")
    if missing.size:
        listed = ", ".join(f"{found.measured.frequency[k]:.5g}" for k in missing)
        lines.append(f"Measured modes without a computed partner: {listed} Hz.")
    lines += [suspect_sentence(one) for one in found.suspects]
    if not found.suspects:
        lines.append(
            "No sign, label or axis explains the measurement better than those given."
        )
    return lines


def suspect_sentence(one: Suspect) -> str:
    """Return what is suspected, what it explains, and what explains it equally."""
    text = (
        f"Suspected: {one.text}; the difference of the modal constants falls from "
        f"{100 * one.residual_before:.0f} to {100 * one.residual_after:.0f} % of their "
        "size"
    )
    if one.equal:
        text += f". As good: {'; '.join(one.equal)}"
    return text + "."


def _with_interval(value: float, ends: tuple[float, float]) -> str:
    half = 50 * (ends[1] - ends[0])
    words = f"± {half:.2g}" if half >= _LEAST else f"± <{_LEAST:g}"
    return f"{100 * value:+.3f} {words}"
