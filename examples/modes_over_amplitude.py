# SPDX-License-Identifier: MIT
"""A mass on a joint with micro-slip, struck at four levels: its mode over amplitude.

Usage: python examples/modes_over_amplitude.py
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks" / "modal"))
from amplitude_cases import draw

from jointbench.station.pipeline.chain import ChainSettings, judged_modes


def main() -> None:
    """Print what the amplitude does to each mode."""
    case = draw(1, law="micro-slip", softening=0.02, decibel=60.0, bodies=1)
    for mode in judged_modes([case.recording], ChainSettings()).amplitude:
        sys.stdout.write(f"{mode.soft.frequency:.2f} Hz: {mode.words()}\n")
        for law in mode.laws[:2]:
            sys.stdout.write(
                f"  {law.name}: {law.exponent:.3f} ± {law.exponent_sd:.3f}\n"
            )


if __name__ == "__main__":
    main()
