"""Linear algebra of the gap tests in one thread, as in a diagnosis."""

from collections.abc import Iterator

import pytest

from jointbench.acquisition.basics.one_thread import one_thread


@pytest.fixture(scope="module", autouse=True)
def in_one_thread() -> Iterator[None]:
    """Prevent small matrices from waiting for a second thread, which costs CPU time."""
    with one_thread():
        yield
