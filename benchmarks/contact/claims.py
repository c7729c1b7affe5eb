# SPDX-License-Identifier: MIT
"""Run every published claim on joint contact again and write the page about it.

python benchmarks/contact/claims.py    writes docs/contact-published-claims.md
"""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import claims_2023
import claims_2025
import numpy as np
import plate_rig
from claim import CANNOT, CORRECTED, DOES_NOT, REPRODUCES, Claim

from jointbench.analysis.contact.asperity_laws import FullyPlastic
from jointbench.analysis.contact.energy import joint_energy
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.models import Interaction
from jointbench.analysis.contact.solve import solve_largest_area

PAGE = Path(__file__).resolve().parents[2] / "docs" / "contact-published-claims.md"
MARKS = (REPRODUCES, CORRECTED, DOES_NOT, CANNOT)
TITLES = {
    "2023": "Appl. Sci. 2023, 13, 11680",
    "2025": "Appl. Sci. 2025, 15, 9040",
}

HEAD = """# Published claims on joint contact, computed again

Made by `benchmarks/contact/claims.py`; every number is computed when it runs. Each
claim is marked: it **reproduces**, it **reproduces with a correction** (which), it
**does not** (why, by how much), or it **cannot be checked** (what is missing). Printed
formulas are evaluated to the letter (`mode as-printed`) beside the same laws summed
right (`corrected` where a model is named). K here is, as in the papers, the sum of the
single contacts' stiffnesses at their present sizes, not the derivative of the load by
the approach of the bodies; `jointbench contact --json` has that one too.

"""


def table(paper: str, claims: list[Claim]) -> str:
    """Return one paper's table."""
    text = f"\n## {TITLES[paper]}\n\n| where | claim | mark | evidence |\n"
    text += "|---|---|---|---|\n"
    for claim in claims:
        cells = (claim.where, claim.says, f"**{claim.mark}**", claim.evidence)
        text += "| " + " | ".join(cells) + " |\n"
    return text


DAMPING = """
# Energies of the loss factor

The papers print eta = W_d/W_e and nothing else. Two forms are built: the two-regime
form (elastic contacts store 2/5 P delta, all others lose H a delta/2), and the form
that follows Kogut and Etsion's laws (work = integral of the load law; unloading as
Etsion, Kligerman and Kadin 2005 have it). An earlier evaluation of the second was
missed by 4 to 32 % where plasticity matters. Derived again: it took the work of full
plasticity as 2 pi R delta H in both dimensions, while its load there was H a. The work
must be the integral of the load that is borne. With a = pi R delta (surface), 2 pi R
delta H is 2 H a, which is what `corrected` bears: there the two agree, and the earlier
one was wrong in its load. With a = pi^2 R delta (profile) it is 0.64 H a: work without
a load. With that choice our sums meet its W_e to 1e-14 and its W_d to 1.4e-4. That rest
is its quadrature's: it runs over the kink where a contact begins to lose (s = 1.248),
and it begins at 1e-12 of the fully plastic bound, which we allow for.

E = 69.3 GPa, HB 231, G = 1 nm, 1 kN, no interaction:

| D | W_d/W_e, corrected | load H a, work 2 pi R delta H | ratio |
|---|---|---|---|
"""


def damping() -> str:
    """Return the section on the energies."""
    text = DAMPING
    material = claims_2023.IRON
    for name, low in (("modified_2d", 1), ("friction_3d", 2)):
        for e in (0.3, 0.4, 0.5, 0.6, 0.7, 0.8):
            model = replace(contact_model(name), interaction=Interaction.NONE)
            mixed = replace(model, plastic=FullyPlastic(1.0))
            flowing = FullyPlastic(2 * np.pi / model.topography.shape)
            surface = FractalSurface(
                np.array(low + e), np.array(1e-9), np.array(material.hardness)
            )
            ratios = []
            for load, work in (
                (model, model),
                (mixed, replace(mixed, plastic=flowing)),
            ):
                area = solve_largest_area(load, surface, material, np.array(1e3))
                energy = joint_energy(work, surface, material, area)
                lost, stored = energy.dissipated.sum(), energy.recovered.sum()
                ratios.append(float(lost / stored))
            cells = " | ".join(f"{x:.4g}" for x in (*ratios, ratios[0] / ratios[1]))
            text += f"| {low + e:g} | {cells} |\n"
    return text + (
        "\nAll of it is the loss of a first loading. A small vibration about the "
        "preload loses less,\nby micro-slip and in the bodies: take it for an upper "
        "bound.\n"
    )


def main() -> None:
    """Write the page."""
    by_paper = {"2023": claims_2023.claims(), "2025": claims_2025.claims()}
    count = Counter(claim.mark for claims in by_paper.values() for claim in claims)
    text = HEAD + "| mark | claims |\n|---|---|\n"
    text += "".join(f"| {mark} | {count[mark]} |\n" for mark in MARKS)
    for paper, claims in by_paper.items():
        text += table(paper, claims)
    text += plate_rig.section() + damping()
    PAGE.write_text(text, encoding="utf-8")
    print(dict(count))


if __name__ == "__main__":
    main()
