# SPDX-License-Identifier: MIT
"""Remarks on the base of a verdict on records at several levels."""

from jointbench.analysis.gap.diagnosis.level_diagnosis import LevelDiagnosis
from jointbench.analysis.gap.modal_bench.level_records import RecordSet
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, Finding


def level_remarks(given: RecordSet, done: LevelDiagnosis) -> tuple[str, ...]:
    """Return one line each on the base, the scale of its shapes and the noise.

    Args:
        given: the records.
        done: their diagnosis.
    """
    base = done.base
    modes = ", ".join(
        f"{f:.4g} Hz ({100 * z:.3g} %)"
        for f, z in zip(base.nominal.frequency, base.nominal.damping, strict=True)
    )
    lines = [
        f"base of the lowest level ({given.lowest[0].level}): {modes}; chi2/dof "
        f"{done.base_chi2:.3g} there"
    ]
    if any(r.linear for r in given.lowest):
        lines.append(_frf_remark(given))
    lines += _pair_remark(done.found)
    if not set(given.inputs) & set(given.sensors):
        lines.append(
            "no sensor is where a force acts, so that the scale of the shapes, and of "
            "every force at a port, is not known: put one there"
        )
    if given.repeatability is not None:
        share = 100 * given.repeatability
        lines.append(f"{share:g} % of the peak response counts as noise, as stated")
    return tuple(lines)


def _frf_remark(given: RecordSet) -> str:
    """Return what the FRF of the lowest level serves for."""
    level = given.lowest[0].level
    if given.lowest[0] in given.fitted:
        return (
            f"only one level beside the FRF ({level}): laws are fitted to the FRF as "
            "well, as if its force had been a multisine; add a level to let it serve "
            "the base alone"
        )
    return f"the FRF ({level}) serves the base alone; laws are fitted to other levels"


def _pair_remark(found: Diagnosis) -> tuple[str, ...]:
    """Return the best fit where it has several laws and is not named."""
    if found.verdict in {Finding.NAMED, Finding.AMBIGUOUS} or not found.candidates:
        return ()
    best = found.candidates[0]
    if len(best.effects) < 2:
        return ()
    alone = [c.chi2_per_dof for c in found.candidates if len(c.effects) == 1]
    return (
        f"the best fit, rejected, is {' + '.join(best.effects)} with chi2/dof "
        f"{best.chi2_per_dof:.3g} (one law: {min(alone, default=float('nan')):.3g}); "
        "errors on records outside the fit are those of this fit",
    )
