# SPDX-License-Identifier: MIT
"""``jointbench contact`` on the command line; the work is done when it runs."""

from jointbench.station.contact_options import ContactOptions
from jointbench.station.option_record import options_of


@options_of(ContactOptions)
def contact_command(given: ContactOptions) -> None:
    """Predict a rough joint's stiffness and damping from D, G, material and preload.

    Example: jointbench contact --dimension 1.54 --roughness '1e-9 m' --modulus
    '29.3 GPa' --hardness '1.5 GPa' --load '1 kN' --load '25 kN'
    """
    from jointbench.station.contact_request import parse_request
    from jointbench.station.contact_show import run_contact

    run_contact(parse_request(given), given)
