# SPDX-License-Identifier: MIT
"""Settings of uncertain modal tables of bolted bodies."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class ModalTableSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    table_floor: float = numerical(
        0.001,
        "of the peak",
        "error of the modal table, as a share of the peak of a record and channel",
        "exact tables: above what is left of second-order aim, which is 0.03 %",
    )
    shape_floor: float = numerical(
        0.1,
        "of the sd",
        "floor as a multiple of the stated sd of the shapes of the modal table",
        "of the errors of a table those of first order are whitened",
    )
    free_rank: float = numerical(
        1e-8,
        "of the largest",
        "eigenvalue below which errors of residues depend on each other",
        "square root of rounding",
    )
    least_phase: float = numerical(
        0.01,
        "rad",
        "sd of the phase of a closed mode at the end of a record below which its "
        "frequency is no coordinate",
        "bodies that move as rigid ones on their feet: 1e-4",
    )
    close_mixing: float = numerical(
        0.05,
        "-",
        "sd of the share of a closed mode in another one above which their coupling "
        "is a coordinate where the modal table is uncertain",
        "what first order leaves is half of its square, 0.1 % of the residues",
    )
    least_pairs: int = numerical(
        2,
        "couplings",
        "fewest such coordinates, for the modes that mix most",
        "an effect brings other modes together than the nominal joint",
    )
    least_tuning: float = numerical(
        1e-9,
        "-",
        "least sd of a frequency or coupling of closed modes",
        "errors of a table reach no rigid motion: far below the width of any mode",
    )
    open_frequency: float = numerical(
        1e-3,
        "-",
        "sd of the logarithm of a closed frequency from which it shows how large the "
        "errors of a table are",
        "modes of rigid bodies on their joints have a hundredth of it",
    )
    largest_size: float = numerical(
        2.5,
        "of the stated sd",
        "most by which deviations of the base raise the sd of all frequencies",
        "tables are off by 0.2 to 1 %, so a middle value is half of the largest",
    )


MODAL_TABLE = ModalTableSettings()
