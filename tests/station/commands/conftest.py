"""The example package, installed for one test."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from plugin_distributions import install_example


@pytest.fixture
def example(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Path]:
    """The example package, installed for one test."""
    folder = install_example(tmp_path_factory.mktemp("site"))
    monkeypatch.syspath_prepend(folder)
    yield folder
    for module in [m for m in sys.modules if m.startswith("jointbench_example")]:
        monkeypatch.delitem(sys.modules, module)
