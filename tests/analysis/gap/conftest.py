"""One thread for the gap tests, as in a diagnosis, and a diagnosis they share."""

from collections.abc import Iterator

import gap_bench as made
import pytest

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.catalogue.linear_effects import LINEAR
from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis


@pytest.fixture(scope="module", autouse=True)
def in_one_thread() -> Iterator[None]:
    """Prevent small matrices from waiting for a second thread, which costs CPU time."""
    with one_thread():
        yield


@pytest.fixture(scope="session")
def late_campaign() -> Campaign:
    """Hits with a hidden delay of 40 microseconds in the channel a1."""
    return made.made_campaign([("delay", "channel:a1", [4e-5])])


@pytest.fixture(scope="session")
def late(late_campaign: Campaign) -> Diagnosis:
    """Return the diagnosis of the hidden delay by the linear effects."""
    with one_thread():
        return diagnose(late_campaign, entries=LINEAR)
