# SPDX-License-Identifier: MIT
"""The result of a machine as JSON; units stand in the names of the keys."""

from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.machine.machine_result import (
    AXES,
    MachineResult,
    ToolMotion,
    VariantModes,
    VariantResult,
)

# Samples of a transient that the JSON holds; all of them are in the file of --motion.
_MOST_LOBES = 200


def machine_json(result: MachineResult) -> dict[str, Any]:
    """Return a machine as JSON.

    Args:
        result: of the machine.

    Returns:
        ``glued`` and ``jointed`` with modes, tool receptance, chatter and transient;
        ``pairs``, ``joints`` and the size of the model.
    """
    jointed = _variant(result.jointed)
    if result.frequency_interval is not None:
        for mode, low, high in zip(
            jointed["modes"], *result.frequency_interval.tolist(), strict=False
        ):
            mode["natural_frequency_95_hz"] = [low, high]
    if result.limit_interval is not None:
        jointed["chatter"]["limit_95_m"] = list(result.limit_interval)
    return {
        "glued": _variant(result.glued),
        "jointed": jointed,
        "pairs": [
            {"jointed": at + 1, "glued": int(partner) + 1, "mac": mac}
            for at, (partner, mac) in enumerate(result.pairs.tolist())
        ],
        "joints": {
            one.name: {
                "share_of_static_compliance": _by_axis(one.static),
                "static_compliance_if_rigid": _by_axis(one.static_gain),
                "largest_receptance_if_rigid": _by_axis(one.dynamic_gain),
            }
            for one in result.costs
        },
        "degrees_of_freedom": result.freedoms,
        "reduced_degrees_of_freedom": result.size[0],
        "largest_frequency_bound": result.bound,
        "speeds_rad_per_s": dict(result.speeds),
    }


def _variant(one: VariantResult) -> dict[str, Any]:
    tool = one.tool
    found: dict[str, Any] = {
        "modes": _modes(one.modes),
        "poles_without_oscillation": one.modes.overdamped,
        "oscillating_modes": [
            {"frequency_hz": frequency, "damping_ratio": ratio}
            for frequency, ratio in one.modes.oscillating.T.tolist()
        ],
        "tool": {
            "static_m_per_n": tool.static.tolist(),
            "largest_m_per_n": _by_axis(tool.largest),
            "largest_at_hz": _by_axis(tool.at),
            "frequency_hz": tool.frequency.tolist(),
            "size_m_per_n": {
                axis: np.abs(tool.response[at, at]).tolist()
                for at, axis in enumerate(AXES)
            },
        },
    }
    if tool.static_interval is not None:
        found["tool"]["static_95_m_per_n"] = {
            axis: tool.static_interval[:, at].tolist() for at, axis in enumerate(AXES)
        }
    if tool.interval is not None:
        found["tool"]["size_95_m_per_n"] = {
            axis: tool.interval[:, at].tolist() for at, axis in enumerate(AXES)
        }
    if tool.bound is not None:
        found["tool"] |= {
            "bound_frequency_hz": tool.bound.frequency.tolist(),
            "bound_m_per_n": {
                axis: _finite(tool.bound.error[at]) for at, axis in enumerate(AXES)
            },
            "largest_relative_bound": tool.bound.largest
            if np.isfinite(tool.bound.largest)
            else None,
        }
    if one.chatter is not None:
        thin = slice(None, None, max(1, one.chatter.speed.size // _MOST_LOBES))
        found["chatter"] = {
            "limit_m": one.chatter.limit,
            "frequency_hz": one.chatter.frequency,
            "speed_hz": one.chatter.speed[thin].tolist(),
            "width_m": one.chatter.width[thin].tolist(),
        }
    if one.motion is not None:
        found["transient"] = _motion(one.motion)
    return found


def _modes(modes: VariantModes) -> list[dict[str, Any]]:
    return [
        {
            "natural_frequency_hz": float(frequency),
            "damping_ratio": float(modes.damping_ratio[at]),
            "first_order_damping_ratio": float(modes.first_order[at]),
            "overdamped": bool(np.isnan(modes.damping_ratio[at])),
            "weakest_region": modes.energy.weakest(at)[0],
            "strain_energy": dict(
                zip(modes.energy.regions, modes.energy.share[at].tolist(), strict=True)
            ),
            "displacement_share": modes.motion.moving(at),
            "rotation_share": modes.motion.turning(at),
            "shape": modes.motion.text(at),
        }
        for at, frequency in enumerate(modes.natural_frequency)
    ]


def _motion(motion: ToolMotion) -> dict[str, Any]:
    return {
        "largest_m": _by_axis(motion.largest),
        "largest_at_s": _by_axis(motion.largest_at),
        "largest_in_last_fifth_m": _by_axis(motion.late),
    }


def _finite(values: FloatArray) -> list[float | None]:
    """Return the values; None for those without a bound."""
    return [one if np.isfinite(one) else None for one in values.tolist()]


def _by_axis(values: FloatArray) -> dict[str, float]:
    return dict(zip(AXES, values.tolist(), strict=True))
