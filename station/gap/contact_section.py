# SPDX-License-Identifier: MIT
"""Report section of a joint over its preload: measured, law, law with the effect."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.gap.contact_bench.contact_bench import ContactBench
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.held_out_torques import HeldOutTorques
from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    UNITS,
    ContactQuantity,
)
from jointbench.analysis.gap.law_diagnosis.contact_diagnosis import ContactDiagnosis
from jointbench.analysis.gap.model.effect import words_of
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.station.drawing.palette import LAW, MEASURED, MODEL, REFUSED
from jointbench.station.report.gap_sentences import effect_words
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page_parts import DataTable, Item, Plot, Section, Text
from jointbench.station.screen.traces import Trace, line, markers
from jointbench.station.screen.value_text import engineering

_TITLES = {
    "kn": "normal stiffness",
    "kt": "tangential stiffness",
    "kt2": "tangential stiffness, second direction",
    "kr": "rocking stiffness",
    "cn": "normal damping",
    "ct": "tangential damping",
}
_CAPTION = (
    "Points: measured, with 95 % intervals; triangles pointing down: falling preload. "
    "Lines: mean of the assemblies along rising preload, by the contact law alone and "
    "with the effect."
)
_FIRST_DAMPING = QUANTITIES.index(ContactQuantity.NORMAL_DAMPING)
_MOST_LEVELS = 12
_SAME_FORCE = 0.3
"""Step of the logarithm of a tangential force that begins another line."""


def contact_sections(done: ContactDiagnosis) -> tuple[Section, ...]:
    """Return the picture of the joint, and the torques that were held out."""
    rows = done.bench.data.rows
    plots: list[Item] = [
        Plot(
            f"joint_{QUANTITIES[q].value}",
            f"{_TITLES[QUANTITIES[q].value].capitalize()} over preload. {_CAPTION}",
            joint_figure(done, int(q)),
            420,
        )
        for q in np.unique(rows.quantity)
    ]
    return (
        Section("joint", "Stiffness and damping over preload", tuple(plots)),
        Section("held-out", "Torques that were held out", _held_out(done)),
    )


def joint_figure(done: ContactDiagnosis, quantity: int) -> Figure:
    """Return one measured quantity over preload with its explanations.

    Args:
        done: the diagnosis.
        quantity: index into `QUANTITIES`.
    """
    bench, key = done.bench, QUANTITIES[quantity].value
    traces = _points(bench, quantity)
    # The law before any fit shows how far the surfaces alone are from the joint.
    nominal = np.zeros(done.base.n_base)
    traces.append(_curve(bench, nominal, None, quantity, "law, nominal inputs", LAW))
    traces.append(_curve(bench, done.base.base, None, quantity, "law, fitted", REFUSED))
    if done.best is not done.base:
        label = f"with {effect_words(words_of(done.best.candidates))}"
        traces.append(_curve(bench, done.best.base, done.best, quantity, label, MODEL))
    title, unit = _TITLES[key], UNITS[quantity]
    if quantity >= _FIRST_DAMPING and _known_frequency(bench):
        title, unit = f"{title} times angular frequency", "N/m"
    return figure(
        traces,
        axis("preload, nominal or measured [N]", log=True),
        axis(f"{title} [{unit}]", log=True),
    )


def _known_frequency(bench: ContactBench) -> bool:
    return bool(np.isfinite(bench.data.states.frequency).all())


def _scale(bench: ContactBench, quantity: int) -> FloatArray:
    """Return what damping is multiplied by, so that states of all frequencies compare.

    Shape (n_states,); 1 for stiffness, and where a frequency is not known.
    """
    omega = bench.nominal.omega
    if quantity >= _FIRST_DAMPING and _known_frequency(bench):
        return omega
    return np.ones(omega.size)


def _points(bench: ContactBench, quantity: int) -> list[Trace]:
    """Return measured values at the nominal preload, by branch and kind."""
    rows, states = bench.data.rows, bench.data.states
    preload = bench.nominal.preload[rows.state]
    scale = _scale(bench, quantity)[rows.state]
    sd = np.sqrt(np.diag(rows.covariance))
    own = rows.quantity == quantity
    falling = states.falling[rows.state]
    kinds = (
        ("measured, rising", own & ~falling & ~rows.bound, "circle"),
        ("measured, falling", own & falling & ~rows.bound, "triangle-down"),
        ("known from below", own & rows.bound, "arrow-bar-up"),
    )
    found = []
    for name, chosen, symbol in kinds:
        if chosen.any():
            value = np.exp(rows.value[chosen]) * scale[chosen]
            error = CONTACT.interval_z * sd[chosen] * value
            shown = None if symbol == "arrow-bar-up" else error
            found.append(
                markers(
                    *(preload[chosen], value, name),
                    color=MEASURED,
                    symbol=symbol,
                    error=shown,
                )
            )
    return found


def _curve(
    bench: ContactBench,
    base: FloatArray,
    fit: Fit | None,
    quantity: int,
    label: str,
    color: str,
) -> Trace:
    """Return a predicted quantity over preload, without scatter of the states."""
    mean = base.copy()
    mean[bench.layout.assembly :] = 0.0
    joint = bench.joint(mean, () if fit is None else fit.terms)
    value = joint.table[quantity] * _scale(bench, quantity)
    gap = np.full(1, np.nan)
    pieces = [
        np.concatenate([values[part], gap])
        for values in (bench.nominal.preload, value)
        for part in _rising_parts(bench, quantity)
    ]
    half = len(pieces) // 2
    return line(
        np.concatenate(pieces[:half])[:-1],
        np.concatenate(pieces[half:])[:-1],
        label,
        color=color,
        dash="dot" if label.startswith("law, nominal") else "solid",
    )


def _rising_parts(bench: ContactBench, quantity: int) -> list[IntArray]:
    """Return the rising states by preload, a part for each tangential force.

    Forces that differ within a preload have a line of their own.
    """
    states, preload = bench.data.states, bench.nominal.preload
    rising = np.flatnonzero(~states.falling)
    if not states.several_forces:
        return [rising[np.argsort(preload[rising])]]
    own = bench.data.rows.state[bench.data.rows.quantity == quantity]
    kept = np.intersect1d(rising, own)
    kept = kept[np.argsort(states.shear[kept])]
    steps = np.diff(np.log(np.nan_to_num(states.shear[kept], nan=1.0)))
    parts = np.split(kept, np.flatnonzero(steps > _SAME_FORCE) + 1)
    return [part[np.argsort(preload[part])] for part in parts]


def _held_out(done: ContactDiagnosis) -> tuple[Item, ...]:
    before, after = done.before, done.after
    named = done.best is not done.base
    words = (
        f"Each torque is predicted from all others. Within the 95 % interval: "
        f"{100 * before.share_inside:.0f} % of the values by the law alone"
    )
    if named:
        words += f", {100 * after.share_inside:.0f} % with the effect"
    columns = ("torque or preload", "values", "chi2/dof before", "chi2/dof after")
    states = done.bench.data.states
    torques = set(states.torque[np.isfinite(states.torque)].tolist())
    rows = tuple(
        (
            engineering(level, "N m" if level in torques else "N"),
            *(f"{n:.0f}", f"{b / max(n, 1):.3g}", f"{a / max(n, 1):.3g}"),
        )
        for level, n, b, a in _levels(before, after)
    )
    return (Text(f"{words}."), DataTable("By level.", columns, rows))


def _levels(
    before: HeldOutTorques, after: HeldOutTorques
) -> Sequence[tuple[float, float, float, float]]:
    rows = list(
        zip(
            before.levels.tolist(),
            before.dof.tolist(),
            before.chi2.tolist(),
            after.chi2.tolist(),
            strict=True,
        )
    )
    return rows[:_MOST_LEVELS]
