"""A server for one test, whose document answers questions."""

from __future__ import annotations

from collections.abc import Iterator

import panel as pn
import pytest
from answering_server import Served


@pytest.fixture
def served(monkeypatch: pytest.MonkeyPatch) -> Iterator[Served]:
    """Yield a server for this test alone, whose page counts as drawn."""
    monkeypatch.setattr(type(pn.state), "loaded", property(lambda _: True))
    one = Served()
    yield one
    one.stop()
