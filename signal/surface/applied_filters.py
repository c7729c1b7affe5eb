# SPDX-License-Identifier: MIT
"""Which of the filters that a file states were applied to its heights."""

from jointbench.acquisition.records.surfaces import Surface


def long_waves_removed(surface: Surface) -> bool:
    """Return whether lambda_c was applied to the heights.

    A file may state lambda_c next to a primary profile, which is not filtered by it:
    the cut-off counts where the export is called filtered or a treatment applied it.
    """
    for one in surface.provenance:
        detail = dict(one.detail)
        if one.name == "gaussian_filter" and float(detail["long_m"]) > 0:
            return True
        if one.name == "recognise" and "filtered" in str(detail.get("exported", "")):
            return True
    return False
