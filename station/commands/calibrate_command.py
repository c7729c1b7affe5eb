# SPDX-License-Identifier: MIT
"""``jointbench calibrate``: accelerometers against the hammer, on a known mass."""

from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.basics.units import parse_value
from jointbench.acquisition.session_file.store import read_session
from jointbench.signal.hits.ratio_calibration import (
    FLATNESS_LIMIT,
    RatioCalibration,
    calibrate_ratio,
)
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.screen.terminal import console, table, write_json


def run_calibrate(
    session: Path, *, mass: str, mass_sd: str, json_target: str | None
) -> tuple[RatioCalibration, ...]:
    """Show the ratio of indicated to true sensitivity of the sensors of a session.

    Args:
        session: of hits on a freely hung mass.
        mass: moving mass, sensors included, with its unit.
        mass_sd: its standard uncertainty, with its unit.
        json_target: where the JSON goes.

    Raises:
        UsageError: the mass is not above zero, or its uncertainty is negative.
        NoHitFound: there are fewer than three accepted hits.
    """
    check_outputs([session], [json_target])
    kilograms, sd = parse_value(mass, "mass"), parse_value(mass_sd, "mass")
    if not kilograms > 0 or sd < 0:
        raise UsageError(
            f"mass is {mass!r} with uncertainty {mass_sd!r}; give a mass above zero "
            "and an uncertainty of zero or more"
        )
    recordings = read_session(session).recordings
    found = calibrate_ratio(recordings, mass=kilograms, mass_sd=sd)
    _show(found, session, json_target)
    write_json(json_target, {"calibrations": [_plain(each) for each in found]})
    return found


def _show(
    found: Sequence[RatioCalibration], session: Path, json_target: str | None
) -> None:
    rows = [
        (
            each.channel.name,
            f"{each.ratio:.5f} ± {each.expanded:.5f}",
            f"{100 * each.repeatability:.3f} %",
            f"{100 * each.mass_part:.3f} %",
            f"{100 * each.flatness:+.2f} %",
            "passed" if each.passed else "FAILED",
        )
        for each in found
    ]
    heads = (
        "channel",
        "indicated / true (95 %)",
        "repeatability",
        "mass uncertainty",
        "drift over the band",
    )
    screen = console(json_target)
    screen.print(table(f"{session}", (*heads, "verdict"), rows))
    low, high = found[0].band
    screen.print(
        f"{found[0].hits} hits, {low:.0f} to {high:.0f} Hz. To correct FRFs, divide "
        "them by the ratio. To correct the accelerometer, multiply its sensitivity by "
        "the ratio. To correct the hammer instead, divide its sensitivity by the "
        "ratio.",
    )
    if not all(each.passed for each in found):
        screen.print(
            f"The ratio changes by more than {100 * FLATNESS_LIMIT:g} % over the band: "
            "the mass bends, a sensor mount is loose, or hits missed the centre.",
        )


def _plain(each: RatioCalibration) -> dict[str, object]:
    sensitivity = each.channel.sensitivity
    return {
        "channel": each.channel.name,
        "ratio": each.ratio,
        "ratio_sd": each.standard_uncertainty,
        "ratio_expanded_95": each.expanded,
        "repeatability": each.repeatability,
        "mass_part": each.mass_part,
        "flatness": each.flatness,
        "band_hz": list(each.band),
        "hits": each.hits,
        "sensitivity_if_hammer_is_right_v_per_si": None
        if sensitivity is None
        else each.ratio * sensitivity,
        "passed": each.passed,
    }
