# SPDX-License-Identifier: MIT
"""The report's section on the quality of the FRFs and of the modal model."""

import numpy as np

from jointbench.signal.frf.measured_frf import check_levels
from jointbench.signal.frf.mode_indicators import cmif
from jointbench.signal.hits.find_hits import accepted_hits
from jointbench.signal.hits.leakage import estimate_leakage
from jointbench.signal.hits.windows import HammerWindow, choose_window, join_windows
from jointbench.signal.modal.mode_ranking import rate_modes
from jointbench.station.drawing.palette import MEASURED, MEMBERS, MODEL
from jointbench.station.pipeline.chain import ModalChain
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page_parts import Plot, Section, Text
from jointbench.station.screen.plot_numbers import thin
from jointbench.station.screen.traces import line

_MOST_POINTS = 3000
_CURVES = (MEASURED, *MEMBERS[:3])


def checks_section(chain: ModalChain) -> Section:
    """Return indicator functions, synthesis error by line, leakage and linearity."""
    return Section("checks", "Checks", (_indicators(chain), *_hit_checks(chain)))


def _hit_checks(chain: ModalChain) -> tuple[Text, ...]:
    """Return the checks that need the samples of the hits."""
    if not chain.recordings:
        words = "Leakage and linearity: not checked, FRFs from files have no samples."
        return (Text(words),)
    window = join_windows(
        [choose_window(r) for r in chain.recordings if accepted_hits(r)]
    )
    return Text(_leakage(chain, window)), Text(_linearity(chain))


def _indicators(chain: ModalChain) -> Plot:
    result = chain.result
    low, high = result.band
    inside = (chain.frf.frequency >= low) & (chain.frf.frequency <= high)
    values = cmif(chain.frf)[:, inside]
    frequency = chain.frf.frequency[inside]
    traces = [
        line(*thin(frequency, row, _MOST_POINTS), f"CMIF {i + 1}", color=_CURVES[i])
        for i, row in enumerate(values[: len(_CURVES)])
    ]
    traces.append(
        line(
            *thin(
                result.synthesis.frequency, 100 * result.synthesis_error, _MOST_POINTS
            ),
            "synthesis error",
            color=MODEL,
            width=1,
            axes=("x", "y2"),
        )
    )
    plot = figure(
        traces,
        axis("frequency [Hz]", anchor="y2"),
        axis("singular value", log=True, domain=[0.4, 1.0]),
        yaxis2=axis("error [%]", log=True, domain=[0.0, 0.32]),
    )
    caption = (
        "Complex mode indicator function: singular values of the FRF matrix; two "
        "coincident peaks are two modes. Below: synthesis error of each line, rms over "
        "all FRFs."
    )
    return Plot("cmif-plot", caption, plot, 460)


def _leakage(chain: ModalChain, window: HammerWindow) -> str:
    leakage = estimate_leakage(chain.recordings, window)
    return (
        f"Leakage: {100 * leakage.typical:.2g} % of the response amplitude is "
        f"truncated by the windowed block, at most {100 * leakage.worst:.2g} % near "
        f"{leakage.worst_frequency:.5g} Hz."
    )


def _linearity(chain: ModalChain) -> str:
    judged = [r for r in chain.recordings if accepted_hits(r)]
    return f"Linearity: {(chain.levels or check_levels(judged)).words}."


def systematic_words(chain: ModalChain) -> str:
    """Name the modes whose intervals are systematic, with the median and the worst."""
    model = chain.result.model
    rated = rate_modes(model, chain.result.stabilisation.orders.size)
    marked = np.flatnonzero(model.systematic)
    if marked.size == 0:
        return "Noise dominates the intervals of all modes."
    error = rated.frequency_error[marked]
    worst = int(np.argmax(error))
    share = error / model.natural_frequency[marked]
    damping = rated.damping_error[marked] / np.abs(model.damping_ratio[marked])
    return (
        f"Systematic error exceeds noise at {marked.size} of "
        f"{model.natural_frequency.size} modes: median {np.median(error):.2g} Hz "
        f"({100 * np.median(share):.1g} %) and {100 * np.median(damping):.2g} % of the "
        f"damping, maximum {error[worst]:.2g} Hz (mode {marked[worst] + 1}). Possible "
        "causes: leakage, a missing neighbouring mode, a nonlinear structure; more "
        "hits would not narrow these intervals."
    )
