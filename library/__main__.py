# SPDX-License-Identifier: MIT
"""``python -m jointbench``: the command line without its script on the path."""

from jointbench.station.main import run

if __name__ == "__main__":
    run()
