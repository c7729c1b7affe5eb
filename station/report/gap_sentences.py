# SPDX-License-Identifier: MIT
"""A diagnosis in words: the headline, and the reason against each rival."""

from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, Finding, Ranked
from jointbench.station.report.gap_numbers import percent, sure

_PREPOSITIONS = {"link": "in", "body": "on body", "channel": "on channel"}
_ALL = "channel:all"
_MAINLY = 0.6
_SEEN = {
    "level": "at",
    "hit point": "from hits on",
    "preload": "at preload",
    "torque": "at",
}
SMALL_GAP = 0.3
"""Gap below which the records are nearly met: priors or a directed test decide."""
PRIORS = "priors"
"""View of a gap that shows in the prior deviations only; the key of JSON files."""


def place(site: str) -> str:
    """Return a site in words.

    >>> place("link:joint"), place("body:m2"), place("channel:all")
    ('in the joint', 'on body m2', 'on all channels')
    >>> place("bolt:2"), place("bolts:all"), place("point:P1")
    ('at bolt 2', 'at all bolts', 'at P1')
    """
    if site == _ALL:
        return "on all channels"
    kind, _, name = site.partition(":")
    if site == "bolts:all":
        return "at all bolts"
    if kind == "joint":
        return f"in the joint, {name}"
    if kind == "point":
        return f"at {name}"
    if kind == "link":
        return "in the joint" if name == "joint" else f"in link {name}"
    return f"{_PREPOSITIONS.get(kind, 'at ' + kind)} {name}"


def effect_words(label: str) -> str:
    """Return effects and sites in words.

    >>> effect_words("cubic_stiffness@link:joint")
    'cubic stiffness in the joint'
    """
    parts = [part.partition("@") for part in label.split(" + ")]
    return " and ".join(
        name.replace("_", " ") + (f" {place(site)}" if site else "")
        for name, _, site in parts
    )


def headline(found: Diagnosis) -> str:
    """Return what was found, in one sentence for the top of a report."""
    if found.verdict is Finding.NONE:
        return "Nothing is missing: the model explains every record within its noise"
    if found.verdict is Finding.UNKNOWN:
        return _unknown(found)
    if found.verdict is Finding.MOSTLY:
        return _mostly(found)
    names = _names(found)
    text = f"{names[:1].upper()}{names[1:]} {_explains(found)}"
    if found.verdict is Finding.AMBIGUOUS:
        text += "; these records cannot distinguish them"
    return text


def _names(found: Diagnosis) -> str:
    """Return the explanations in words, those of several effects set off by commas."""
    sets = [effect_words(" + ".join(labels)) for labels in found.explanations]
    several = any(len(labels) > 1 for labels in found.explanations)
    return (", or " if several else " or ").join(sets)


def _unknown(found: Diagnosis) -> str:
    if len(found.explanations) > 1:
        return (
            "Several explanations fit equally well; these records cannot "
            "distinguish them"
        )
    if found.partial is not None and found.partial.nonlinear:
        return f"Nonlinear {place(found.partial.site)}, family open"
    if found.explanations:
        return "These records cannot show whether an effect is missing, or which"
    if found.gap_before.value < SMALL_GAP:
        return "Nominal parameters and records disagree; no effect explains it"
    return "An effect is missing that is not in the catalogue"


def _mostly(found: Diagnosis) -> str:
    partial = found.partial
    if partial is None and found.effects:
        names = _names(found)
        return f"{names[:1].upper()}{names[1:]} explains most of it, not all"
    if partial is None:
        return _unknown(found)
    where = place(partial.site)
    return (
        f"{partial.family.capitalize()} {where} explains most of the gap "
        f"({percent(partial.share)} of the residual power, held out); the model is "
        "not true to the noise"
    )


def _explains(found: Diagnosis) -> str:
    several = found.verdict is Finding.NAMED and len(found.effects) > 1
    verb = "explain" if several else "explains"
    largest, limit = found.null_statistic
    priors = (
        largest <= limit if found.evidence is None else found.evidence.view == PRIORS
    )
    if not found.predicted:
        return f"{verb} the records, but only one condition shows it"
    if found.gap_before.value < SMALL_GAP and not priors:
        return (
            f"{verb} the small remaining gap: a directed test lowers chi2 by "
            f"{largest:.0f}, noise rarely by more than {limit:.0f}"
        )
    if found.gap_before.value < SMALL_GAP:
        before = max((abs(b) for b, _ in found.prior_deviations.values()), default=0.0)
        after = found.gap_after.prior_deviation
        verb = "bring" if several else "brings"
        return (
            f"{verb} the parameters back to their nominal values: largest prior "
            f"deviation {before:.2g} sd before, {after:.2g} sd after"
        )
    whole = found.shrink >= 1.0
    size = "the whole" if whole else percent(found.shrink) + " of the"
    return f"{verb} {size} gap{_seen(found)}"


def _seen(found: Diagnosis) -> str:
    """Name the slice of the most significant view that shows the gap, if it is one."""
    name = found.evidence.view if found.evidence is not None else ""
    view = next((v for v in found.gap_before.views if v.name == name), None)
    if view is None or name not in _SEEN or len(view.share) < 2:
        return ""
    top = max(view.share, key=lambda label: view.share[label])
    if view.share[top] < _MAINLY:
        return ""
    if name == "level":
        hardest = max(view.share, key=lambda label: float(label.partition(" ")[0]))
        return ", seen at high level" if top == hardest else f", seen at {top}"
    return f", seen {_SEEN[name]} {top}"


def next_step(found: Diagnosis) -> str:
    """Return what to do next."""
    if found.verdict is Finding.NAMED:
        return f"use it; {found.experiment}"
    return found.experiment


def why_lost(one: Ranked, found: Diagnosis) -> str:
    """Return the reason against an explanation, or its place in the answer.

    Args:
        one: explanation that was tried.
        found: the diagnosis it belongs to.
    """
    faults = _faults(one, found)
    best = found.candidates[0]
    if found.verdict is Finding.NONE and one.effects == ("none",):
        return "nothing more is needed"
    lost = found.verdict in (Finding.UNKNOWN, Finding.MOSTLY)
    if one is best and not lost:
        return "the best" if not faults else "the best, but " + faults
    if faults:
        return faults
    if lost:
        return _not_distinguished(one, found)
    if one.effects in found.explanations:
        return "not distinguishable from the best"
    if set(best.effects) < set(one.effects):
        return "the best with one effect more, which explains nothing further"
    # Without the limits of the campaign it is not known whether it fits at all.
    return "fits, but less well" if found.evidence is not None else "fits less well"


def _not_distinguished(one: Ranked, found: Diagnosis) -> str:
    if one.effects in found.explanations:
        return "fits, but these records cannot confirm it"
    if found.explanations:
        return "fits less well"
    closest = one is found.candidates[0]
    return "best fit, rejected" if closest else "fits less well than the best"


def _faults(one: Ranked, found: Diagnosis) -> str:
    limits = found.evidence.limits if found.evidence is not None else None
    faults = []
    if limits is not None and one.chi2_per_dof > limits.chi2_allowed:
        faults.append(f"chi2/dof above {limits.chi2_allowed:.4g}")
    if limits is not None and one.prior_deviation > limits.deviation_allowed:
        faults.append(f"prior deviation above {limits.deviation_allowed:g} sd")
    return ", ".join(faults)


def limit_rows(found: Diagnosis) -> tuple[tuple[str, str, str], ...]:
    """Return effect, largest amplitude that is not excluded, and its shape."""
    rows = []
    for one in found.limits:
        first, *shape = one.parameters
        at = ", ".join(f"{p.name} {p.value:.3g} {p.unit}" for p in shape)
        size = f"{first.name} {first.value:.3g} {first.unit}"
        rows.append((f"{one.name.replace('_', ' ')} {place(one.site)}", size, at))
    return tuple(rows)


def second_method_words(found: Diagnosis) -> str:
    """Return how far the second method is from the first; empty without a check."""
    check = found.second_method
    if check is None:
        return ""
    words = effect_words(" + ".join(check.effects))
    what = "base model" if check.effects == ("none",) else words
    if check.over_peak is None or check.over_noise is None:
        return f"{what}: not predicted by the second method: {check.reason}"
    return (
        f"{what}: a second time integration differs by {check.over_peak:.1g} of the "
        f"peak and {check.over_noise:.1g} of the noise (record {check.record}: "
        f"{check.condition})"
    )


def closest_words(found: Diagnosis) -> str:
    """Return the confidence of the best explanation where none is accepted."""
    if found.closest is None or found.verdict not in (Finding.UNKNOWN, Finding.MOSTLY):
        return ""
    words = effect_words(" + ".join(found.closest.effects))
    chance = sure(found.closest.confidence)
    return f"{words} would be right with a probability of {chance}"
