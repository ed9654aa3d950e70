"""The server's log: JSON lines on standard error, with the id of the request or fault if there is one."""

from __future__ import annotations

import json
import logging
import sys
import time

from tornado.web import RequestHandler

from ...library_internals import Internal, internals

#: The undocumented parts of Bokeh that are used here.
INTERNALS = internals(
    __name__,
    Internal("bokeh.server.protocol_handler", ("log",),
             "messages that Bokeh cannot handle leave tracebacks in the log"),
)

#: Fields that a line may have in addition to time, level, logger and message.
_FIELDS = ("request", "path", "remote", "fault", "session", "link")


class JsonFormatter(logging.Formatter):
    """Writes a record as one line of JSON."""

    def format(self, record: logging.LogRecord) -> str:
        """Return time in UTC, level, logger, message, the fields of the request, fault or session, and the failure."""
        line = {"time": time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(record.created)) + f".{int(record.msecs):03d}Z",
                "level": record.levelname.lower(), "logger": record.name, "message": record.getMessage()}
        line.update((name, getattr(record, name)) for name in _FIELDS if hasattr(record, name))
        if record.exc_info:
            line["failure"] = self.formatException(record.exc_info)
        return json.dumps(line, ensure_ascii=False)


def only_when_debugging(_record: logging.LogRecord) -> bool:
    """Filter Bokeh's records of messages that it cannot handle, so that only --log-level debug logs them.

    The guard logs such a message in one line without a traceback, and a stranger can send any number of them.
    """
    return logging.getLogger().isEnabledFor(logging.DEBUG)


def log_request(handler: RequestHandler) -> None:
    """Log an answered request, only with --log-level debug; it replaces Tornado's own function.

    The guard has logged every request that was refused or has failed, with its id. In addition, a full server answers
    `/readiness` with 503 again and again, which is not a failure.
    """
    request = handler.request
    logging.getLogger("tornado.access").debug(
        "%d %s %s (%s) %.2f ms", handler.get_status(), request.method, request.path, request.remote_ip,
        1e3 * request.request_time())


def configure(level: str) -> None:
    """Write all records of this process from `level` on to standard error as JSON lines."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JsonFormatter())
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)
    for name in ("panel", "bokeh", "tornado"):
        library = logging.getLogger(name)
        library.handlers, library.propagate = [], True
        library.setLevel(logging.NOTSET if level == "debug" else max(logging.WARNING, getattr(logging, level.upper())))
    logging.getLogger("bokeh.server.protocol_handler").addFilter(only_when_debugging)
