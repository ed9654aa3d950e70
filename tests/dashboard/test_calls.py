"""Errors in actions and parts, and a visitor who leaves."""

from __future__ import annotations

import logging
import re

import pytest
from bokeh.server.session import ServerSession
from event_loop import run_async
from headless_dashboard import Dashboard

from app.serve.document.part_messages import dispatch, register
from app.serve.monitoring.logs import JsonFormatter
from app.serve.monitoring.metrics import METRICS


def told_fault(dashboard: Dashboard, caplog: pytest.LogCaptureFixture) -> str:
    """Return the id of the fault that is shown to the visitor; the log has a line with it."""
    found = re.search(r"please report it[.] [(]fault ([0-9a-f]{12})[)]$", dashboard.session.sentence)
    assert found is not None, dashboard.session.sentence
    assert [record.__dict__["fault"] for record in caplog.records if record.levelno == logging.ERROR] == [found[1]]
    assert f'"fault": "{found[1]}"' in JsonFormatter().format(caplog.records[-1])
    return found[1]


def test_an_error_of_an_action_has_an_id_in_its_sentence_and_in_the_log(dashboard: Dashboard, caplog: pytest.LogCaptureFixture) -> None:
    dashboard._calls.call_and_report(lambda: 1 / 0)  # type: ignore[arg-type, return-value]
    first = told_fault(dashboard, caplog)
    caplog.clear()
    dashboard._calls.call_and_report(lambda: 1 / 0)  # type: ignore[arg-type, return-value]
    assert told_fault(dashboard, caplog) != first


class FailingPart:
    """A part of the page that fails before it has identified an action."""

    def hear(self, message: object) -> None:
        """Fail."""
        raise ZeroDivisionError


def test_an_error_of_a_part_is_shown_to_the_visitor(dashboard: Dashboard, caplog: pytest.LogCaptureFixture) -> None:
    session, part = ServerSession("tested", dashboard._document), FailingPart()  # type: ignore[arg-type]
    register(dashboard._document, "p-failing", part.hear)
    values = {"type": "map", "entries": [["model", {"id": "p-failing"}], ["data", {"type": "map", "entries": []}]]}
    event = {"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": {"type": "event", "name": "data_event", "values": values}}

    async def send() -> bool:
        return dispatch(session, {"events": [event]})

    assert run_async(send())
    told_fault(dashboard, caplog)


def test_the_end_of_a_session_ends_everything_although_one_step_fails(dashboard: Dashboard, caplog: pytest.LogCaptureFixture) -> None:
    ended: list[int] = []
    errors = METRICS.counted["errors"]
    for number in range(3):
        dashboard.on_close(lambda number=number: ended.append(number) if number != 1 else 1 / 0)  # type: ignore[misc]
    dashboard.close()
    assert ended == [0, 2] and METRICS.counted["errors"] == errors + 1
    assert "cleanup of a closed session failed" in caplog.text
