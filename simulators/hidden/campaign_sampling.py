# SPDX-License-Identifier: MIT
"""Sampling of the records of a campaign, and the force noise."""

SAMPLE_RATE = 16384.0  # [Hz]
SAMPLES = 2048  # per record
PRETRIGGER = 128  # samples before the hit
FORCE_NOISE = 0.4  # force noise [N] per acceleration noise [m/s^2]
