# SPDX-License-Identifier: MIT
"""``jointbench contact`` and ``pressure-map``; the work is done when they run."""

from jointbench.station.commands.option_record import options_of
from jointbench.station.contact.pressure_map_options import PressureMapOptions
from jointbench.station.pipeline.contact_options import ContactOptions


@options_of(ContactOptions)
def contact_command(given: ContactOptions) -> None:
    """Predict stiffness and damping of a rough joint.

    The prediction follows a fractal contact law. The surface is given by D and G, or
    by measured surfaces; with --nominal-area these get the laws of their spectra too,
    with the range of each and a verdict. The preload is given by a force, by a bolt
    torque, or by the stiffness or real area to reach. Results are the normal and
    tangential stiffness [N/m], the real area [m^2] and the damping coefficient
    [N s/m].

    Examples:
        jointbench contact --dimension 1.54 --roughness '1e-9 m' --modulus '29.3 GPa'
        --hardness '1.5 GPa' --load '1 kN' --load '25 kN'
        jointbench contact --surface face-a.csv --surface face-b.csv --modulus
        '29.3 GPa' --hardness '231 HB' --torque '20 N m' --bolt-diameter '16 mm'
        --bolts 4 --mass '19.5 kg'
        jointbench contact --dimension 1.54 --roughness '1e-9 m' --modulus '29.3 GPa'
        --hardness '1.5 GPa' --load '1 kN' --sweep 'load:1 kN:50 kN:20' --plot
        contact.html
    """
    from jointbench.station.pipeline.contact_request import parse_request
    from jointbench.station.report.contact_report import run_contact

    run_contact(parse_request(given), given)


@options_of(PressureMapOptions)
def pressure_map_command(given: PressureMapOptions) -> None:
    """Predict contact patch and pressures of measured maps.

    The elastic contact of the heights of both sides is solved by half-space boundary
    elements. Results are the contact patch, the real area, the pressures, the mean gap
    and the stiffness per area [N/m^3], with waviness apart from roughness.

    Examples:
        jointbench pressure-map map-a.csv map-b.csv --modulus '115 GPa' --hardness
        '231 HB' --pressure '2.5 MPa' --plot pressures.html
        jointbench pressure-map a.csv --columns 'x:mm,y:mm,z:um' --modulus '115 GPa'
        --hardness '2 GPa' --pressure '1 MPa' --pressure '10 MPa' --cutoff '0.25 mm'
    """
    from jointbench.station.joints.pressure_map import run_pressure_map

    run_pressure_map(given)
