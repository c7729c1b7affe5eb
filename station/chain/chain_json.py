# SPDX-License-Identifier: MIT
"""A chain as JSON: verdict, places, causes, and every number."""

from collections.abc import Mapping
from typing import Any

from jointbench.analysis.gap.chain.chain_records import ChainLink
from jointbench.analysis.gap.chain.several_causes import Cause
from jointbench.analysis.gap.model.diagnosis_record import diagnosis_json
from jointbench.station.chain.examine_chain import ExaminedChain


def chain_json(done: ExaminedChain) -> Mapping[str, Any]:
    """Return the verdict and all numbers as plain data."""
    found, s = done.found, done.stiffness
    several = found.several
    return {
        "verdict": found.finding.value,
        "links": [link.value for link in found.links],
        "places": [[x.value for x in one.links] for one in found.location.places],
        "effects": list(found.names),
        "reason": found.reason,
        "experiment": found.experiment,
        "hypotheses": [
            {
                "links": [link.value for link in one.links],
                "restored": one.restored,
                "score": one.score,
                "tests": {
                    link.value: {
                        "chi2": test.cost,
                        "dof": test.dof,
                        "passed": test.passed,
                        "reason": test.reason,
                    }
                    for link, test in zip(ChainLink, one.tests, strict=True)
                },
            }
            for one in found.location.hypotheses
        ],
        "causes": None
        if several is None
        else {
            "factors": [_factor(one) for one in several.causes],
            "known": [_factor(one) for one in several.known],
            "product": several.product.factor,
            "product_interval_95": [several.product.low, several.product.high],
            "measured_over_law": several.measured,
            "rivals": [list(one) for one in several.rivals],
            "preload": float(s.preload[several.reference]),
        },
        "stiffness": {
            "preload": s.preload.tolist(),
            "measured": s.measured.tolist(),
            "law": s.before.tolist(),
            "predicted": s.after.tolist(),
            "predicted_log_sd": s.after_sd.tolist(),
        },
        "modes": [
            {
                "preload": one.preload,
                "measured_hz": one.measured.tolist(),
                "law_hz": one.before.tolist(),
                "predicted_hz": one.after.tolist(),
            }
            for one in done.modes
        ],
        "joint": diagnosis_json(found.contact.found),
        "remarks": list(done.remarks),
    }


def _factor(one: Cause) -> dict[str, Any]:
    return {
        "name": one.name,
        "factor": one.factor,
        "interval_95": [one.low, one.high],
    }
