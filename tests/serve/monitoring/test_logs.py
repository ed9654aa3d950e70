"""Lines of the server's log."""

from __future__ import annotations

import json
import logging
import time

from app.serve.monitoring.logs import JsonFormatter


def test_a_line_of_the_log_is_json_with_the_requests_id() -> None:
    record = logging.LogRecord("granchain", logging.WARNING, __file__, 1, "refused: %s", ("why",), None)
    record.request = "0123456789ab"
    line = json.loads(JsonFormatter().format(record))
    assert line["message"] == "refused: why" and line["request"] == "0123456789ab" and line["level"] == "warning"
    assert time.strptime(line["time"][:19], "%Y-%m-%dT%H:%M:%S")
