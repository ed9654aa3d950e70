"""Log lines about a session: its id, its link, and script errors in its browser."""

from __future__ import annotations

import json

import pytest
from headless_dashboard import Dashboard

from app.dashboard.sentences import LONGEST_SCRIPT_ERROR, MOST_SCRIPT_ERRORS
from app.serve.monitoring.faults import session_label
from app.serve.monitoring.logs import JsonFormatter
from granchain_core import ComputationError


def lines(caplog: pytest.LogCaptureFixture) -> list[dict[str, str]]:
    """Return the lines as the server writes them."""
    written = [JsonFormatter().format(record) for record in caplog.records if record.name == "granchain"]
    assert all("\n" not in line for line in written)
    return [json.loads(line) for line in written]


def test_the_line_of_a_fault_names_the_session_and_its_link(dashboard: Dashboard, caplog: pytest.LogCaptureFixture) -> None:
    dashboard.session.label = session_label("an id")
    dashboard.session.change("f", 615.0)
    dashboard.show_failure(ZeroDivisionError("1/0"))
    (line,) = lines(caplog)
    assert line["session"] == session_label("an id") and "an id" not in line["session"]
    assert line["link"] == dashboard.session.link and "f=615" in line["link"]
    assert f"(fault {line['fault']})" in dashboard.session.sentence


def test_a_fault_is_logged_even_if_the_session_has_no_link(dashboard: Dashboard, caplog: pytest.LogCaptureFixture) -> None:
    dashboard.session.speed = None  # type: ignore[assignment]
    dashboard.show_failure(ZeroDivisionError("1/0"))
    (line,) = lines(caplog)
    assert "link" not in line and line["fault"]


def test_a_failed_computation_has_one_id_on_the_page_and_in_the_log(dashboard: Dashboard,
                                                                    caplog: pytest.LogCaptureFixture) -> None:
    dashboard.show_failure(ComputationError("Bead 3 is not finite.", "not-finite"))
    (line,) = lines(caplog)
    assert line["level"] == "warning" and line["message"] == "computation failed: Bead 3 is not finite."
    assert dashboard.session.notice == f"Bead 3 is not finite. (fault {line['fault']})"
    assert "failure" not in line and line["link"] == dashboard.session.link


def test_an_error_of_a_script_is_one_short_line_and_there_are_few(dashboard: Dashboard,
                                                                  caplog: pytest.LogCaptureFixture) -> None:
    hostile = 'x is null\n{"level": "error"}' + "\u2028" * 10_000
    for _ in range(MOST_SCRIPT_ERRORS + 3):
        dashboard.receive({"do": "script-error", "what": hostile})
    found = lines(caplog)
    assert len(found) == MOST_SCRIPT_ERRORS
    assert found[0]["message"] == "script failed: " + json.dumps(hostile[:LONGEST_SCRIPT_ERROR])
    assert found[0]["level"] == "warning"


@pytest.mark.parametrize("what", [None, 3, ["x"], {"x": 1}])
def test_an_error_of_a_script_without_words_is_not_logged(what: object, dashboard: Dashboard,
                                                          caplog: pytest.LogCaptureFixture) -> None:
    dashboard.receive({"do": "script-error", "what": what})
    assert lines(caplog) == []
