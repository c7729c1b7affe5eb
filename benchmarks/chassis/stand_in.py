"""The simulated devices that take the names in NI's examples and tests."""

from jointbench.simulators.chassis.server import ChassisSetup

# PCIe-6363 as Dev1, an NI 9215 in cDAQ1, and two boards for PXIe-6368.
NAMES = ("Dev1", "cDAQ1Mod1", "PXI1Slot3", "PXI1Slot7")
MODULES = "6363,9215,6363,6363"


def stand_in(speed: float) -> ChassisSetup:
    """Return a set-up with a sine in the limits of each channel, as NI's simulation."""
    return ChassisSetup(
        bench=None, speed=speed, module=MODULES, names=NAMES, name="cDAQ1"
    )
