# SPDX-License-Identifier: MIT
"""The bench model of a simulated campaign as a file: nominal values with 1-sigma."""

from jointbench.simulators.bolted_faces.bolted_faces import FaceDesign
from jointbench.simulators.hidden.campaign_design import NOMINAL_SIGMA, CampaignDesign

HEAD = "# Two bodies, weighed, on a support and a joint known from their drawings."
"""First line of every model file."""
TEMPLATE = (
    f"{HEAD}\n"
    + """\
# Serves `jointbench identify` and `jointbench gap` alike; sd is one sigma.
[bodies.m1]
mass = "{m1:.6g} kg"
mass_sd = "{m1_sd:.3g} kg"
channel = "a0"
points = ["1"]

[bodies.m2]
mass = "{m2:.6g} kg"
mass_sd = "{m2_sd:.3g} kg"
channel = "a1"
points = ["2"]

[links.ground]
between = ["ground", "m1"]
stiffness = "{k0:.6g} N/m"
stiffness_sd = "{k0_sd:.3g} N/m"
damping = "{c0:.6g} N s/m"
damping_sd = "{c0_sd:.3g} N s/m"

[links.joint]
between = ["m1", "m2"]
stiffness = "{kj:.6g} N/m"
stiffness_sd = "{kj_sd:.3g} N/m"
damping = "{cj:.6g} N s/m"
damping_sd = "{cj_sd:.3g} N s/m"
joint = true

[gap]
output = "acceleration"
preload_reference = "{preload:.6g} N"
"""
)


def model_text(design: CampaignDesign) -> str:
    """Write what an operator would know of the specimen of a design.

    Args:
        design: of a campaign; its true values stay out.

    Returns:
        TOML, as `jointbench.station.schemas.bench_model` reads it.
    """
    sds = {
        f"{name}_sd": NOMINAL_SIGMA[name] * value
        for name, value in design.nominal.items()
    }
    return TEMPLATE.format(**design.nominal, **sds, preload=design.preload_reference)


BLOCKS = """
# Marble on marble, ground: 55 GPa and 0.25 for either block. What the drawing states.
[bolted_joint]
link = "joint"
bolts = 4
diameter = "{diameter:g} mm"
area = "{area:g} cm^2"
nut_factor = 0.2
nut_factor_sd = "15 %"
torque_scatter = "4 %"
reassembly = "20 %"
head_diameter = "{head:g} mm"
clamped_length = "{clamped:g} mm"
bolt_length = "{long:g} mm"
bolt_radius = "{place:.4g} mm"
rocking_radius = "{rocking:.4g} mm"
modulus = "55 GPa"
modulus_sd = "3 %"
poisson = 0.25
hardness = "1.5 GPa"
"""


def blocks_text(design: CampaignDesign, surfaces: FaceDesign) -> str:
    """Write what an operator would know of two bolted blocks.

    Args:
        design: of the hits; its true values stay out.
        surfaces: sizes; waviness and true nut factor stay out.

    Returns:
        TOML with a table [bolted_joint].
    """
    return model_text(design) + joint_table(surfaces)


def joint_table(surfaces: FaceDesign) -> str:
    """Write what an operator would know of the joint between two blocks.

    Args:
        surfaces: sizes; waviness and true nut factor stay out.

    Returns:
        The table [bolted_joint].
    """
    mm = 1e3
    return BLOCKS.format(
        diameter=mm * surfaces.bolt_diameter,
        area=1e4 * surfaces.side**2,
        head=mm * surfaces.head_diameter,
        clamped=2 * mm * surfaces.thickness,
        long=mm * surfaces.bolt_length,
        place=mm * surfaces.bolt_place,
        rocking=mm * surfaces.side / 12**0.5,
    )
