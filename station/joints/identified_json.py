# SPDX-License-Identifier: MIT
"""The identified joints of a meshed structure as plain data."""

from typing import Any

from jointbench.analysis.structures.identification.joint_result import structure_json
from jointbench.station.joints.contact_comparison import theory_json
from jointbench.station.joints.hypothesis_output import hypotheses_json
from jointbench.station.joints.identify_run import IdentifiedStructure


def identified_json(done: IdentifiedStructure) -> dict[str, Any]:
    """Return parameters, solutions and checks, as ``identify --json`` writes them."""
    content = structure_json(done.result, done.reduced.names)
    if done.hypotheses:
        content["hypotheses"] = hypotheses_json(done.hypotheses)
    if done.theory:
        content["theory"] = theory_json(done.theory)
    return content
