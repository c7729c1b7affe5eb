# SPDX-License-Identifier: MIT
"""The link between surfaces and joint: is k(preload) that of the contact law?"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.gap.chain.chain_records import LinkTest
from jointbench.analysis.gap.chain.chain_settings import CHAIN
from jointbench.analysis.gap.contact_bench.contact_bench import (
    ContactBench,
    make_contact_bench,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.joint_states import JointData
from jointbench.analysis.gap.contact_bench.preload_law import PreloadLaw
from jointbench.analysis.gap.law_diagnosis.contact_search import (
    accept_contact,
    fit_contact_base,
    fit_effect,
)
from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.screening import screen

_BENDS = (
    "curvature_over_preload",
    "third_power_of_preload",
    "offset_when_falling",
    "slope_when_falling",
)
"""Shapes of a discrepancy of ln k beside its offset and slope."""
CUT = "scale_cut"
"""Effect of the contact bench that lies at the surface: a cut-off of the instrument."""


@dataclass(frozen=True, slots=True, eq=False)
class ContactLink:
    """The contact law fitted to a joint over its preload.

    Attributes:
        bench: values and law.
        base: fit of the law within its priors.
    """

    bench: ContactBench
    base: Fit


def fit_contact_link(data: JointData, law: PreloadLaw) -> ContactLink:
    """Fit a contact law to a joint within its priors.

    Args:
        data: stiffness over preload.
        law: of the surfaces.
    """
    return ContactLink(*fit_contact_base(make_contact_bench(data, law)))


def base_test(link: ContactLink) -> LinkTest:
    """Test the law as it is."""
    return _judged(link, link.base, "explains the joint within its priors")


def free_test(link: ContactLink) -> LinkTest:
    """Test the law with a free discrepancy of ln k: offset, slope, curvature, ends."""
    bench = _with_free_factor(link.bench)
    bends = tuple(p for p in bench.probes if p.effect.name in _BENDS)
    start = np.concatenate([link.base.x, np.zeros(len(bends))])
    problem = make_problem(bench, bends)
    fit = minimise(problem, start, FULL, iterations=CONTACT.descent_steps)
    dof = max(bench.blocks.dof, 1)
    limit = chi2_limit(CONTACT.fit_chance, dof)
    passed = fit.cost <= limit
    words = "with a free offset, slope and curvature of ln k"
    if not passed:
        words += f" chi2 is {fit.cost:.1f}, the limit is {limit:.1f}"
    charge = bench.policy.parameter_charge * (len(bends) + 2)
    return LinkTest(fit.cost, dof, passed, words, charge)


def cut_test(link: ContactLink) -> LinkTest | None:
    """Test the law with a free cut-off of the surface instrument; None without one."""
    bench = link.bench
    found = [c for c in bench.candidates if c.effect.name == CUT]
    if not found:
        return None
    tests = screen(bench, link.base, [*bench.candidates, *bench.probes])
    fit = fit_effect(bench, link.base, tests, found[0])
    return _judged(link, fit, "with another cut-off of the instrument")


def _judged(link: ContactLink, fit: Fit, words: str) -> LinkTest:
    bench = link.bench
    tested: list[Candidate] = [*bench.candidates, *bench.probes]
    left = screen(bench, fit, [c for c in tested if c not in fit.candidates])
    acceptance = accept_contact(bench, fit, link.base, left)
    charge = bench.policy.parameter_charge * (fit.x.size - fit.n_base)
    reason = acceptance.reason or words
    return LinkTest(fit.cost, bench.blocks.dof, acceptance.passed, reason, charge)


def _with_free_factor(bench: ContactBench) -> ContactBench:
    """Return the bench with a free factor and exponent of the law."""
    sd = bench.layout.sd.copy()
    sd[bench.layout.factor] = CHAIN.free_factor_sd
    sd[bench.layout.factor + 1] = CHAIN.free_power_sd
    return replace(bench, layout=replace(bench.layout, sd=sd))
