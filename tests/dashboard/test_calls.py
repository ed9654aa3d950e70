"""A visitor who leaves."""

from __future__ import annotations

import pytest
from headless_dashboard import Dashboard

from app.serve.monitoring.metrics import METRICS


def test_a_visitor_who_leaves_ends_everything_although_one_end_fails(dashboard: Dashboard, caplog: pytest.LogCaptureFixture) -> None:
    ended: list[int] = []
    errors = METRICS.counted["errors"]
    for number in range(3):
        dashboard.on_close(lambda number=number: ended.append(number) if number != 1 else 1 / 0)  # type: ignore[misc]
    dashboard.close(None)
    assert ended == [0, 2] and METRICS.counted["errors"] == errors + 1
    assert "cleanup of a closed session failed" in caplog.text
