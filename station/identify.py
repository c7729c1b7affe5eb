# SPDX-License-Identifier: MIT
"""``jointbench identify``: the links of a lumped bench from its measured modes."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.arrays import ComplexArray
from jointbench.acquisition.errors import BadData, UsageError
from jointbench.analysis.identification import (
    Identification,
    IdentificationVerdict,
    identification_json,
)
from jointbench.analysis.identify import identify_links
from jointbench.analysis.lumped import Body, Link, LumpedModel
from jointbench.analysis.measured_modes import MeasuredModes
from jointbench.signal.modal_model import ModalModel
from jointbench.signal.modes import ModalSettings
from jointbench.station.bench_model import BenchModel
from jointbench.station.chain import ChainSettings, run_chain
from jointbench.station.inputs import read_recordings
from jointbench.station.joint_text import WHAT_IS_SHOWN, parameter_text
from jointbench.station.modal import parse_band
from jointbench.station.output import console, table, working, write_json
from jointbench.station.outputs import check_outputs
from jointbench.station.toml_file import read_toml
from jointbench.station.toml_text import load_toml

SENSITIVITY_SD = 0.02
"""Relative sd of a shape component [-]: accelerometers of one batch differ by 2 %."""


def run_identify(
    model: Path,
    sessions: Sequence[Path],
    *,
    band: str | None = None,
    json_target: str | None,
) -> Identification:
    """Identify the links of `model` from the modes of `sessions` and show them."""
    check_outputs([model, *sessions], [json_target])
    settings = ChainSettings(modal=ModalSettings(band=parse_band(band)))
    bench = read_toml(model, BenchModel)
    recordings = read_recordings(sessions, columns=None, point="1")
    with working("fitting modes, identifying links"):
        modes = run_chain(recordings, settings).result.model
        result = identify_joint(bench, modes)
    show_joint(result, json_target)
    write_json(json_target, identification_json(result))
    return result


def identify_any(
    model: Path,
    sessions: Sequence[Path],
    *,
    band: str | None,
    cache: Path | None,
    report: Path | None,
    json_target: str | None,
    surfaces: Sequence[Path] = (),
) -> bool:
    """Identify the joints of whatever the model file describes.

    Returns:
        Whether the model can have what was measured.

    Raises:
        UsageError: a lumped bench without a session, or with a page of its own.
    """
    if describes_structure(model):
        from jointbench.station.identify_structure import run_identify_structure

        return run_identify_structure(
            model,
            sessions,
            band=band,
            cache=cache,
            report=report,
            json_target=json_target,
            surfaces=surfaces,
        )
    if not sessions:
        raise UsageError(
            f"'{model}' is a lumped bench; give the sessions it was hit in"
        )
    if report is not None or surfaces:
        raise UsageError(
            "--report and --surface are for structures [joints]; of a lumped bench "
            "write 'jointbench report SESSION --model MODEL --out PAGE'"
        )
    return fits(run_identify(model, sessions, band=band, json_target=json_target))


def describes_structure(model: Path) -> bool:
    """Tell whether a model file has meshed bodies; what cannot be read has none."""
    try:
        content = load_toml(model)
    except (BadData, OSError, ValueError, RecursionError):
        return False  # the reader of lumped benches says what is wrong
    return "joints" in content


def fits(result: Identification) -> bool:
    """Tell whether the model can have the measured modes at all."""
    return result.verdict is not IdentificationVerdict.INCONSISTENT


def identify_joint(bench: BenchModel, modes: ModalModel) -> Identification:
    """Identify every link of a bench whose channels sit on its bodies.

    Raises:
        BadData: a body's channel is not among the outputs, or there are more modes
            than bodies.
    """
    return identify_links(lumped_model(bench), measured_modes(bench, modes))


def lumped_model(bench: BenchModel) -> LumpedModel:
    """Return the bodies and links of a model file as the analysis takes them."""
    bodies = tuple(
        Body(name, body.mass, body.mass_sd or 0.0)
        for name, body in bench.bodies.items()
    )
    links = tuple(
        Link(
            name,
            link.between,
            stiffness=link.stiffness or 0.0,
            damping=link.damping or 0.0,
            stiffness_sd=link.stiffness_sd,
        )
        for name, link in bench.links.items()
    )
    return LumpedModel(bodies, links)


def measured_modes(bench: BenchModel, modes: ModalModel) -> MeasuredModes:
    """Return measured modes, with the shape at each body that has a channel.

    Raises:
        BadData: there are more modes than bodies: above, bodies bend.
    """
    count, most = modes.natural_frequency.size, len(bench.bodies)
    if count > most:
        found = ", ".join(f"{f:.1f}" for f in modes.natural_frequency)
        raise BadData(
            f"{count} modes ({found} Hz) for {most} rigid bodies; add bodies to the "
            "model, or give a --band that holds the rigid-body modes only"
        )
    seen = {
        name: b.channel for name, b in bench.bodies.items() if b.channel is not None
    }
    shapes = modes.shapes[:, [_output(modes, c) for c in seen.values()]]
    return MeasuredModes(
        natural_frequency=modes.natural_frequency,
        frequency_sd=modes.frequency_sd,
        damping_ratio=modes.damping_ratio,
        damping_ratio_sd=modes.damping_ratio_sd,
        shapes=shapes if len(seen) > 1 else None,
        shape_sd=_shape_sd(shapes) if len(seen) > 1 else None,
        outputs=tuple(seen),
    )


def _shape_sd(
    shapes: ComplexArray,
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    largest = np.abs(shapes).max(axis=1, keepdims=True)
    return np.asarray(SENSITIVITY_SD * np.broadcast_to(largest, shapes.shape))


def _output(modes: ModalModel, channel: str) -> int:
    names = [label.partition("@")[0] for label in modes.outputs]
    if channel not in names:
        raise BadData(
            f"the model's channel {channel!r} is not in the session; its channels are "
            f"{', '.join(names)}"
        )
    return names.index(channel)


def show_joint(result: Identification, json_target: str | None) -> None:
    """Print the identified parameters and how far they are determined."""
    screen = console(json_target)
    rows = [
        (
            one.name,
            parameter_text(one),
            one.unit,
            "yes" if one.identifiable else "no",
        )
        for one in result.parameters
    ]
    title = f"Links from the modes: {result.verdict.value} {WHAT_IS_SHOWN}"
    screen.print(table(title, ("parameter", "value", "unit", "identifiable"), rows))
    reasons = [*result.reasons, *(p.reason for p in result.parameters if p.reason)]
    for reason in dict.fromkeys(reasons):
        screen.print(f"  {reason}", markup=False)
