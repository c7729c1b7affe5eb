# SPDX-License-Identifier: MIT
"""Help of options that take names of a registry: it lists the names as installed."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from jointbench.station.screen.help_page import HelpCommand

Names = Callable[[], Sequence[str]]
"""Returns names of a registry; called when the help is shown, not at the start."""


def command_with_names(options: Mapping[str, tuple[str, Names]]) -> type[HelpCommand]:
    """Return a class of commands whose help lists names that are installed.

    Args:
        options: by the name of a parameter, the words before the names and what
            returns them; without names its help stays as it is.
    """

    class CommandWithNames(HelpCommand):
        """Completes the help of some options just before it is shown."""

        def get_help(self, ctx: Any) -> str:
            for parameter in self.params:
                _complete(parameter, options)
            return super().get_help(ctx)

    return CommandWithNames


def _complete(parameter: Any, options: Mapping[str, tuple[str, Names]]) -> None:
    """Add the names to the help of one parameter, once."""
    words, names = options.get(parameter.name, ("", tuple))
    known = ", ".join(names())
    if known and not parameter.help.endswith(f"{known}."):
        parameter.help = f"{parameter.help} {words} {known}."


def contact_models() -> tuple[str, ...]:
    """Return the names of all contact models."""
    from jointbench.analysis.contact.model_catalogue import CONTACT_LAWS

    return CONTACT_LAWS.names()


def added_effects() -> tuple[str, ...]:
    """Return the names of the effects that other packages add."""
    from jointbench.acquisition.basics.registry import added_names
    from jointbench.analysis.gap.model.effect import EFFECTS_GROUP

    return added_names(EFFECTS_GROUP)
