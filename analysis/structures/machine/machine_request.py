# SPDX-License-Identifier: MIT
"""What is computed of a machine."""

from dataclasses import dataclass

from jointbench.analysis.structures.machine.loads import Begin, Load


@dataclass(frozen=True, slots=True)
class Cut:
    """The cut at the tool.

    Attributes:
        coefficient: cutting force over chip area [N/m^2].
        chip: direction of the chip thickness.
        force: direction of the cutting force.
        speed: lowest and highest of the spindle [1/s].
        teeth: that follow each other in one turn.
    """

    coefficient: float
    chip: tuple[float, float, float]
    force: tuple[float, float, float]
    speed: tuple[float, float]
    teeth: int = 1


@dataclass(frozen=True, slots=True)
class TimeSpan:
    """Of a transient.

    Attributes:
        duration: [s].
        step: between samples [s].
        begin: from rest or steady.
        poles: that move; the others respond statically.
    """

    duration: float
    step: float
    begin: Begin = Begin.REST
    poles: int = 80


@dataclass(frozen=True, slots=True)
class MachineRequest:
    """What is computed of a machine.

    Attributes:
        band_hz: highest frequency of interest [Hz].
        modes: number of modes.
        lines: number of lines of receptances.
        samples: of the uncertain joint values.
        seed: of these.
        tool: name of the point.
        loads: on x, y, z of the points, numbered point by point.
        span: of the transient; None leaves it out.
        cut: at the tool; None leaves the stability limit out.
    """

    band_hz: float
    modes: int = 10
    lines: int = 800
    samples: int = 100
    seed: int = 1
    tool: str = "tool"
    loads: tuple[Load, ...] = ()
    span: TimeSpan | None = None
    cut: Cut | None = None
