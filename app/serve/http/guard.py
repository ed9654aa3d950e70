"""Request guard: checks host, session and the number of sessions, and adds security headers.

docs/security.md has the promises. The handlers of Bokeh, Panel and Tornado are not changed: a class derived from each
of them checks a request first (`app/serve/monkeypatches/request_handlers.py`).
"""

from __future__ import annotations

import logging
import random
import re
import secrets
from contextvars import ContextVar
from typing import Any, NoReturn

from tornado.web import HTTPError, RequestHandler, StaticFileHandler
from tornado.websocket import WebSocketHandler

from ...library_internals import Internal, internals
from ..monitoring.metrics import METRICS
from .health import HANDLERS
from .limits import RETRY_AFTER
from .proxy_headers import read_proxy_headers
from .rules import Rules

log = logging.getLogger("granchain.requests")

try:
    from bokeh.server.views.session_handler import SessionHandler
except ImportError:  # see `_opens_session`
    SessionHandler = None

#: The undocumented parts of Bokeh that are used here.
INTERNALS = internals(
    __name__,
    Internal("bokeh.server.views.session_handler", ("SessionHandler",),
             "a server that has reached its largest number of sessions also refuses to sign visitors in or out"),
)

#: Bokeh's addresses that our page does not use; the first would make a session. The dot matches any character, as in
#: Bokeh's pattern, so that every address accepted by Bokeh's route is refused.
_UNUSED_ADDRESSES = re.compile(r"/(autoload.js|metadata)/?")
#: Whether the request being answered has passed a guard. A page is made in the context of its request.
_IS_GUARDED: ContextVar[bool] = ContextVar("is_guarded", default=False)


class Guard(RequestHandler):
    """A mixin that checks a request before the handler does anything; `Guards` sets `rules`."""

    rules: Rules
    request_id = ""

    def set_default_headers(self) -> None:
        """Set the headers of `Rules` and the request's id."""
        super().set_default_headers()
        self.request_id = self.request_id or secrets.token_hex(6)
        for name, value in self.rules.headers().items():
            self.set_header(name, value)
        self.set_header("X-Request-Id", self.request_id)

    async def prepare(self) -> None:
        """Refuse a request that is not allowed, or let the handler prepare its answer."""
        if self.rules.proxy:
            read_proxy_headers(self.request, self.rules.proxy_header)
        self.check_request()
        self.admit()
        _IS_GUARDED.set(True)
        pending = super().prepare()
        if pending is not None:
            await pending

    def check_request(self) -> None:
        """Raise `HTTPError` if the request is not allowed."""
        if not self.rules.serves(self.request.host_name):
            raise HTTPError(421, "host %r is not served", self.request.host_name[:80])
        if any(name in self.request.arguments for name in ("bokeh-session-id", "bokeh-token")) \
                or "Bokeh-Session-Id" in self.request.headers:
            raise HTTPError(403, "a client-supplied session id")
        if _UNUSED_ADDRESSES.fullmatch(self.request.path):
            raise HTTPError(404)

    def admit(self) -> None:
        """Make room for the session of a request that opens a page, or refuse the request."""
        if _opens_session(self) and not self.rules.sessions.make_room():
            self.refuse_session()

    def refuse_session(self) -> NoReturn:
        """Refuse a request, because all places for sessions are taken."""
        METRICS.count("refused_sessions")
        raise HTTPError(503, "there are %d sessions", self.rules.sessions.most)

    def write_error(self, status_code: int, **_: Any) -> None:
        """Answer with a message for the visitor; the log has the details under the same id."""
        self.set_header("Content-Type", "text/plain; charset=UTF-8")
        sentences = {404: "There is no such page.", 403: "This is not allowed.", 421: "This host is not served here.",
                     503: "All places of this server are taken; please try again in a minute.",
                     500: "Something went wrong inside granchain."}
        sentence = f"{sentences.get(status_code, 'The request cannot be answered.')} (request {self.request_id})\n"
        if status_code == 503:
            seconds = random.randint(*RETRY_AFTER)  # so that waiting pages do not all return at once
            self.set_header("Retry-After", seconds)
            if self.request.path == "/":
                self.set_header("Content-Type", "text/html; charset=UTF-8")
                sentence = (f'<!doctype html><html lang="en"><title>granchain</title><meta http-equiv="refresh" '
                            f'content="{seconds}"><p>{sentence}<p>This page tries again automatically.\n')
        self.finish(sentence)

    def log_exception(self, typ: Any, value: Any, tb: Any) -> None:
        """Write the error to the log, with the request's id."""
        words = {"request": self.request_id, "path": self.request.path[:200], "remote": self.request.remote_ip}
        if isinstance(value, HTTPError):
            log.warning("refused: %s", value, extra=words)
        else:
            METRICS.count("errors")
            log.error("request failed", exc_info=(typ, value, tb), extra=words)


def _opens_session(handler: RequestHandler) -> bool:
    """Return whether a request may open a page. Without Bokeh's class of such handlers, any unknown handler may."""
    if SessionHandler is not None:
        return isinstance(handler, SessionHandler)
    return not isinstance(handler, (StaticFileHandler, WebSocketHandler, *HANDLERS.values()))


def is_guarded() -> bool:
    """Return whether the request being answered has passed a guard."""
    return _IS_GUARDED.get()
