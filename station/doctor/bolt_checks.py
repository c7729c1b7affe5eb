# SPDX-License-Identifier: MIT
"""Sensors of the bolts and of the temperature, on a quiet bench."""

from collections.abc import Iterator, Sequence

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Channel
from jointbench.station.bolts.bolt_forces import forces_of, hit_temperature
from jointbench.station.doctor.bench_finding import BenchFinding, good, look
from jointbench.station.schemas.bolt_force_table import BoltForceTable

COLDEST, HOTTEST = -20.0, 60.0
"""Temperature of a bench between which nothing is looked at [degC]."""


def bolt_findings(
    tables: Sequence[BoltForceTable], channels: Sequence[Channel], samples: FloatArray
) -> Iterator[BenchFinding]:
    """Yield what each bolt with a sensor carries, and the temperature.

    Args:
        tables: of the plan.
        channels: of the stream.
        samples: of a quiet bench, SI units, shape (n_channels, n).
    """
    forces = forces_of(tables, channels, samples)
    for table in tables:
        name = f"bolt {table.bolt}"
        if table.bolt not in forces:
            words = "its elongation is typed in: 'set elongation_N_um 35.2'"
            yield good("bolts", name, words.replace("_N_", f"_{table.bolt}_"))
            continue
        force = forces[table.bolt]
        words = f"{force / 1e3:.3g} kN by {table.way} on {table.channel}"
        if force < 0.0:
            yield look(
                "bolts",
                name,
                f"{words}, a pressure is expected",
                "loosen the bolt and state its output as zero = '... V', or swap the "
                "wires",
            )
        else:
            yield good("bolts", name, words)
    found = hit_temperature(channels, samples)
    if found is not None and COLDEST <= found <= HOTTEST:
        yield good("bolts", "temperature", f"{found:.1f} degC")
    elif found is not None:
        yield look(
            "bolts",
            "temperature",
            f"{found:.1f} degC, no bench has that",
            "check sensor and sensitivity, for example '10 mV/degC'",
        )
