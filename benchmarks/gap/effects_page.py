# SPDX-License-Identifier: MIT
"""Print docs/gap-effects.md: every effect with its sites, range and source.

Usage: python benchmarks/gap/effects_page.py > docs/gap-effects.md
"""

import sys

from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.catalogue.real_joint_effects import REAL_JOINTS
from jointbench.analysis.gap.model.effect_parameter import Parameter
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect

INTRODUCTION = """# Effects of the gap engine

Made by `benchmarks/gap/effects_page.py` from the catalogue itself. A range is given in
units of the bench: *stiffness* and *damping* are those of the first joint, *travel* and
*speed* its largest motion and speed in the records without the effect, *force* is
stiffness times travel, *one* is a plain number.

The report draws the law of a named effect: force-deflection loops, and natural
frequency and damping ratio over amplitude, with 95 % bands
([record](decisions/0119-laws-drawn-by-the-first-harmonic.md)). `--json` has the numbers
under `exhibit.laws`.
"""
FURTHER = """## Further laws of real joints

Each contains a simpler law, or imitates one within noise, and is tried on request:

```sh
jointbench gap session.h5 --model bench.toml --with bouc_wen_free   # takes minutes
jointbench gap session.h5 --model bench.toml --with real_joints   # takes minutes
```

In Python: `diagnose(campaign, entries=with_real_joints(CATALOGUE, ["clearance"]))`. At
equal chi2 the simpler law is named
([record](decisions/0118-further-laws-on-request.md)).

* `bouc_wen_free`: z' = v (1 - |z/zy|^n (b sgn(v z) + g)) with force k z. The angle
  gives loading = b + g = cos(angle) and unloading = b - g = sin(angle): beyond 90
  degrees the loop grows stiffer with amplitude, as in the public benchmark of Noel and
  Schoukens.
* `iwan_segalman`: K_T, F_S, chi and beta of Segalman; dissipation per cycle grows as
  amplitude^(chi + 3) in micro-slip, and a share beta/(1 + beta) of the stiffness slips
  at phimax.
* `clearance`: stops at offset - half width and offset + half width; the offset is given
  over the half width. Below 1 in magnitude the joint is open at rest; above 1 it is
  closed by a preload and opens under large motion.
* `quadratic_cubic`, `cubic_quintic`: two powers with a common site.
* `power_damping`: c |v|^p sgn v; the amplitude is the force at 10 mm/s.
"""


def bounds(parameter: Parameter) -> str:
    """Return the range of a parameter with its scale."""
    return (
        f"{parameter.name} {parameter.lower:g} to {parameter.upper:g} "
        f"{parameter.scale} [{parameter.unit}]"
    )


def table(entries: tuple[LumpedEffect, ...]) -> list[str]:
    """Return one row for each effect."""
    lines = [
        "| effect | family | at | parameters | contains | source |",
        "|---" * 6 + "|",
    ]
    for entry in entries:
        effect = entry.effect
        cells = (
            effect.name,
            effect.family,
            ", ".join(entry.sites),
            "; ".join(bounds(one) for one in effect.parameters),
            ", ".join(effect.generalises),
            effect.source,
        )
        lines.append(
            "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
        )
    return lines


def main() -> None:
    """Print the page."""
    parts = [INTRODUCTION, "## Default catalogue", "", *table(CATALOGUE), ""]
    sys.stdout.write("\n".join([*parts, FURTHER, *table(REAL_JOINTS), ""]))


if __name__ == "__main__":
    main()
