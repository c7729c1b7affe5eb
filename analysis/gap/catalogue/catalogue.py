# SPDX-License-Identifier: MIT
"""Catalogue of lumped dynamics: 22 effects by default, six further laws on request.

Other packages can add effects, see `installed_effects`.
"""

import difflib
from collections.abc import Iterable

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.catalogue.linear_effects import LINEAR
from jointbench.analysis.gap.catalogue.nonlinear_effects import NONLINEAR
from jointbench.analysis.gap.catalogue.real_joint_effects import REAL_JOINTS
from jointbench.analysis.gap.model.effect import Candidate, Site
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.analysis.lumped.lumped_model import LumpedModel

CATALOGUE: tuple[LumpedEffect, ...] = (*NONLINEAR, *LINEAR)
ALL_CHANNELS = "all"
ALL_REAL_JOINTS = "real_joints"
"""Stands for all further laws."""


def check_names(names: Iterable[str], entries: tuple[LumpedEffect, ...]) -> None:
    """Raise `UsageError` for an unknown name, with near matches."""
    known = [e.effect.name for e in entries]
    for name in names:
        if name not in known:
            near = difflib.get_close_matches(name, known) or known
            raise UsageError(
                f"no effect is called {name!r}; did you mean {', '.join(near)}?"
            )


def with_real_joints(
    entries: tuple[LumpedEffect, ...], names: Iterable[str]
) -> tuple[LumpedEffect, ...]:
    """Return a catalogue with further laws of real joints.

    Args:
        entries: the catalogue.
        names: of `REAL_JOINTS`, or `ALL_REAL_JOINTS`; a law that is in the catalogue
            already is not added again.

    Raises:
        UsageError: a name is unknown.
    """
    wanted = frozenset(names)
    if ALL_REAL_JOINTS in wanted:
        wanted = frozenset(entry.name for entry in REAL_JOINTS) | wanted
    check_names(wanted - {ALL_REAL_JOINTS}, REAL_JOINTS)
    known = {entry.name for entry in entries}
    more = [e for e in REAL_JOINTS if e.name in wanted and e.name not in known]
    return (*entries, *more)


def sites_of(entry: LumpedEffect, model: LumpedModel) -> tuple[Site, ...]:
    """Return the sites of a model at which an entry applies."""
    found: list[Site] = []
    if "link" in entry.sites:
        found += [Site("link", x.name) for x in model.links if x.joint]
    if "body" in entry.sites:
        found += [Site("body", x.name) for x in model.bodies]
    if "channel" in entry.sites:
        several = len(model.channels) > 1
        if entry.mixing is None or several:
            found += [Site("channel", x.name) for x in model.channels]
        if entry.every_channel and several:
            found.append(Site("channel", ALL_CHANNELS))
    return tuple(found)


def candidates_of(
    entries: tuple[LumpedEffect, ...], model: LumpedModel
) -> tuple[Candidate, ...]:
    """Return every entry at every site it applies to."""
    return tuple(
        Candidate(entry.effect, site)
        for entry in entries
        for site in sites_of(entry, model)
    )


def site_index(model: LumpedModel, site: Site) -> int:
    """Return the index of a site's element in the model, -1 for all channels."""
    if site.kind == "channel" and site.name == ALL_CHANNELS:
        return -1
    rows = {
        "link": [x.name for x in model.links],
        "body": [x.name for x in model.bodies],
        "channel": [x.name for x in model.channels],
    }[site.kind]
    return rows.index(site.name)
