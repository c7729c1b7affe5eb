# SPDX-License-Identifier: MIT
"""Settings of laws at the ports of bolted bodies and of their time integration."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class PortLawSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    slider_steps: tuple[int, int] = numerical(
        (1, 2),
        "steps/sample",
        "steps of the time integration per raw sample where all laws are friction: in "
        "fits, and in what is judged",
        "errors over the peak: 9e-5 and 2e-5 for slip of whole bolts, 2e-5 and 4e-6 "
        "for micro-slip",
    )
    law_steps: tuple[int, int] = numerical(
        (2, 8),
        "steps/sample",
        "the same with a stop or another law",
        "errors over the peak: 4e-4 and 2e-5 for a stop, 1.2e-3 and 2e-5 for a cubic "
        "spring that makes 80 % of the response",
    )
    slider_corrections: int = numerical(
        1,
        "-",
        "corrections of the forces of sliders in one step, from a guess that continues "
        "a straight line",
        "responses with 1 and 4 differ by less than 2e-5 of the peak",
    )
    law_corrections: int = numerical(
        6,
        "-",
        "the same where a law is not friction: a stop is several times stiffer than "
        "its bolt",
        "each reduces the error of a stop by 3 or more",
    )
    rest_steps: int = numerical(
        32,
        "samples",
        "samples between two questions whether a slider can slip again",
        "a question takes as long as a step",
    )
    hits_at_once: int = numerical(
        24,
        "hits",
        "hits that are integrated side by side",
        "one product moves all ports and modes of them; soft hits end sooner",
    )
    sliders: int = numerical(
        32,
        "sliders",
        "sharp sliders of friction at a port",
        "with 16, micro-slip of twice the slip displacement and share was 5,000 units "
        "of chi2 worse than the half of both, with 40 as good (seed 492402)",
    )
    outer_sliders: tuple[float, float] = numerical(
        (0.002, 0.015),
        "of the stiffness",
        "what the weakest and the strongest of them have",
        "soft hits move by a thirtieth of hard ones",
    )
    least_slip: float = numerical(
        0.003,
        "of the slip displacement",
        "least end of the cell of the weakest one",
        "a motion of 0.3 % slips little of a wide spread",
    )
    shapes: tuple[float, float] = numerical(
        (0.06, 30.0),
        "-",
        "least and largest shape of the strengths of sliders",
        "wider than a joint: Coulomb's friction, and sliders without a mean strength",
    )
    least_tail: float = numerical(
        1e-3, "-", "tail of the strengths below which they are those of Weibull"
    )
    micro_share: float = numerical(
        0.165,
        "of the stiffness",
        "stiffness that slips below half of the slip displacement above which friction "
        "is micro-slip, and below which it is macro-slip",
        "0.145 of a Richard-Abbott law with n = 3, which slips as a whole, 0.184 "
        "of Mindlin's contact, of which a ring slips at any motion",
    )
    law_slope_step: float = numerical(
        1e-5,
        "-",
        "difference step of a coordinate for slopes of the forces of laws",
        "above the rounding of a time integration, below the width of a slip",
    )
    least_law_value: float = numerical(
        1e-2,
        "-",
        "value of a coordinate of a law below which this step does not shrink with it",
        "as in other fits",
    )


PORT_LAWS = PortLawSettings()
