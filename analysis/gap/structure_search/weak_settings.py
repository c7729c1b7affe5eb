# SPDX-License-Identifier: MIT
"""Settings of the tests of weak effects beside a base that explains the hits."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class WeakEffectSettings:
    """Numbers of the tests; unit, purpose and basis are with each field."""

    floor: float = numerical(
        3e-4,
        "of the peak",
        "error of the model beside errors of the bodies of an uncertain modal table, "
        "where weak effects are sought",
        "second-order aim leaves 0.03 % with exact tables",
    )
    share: float = numerical(
        0.1,
        "of the sd",
        "errors of residues that are left beside errors of the bodies",
        "second order of errors of 2 %, mixed among modes near each other",
    )
    drop: float = numerical(
        40.0,
        "of what is left",
        "drop of the cost by an effect, over what its fit leaves beyond noise or one, "
        "from which it is named beside an accepted base",
        "37 complete benches: directed tests of at most 16, or 24 with the last step "
        "of the base (504700); fits of hidden effects 90 to 2860",
    )
    left: float = numerical(
        3.0,
        "-",
        "what a fit may leave beyond noise, with that floor, over as many numbers as "
        "records have",
        "34 of 37 complete benches leave 0.3 to 2.8, with weak effects fitted 0.3 to "
        "2.0; a table wrong by 2 % at each place leaves 4 to 42",
    )
    resemblance: float = numerical(
        0.01,
        "of the cost",
        "drop of the largest of these tests below which what a base leaves resembles "
        "no effect",
        "complete benches whose base left 8 and 44 had 0.2 %, hidden effects 8 to 80 %",
    )
    suspicion: float = numerical(
        0.2,
        "of the cost",
        "largest of these tests from which a base that explains the hits, and leaves "
        "more than errors of bodies, is no verdict where no effect explains it",
        "37 complete benches: at most 6 % (before the last step of the base); a gain "
        "of 5 % taken out of the catalogue (543002) 34 %",
    )
    part: float = numerical(
        0.5,
        "of what the base leaves",
        "cost of a fit below which errors of bodies are those about it, and what an "
        "effect named by other tests may leave here",
        "a wrong name left more than this of 19 (703001), fits of true effects beside "
        "bases that leave more than 3 had 3 to 21 %",
    )
    rival: float = numerical(
        0.5,
        "of the largest",
        "drop of a directed test there, relative to the largest, from which the effect "
        "is fitted",
        "linear tests take one effect of a channel for another: 913 for a cable "
        "resonance, 1088 for a place, with fits 2282 and 1431 (571007)",
    )
    levels: int = numerical(
        2,
        "levels",
        "highest levels of each point in these tests",
        "drops with four levels were 0.9 to 1.2 times as large",
    )
    iterations: int = numerical(
        3, "steps", "most steps of the base there", "it begins at its minimum"
    )


WEAK = WeakEffectSettings()
