"""Dashboards that are closed after their test, whether or not it passes."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from headless_dashboard import Dashboard


@pytest.fixture
def dashboard() -> Iterator[Dashboard]:
    """Yield a dashboard for this test alone."""
    one = Dashboard()
    yield one
    one.close()
