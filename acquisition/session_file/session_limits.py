# SPDX-License-Identifier: MIT
"""Limits of a session file: its samples are read in parts, so it may be long."""

from jointbench.acquisition.file_access.hdf5_guards import FileLimits

SESSION_LIMITS = FileLimits(unpacked_bytes=2**37, in_parts="samples", chunk_bytes=2**12)
"""A recording has a chunk for each block of 50 ms: 288,000 in four hours. The ratio of
the samples to the file stays limited."""
