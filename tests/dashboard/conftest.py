"""Dashboards that are closed when their test is over, whatever it found."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from headless_dashboard import Dashboard


@pytest.fixture
def dashboard() -> Iterator[Dashboard]:
    """A dashboard of this test's own."""
    one = Dashboard()
    yield one
    one.close()
