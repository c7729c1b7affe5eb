# SPDX-License-Identifier: MIT
"""``jointbench contact`` on the command line; the work is done when it runs."""

from jointbench.station.commands.option_record import options_of
from jointbench.station.pipeline.contact_options import ContactOptions


@options_of(ContactOptions)
def contact_command(given: ContactOptions) -> None:
    """Predict a rough joint's stiffness and damping from D, G, material and preload.

    Example: jointbench contact --dimension 1.54 --roughness '1e-9 m' --modulus
    '29.3 GPa' --hardness '1.5 GPa' --load '1 kN' --load '25 kN'
    """
    from jointbench.station.pipeline.contact_request import parse_request
    from jointbench.station.report.contact_report import run_contact

    run_contact(parse_request(given), given)
