# SPDX-License-Identifier: MIT
"""Labels of degrees of freedom that files number: node and direction, ``"12+z"``."""

_TRANSLATIONS = {1: "+x", -1: "-x", 2: "+y", -2: "-y", 3: "+z", -3: "-z"}
_ROTATIONS = {4: "+rx", -4: "-rx", 5: "+ry", -5: "-ry", 6: "+rz", -6: "-rz"}
_WAYS = _TRANSLATIONS | _ROTATIONS


def degree_of_freedom(node: int, direction: int) -> str:
    """Return node and direction as one label; empty without a node.

    Args:
        node: its number, 0 for none.
        direction: 1 to 3 along x, y, z, 4 to 6 about them, negative the other way, 0
            for a scalar: the code of universal files, data set 58.
    """
    return f"{node}{_WAYS.get(direction, '')}" if node else ""
