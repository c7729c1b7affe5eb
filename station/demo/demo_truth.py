# SPDX-License-Identifier: MIT
"""What the demo's bench is made of, beside what the station found of it."""

from jointbench.acquisition.records.recordings import Hit
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.simulators.two_body.bench import BenchHit
from jointbench.station.demo.demo_bench import DemoTruth
from jointbench.station.report.session_analysis import SessionAnalysis
from jointbench.station.screen.truth_table import (
    TruthComparison,
    compare_value,
    nearest,
)

FREQUENCY_LIMIT = 0.001
DAMPING_LIMIT = 0.10
DIMENSION_LIMIT = 0.03
LINK_LIMITS = {"stiffness": 0.01, "damping": 0.10}
SAME_HIT = 0.02
"""A found hit belongs to a true one if they lie this close [s]."""


def compare_with_truth(
    truth: DemoTruth, analysis: SessionAnalysis
) -> tuple[TruthComparison, ...]:
    """Lay every known quantity beside its estimate."""
    return (
        *_hits(truth, analysis),
        *_modes(truth, analysis),
        *_surfaces(truth, analysis),
        *_links(truth, analysis),
    )


def _hits(truth: DemoTruth, analysis: SessionAnalysis) -> list[TruthComparison]:
    recordings = analysis.modal.recordings if analysis.modal else ()
    found = [
        (hit.trigger / recording.sample_rate, hit)
        for recording in recordings
        for hit in recording.hits
    ]
    right = sum(_judged_right(true, found) for true in truth.bench.hits)
    count = len(truth.bench.hits)
    return [
        compare_value("hits_judged_right", "-", count, right, limit=0.0, absolute=True),
        compare_value("hits_found", "-", count, len(found), limit=0.0, absolute=True),
    ]


def _judged_right(true: BenchHit, found: list[tuple[float, Hit]]) -> bool:
    return any(
        abs(time - true.time) < SAME_HIT and hit.verdict is true.verdict
        for time, hit in found
    )


def _modes(truth: DemoTruth, analysis: SessionAnalysis) -> list[TruthComparison]:
    model = analysis.modal.result.model if analysis.modal else None
    found = [] if model is None else model.natural_frequency.tolist()
    true = truth.bench.natural_frequency
    rows = [
        compare_value(
            "modes_found", "-", len(true), len(found), limit=0.0, absolute=True
        )
    ]
    for number, frequency in enumerate(true):
        mode = _nearest_mode(model, frequency)
        for quantity, unit, value, limit in (
            ("natural_frequency", "Hz", frequency, FREQUENCY_LIMIT),
            ("damping_ratio", "-", truth.bench.damping_ratio[number], DAMPING_LIMIT),
        ):
            estimate, sd = mode.get(quantity, (None, None))
            rows.append(
                compare_value(
                    f"{quantity}[{number}]", unit, value, estimate, sd=sd, limit=limit
                )
            )
    return rows


def _nearest_mode(
    model: ModalModel | None, frequency: float
) -> dict[str, tuple[float, float]]:
    """Return value and sd by quantity of the mode nearest to `frequency` [Hz]."""
    at = None if model is None else nearest(model.natural_frequency.tolist(), frequency)
    if model is None or at is None:
        return {}
    return {
        "natural_frequency": (
            float(model.natural_frequency[at]),
            float(model.frequency_sd[at]),
        ),
        "damping_ratio": (
            float(model.damping_ratio[at]),
            float(model.damping_ratio_sd[at]),
        ),
    }


def _surfaces(truth: DemoTruth, analysis: SessionAnalysis) -> list[TruthComparison]:
    rows = []
    for chain in analysis.surfaces:
        fit, name = chain.fit, chain.surface.name
        rows += [
            compare_value(
                f"dimension[{name}]",
                "-",
                truth.dimension,
                fit.dimension,
                sd=fit.dimension_sd,
                limit=DIMENSION_LIMIT,
                absolute=True,
            ),
            compare_value(
                f"roughness[{name}]",
                "m",
                truth.roughness,
                fit.roughness,
                sd=_half_width(fit.roughness_interval),
            ),
        ]
    return rows


def _half_width(interval: tuple[float, float] | None) -> float | None:
    """Return the standard deviation that a 95 % interval amounts to."""
    return None if interval is None else (interval[1] - interval[0]) / (2 * 1.96)


def _links(truth: DemoTruth, analysis: SessionAnalysis) -> list[TruthComparison]:
    true = {
        "support": {"stiffness": truth.bench.k0, "damping": truth.bench.c0},
        "joint": {"stiffness": truth.bench.kj, "damping": truth.bench.cj},
    }
    rows = []
    for link, numbers in true.items():
        for what, value in numbers.items():
            name = f"{link}.{what}"
            joint = analysis.joint
            estimate = None if joint is None else joint.parameter(name)
            rows.append(
                compare_value(
                    name,
                    "N/m" if what == "stiffness" else "N s/m",
                    value,
                    None if estimate is None else estimate.value,
                    sd=None if estimate is None else estimate.sd,
                    limit=LINK_LIMITS[what],
                )
            )
    return rows
