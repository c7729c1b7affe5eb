# SPDX-License-Identifier: MIT
"""One look at a recording whose samples are in a file.

The stages of the chain go through all recordings one after the other; each would unpack
the samples again. What they need of a recording besides its spectra is computed here at
one time, and remembered with the samples.
"""

from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.stored_samples import StoredSamples
from jointbench.signal.hits.find_hits import accepted_hits
from jointbench.signal.hits.hit_spectra import dead_channels
from jointbench.signal.hits.windows import choose_window, left_at_end
from jointbench.signal.kalman.oscillator_bank import has_dropouts
from jointbench.signal.kalman.smoothing import KalmanSettings, observe_noise


def survey(recording: Recording, kalman: KalmanSettings | None) -> None:
    """Compute what stages need of the samples of a recording, if they are in a file.

    Args:
        recording: with judged hits.
        kalman: settings of the Kalman stage, None where there is none.
    """
    if not isinstance(recording.samples, StoredSamples):
        return
    hits = accepted_hits(recording)
    if not hits:
        return
    for hit in hits:  # all of one hit together: its samples are unpacked once
        left_at_end(recording, hit)
        dead_channels(recording, hit)
    choose_window(recording)
    if kalman is not None:
        observe_noise(recording, kalman)
    has_dropouts(recording)
