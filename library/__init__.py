# SPDX-License-Identifier: MIT
"""Measure, identify and explain the joints of machines, from Python.

::

    import jointbench as jb

    session = jb.open("session.h5")
    modes = jb.modes(session)
    print(modes)                    # natural frequencies and damping with intervals
    modes.to_xarray()               # labelled arrays with units

Each function takes files or records and returns a record; nothing is printed, and
only `example`, `export_joint`, `record`, `process` and `report` write files. Errors are
those of `jointbench.acquisition.basics.errors`: one line with the cause and a remedy.
The functions load their modules at the first call, so that the import costs nothing.
"""

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jointbench.station.library.archives import archive, process
    from jointbench.station.library.assemblies import reassembly
    from jointbench.station.library.contact_laws import contact
    from jointbench.station.library.desks import desk
    from jointbench.station.library.example_files import example
    from jointbench.station.library.frf_results import frf
    from jointbench.station.library.gaps import gap
    from jointbench.station.library.hit_results import hits
    from jointbench.station.library.identified_joints import identify
    from jointbench.station.library.joint_agreements import agreement
    from jointbench.station.library.joint_designs import design
    from jointbench.station.library.joint_exports import export_joint
    from jointbench.station.library.joint_pressures import pressure
    from jointbench.station.library.machines import machine
    from jointbench.station.library.measurements import open_measurement as open  # noqa: A004
    from jointbench.station.library.measurements import record
    from jointbench.station.library.mode_results import modes
    from jointbench.station.library.session_pages import report
    from jointbench.station.library.surface_fits import surface

_PLACES = {
    "agreement": ("joint_agreements", "agreement"),
    "archive": ("archives", "archive"),
    "contact": ("contact_laws", "contact"),
    "design": ("joint_designs", "design"),
    "desk": ("desks", "desk"),
    "example": ("example_files", "example"),
    "export_joint": ("joint_exports", "export_joint"),
    "frf": ("frf_results", "frf"),
    "gap": ("gaps", "gap"),
    "hits": ("hit_results", "hits"),
    "identify": ("identified_joints", "identify"),
    "machine": ("machines", "machine"),
    "modes": ("mode_results", "modes"),
    "open": ("measurements", "open_measurement"),
    "pressure": ("joint_pressures", "pressure"),
    "process": ("archives", "process"),
    "reassembly": ("assemblies", "reassembly"),
    "record": ("measurements", "record"),
    "report": ("session_pages", "report"),
    "surface": ("surface_fits", "surface"),
}
__all__ = [
    "agreement",
    "archive",
    "contact",
    "design",
    "desk",
    "example",
    "export_joint",
    "frf",
    "gap",
    "hits",
    "identify",
    "machine",
    "modes",
    "open",
    "pressure",
    "process",
    "reassembly",
    "record",
    "report",
    "surface",
]

# In a source tree that an editable install points to, this folder is called `library`
# and the other packages of `jointbench` stand beside it.
if Path(__file__).parent.name == "library":
    __path__.append(str(Path(__file__).parent.parent))


def __getattr__(name: str) -> object:
    """Load a function of the library at its first use."""
    if name not in _PLACES:
        raise AttributeError(f"module 'jointbench' has no attribute {name!r}")
    module, attribute = _PLACES[name]
    found: object = getattr(
        import_module(f"jointbench.station.library.{module}"), attribute
    )
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    """List the functions of the library."""
    return sorted(_PLACES)
