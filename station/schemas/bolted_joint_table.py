# SPDX-License-Identifier: MIT
"""The table [bolted_joint] of a model file: what the chain needs of one joint.

::

    [bolted_joint]
    link = "joint"                 # of the model; a joint in a model of meshed bodies
    bolts = 4
    diameter = "8 mm"
    area = "36 cm^2"               # apparent, of the contact surface
    modulus = "55 GPa"
    poisson = 0.25
    hardness = "1.5 GPa"
"""

from typing import Literal

from jointbench.station.schemas.joint_states_model import BodiesTable, BoltedJointTable
from jointbench.station.schemas.positive_quantities import Pressure


class BoltedLinkTable(BoltedJointTable, BodiesTable):
    """One link of a model as a bolted joint between measured surfaces.

    The direction is that of the contact stiffness that the link stands for.
    """

    link: str
    hardness: Pressure
    direction: Literal["normal", "tangential"] = "normal"
