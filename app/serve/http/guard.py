"""Request guard: checks host, session and the number of visitors, and adds security headers.

docs/security.md says what is promised. Bokeh's, Panel's and Tornado's handlers are kept; `guarded` derives a class from
each that checks a request first.
"""

from __future__ import annotations

import logging
import secrets
import time
from collections.abc import Awaitable, Iterable
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any

from bokeh.server.server import Server
from bokeh.server.views.session_handler import SessionHandler
from bokeh.server.views.ws import WSHandler
from bokeh.util.token import check_token_signature, get_session_id
from tornado.web import HTTPError, RequestHandler, StaticFileHandler

from ...needed import Needed
from ..document.part_messages import dispatch
from ..monitoring.metrics import METRICS
from .compressed import CompressedFiles
from .limits import USUAL_VISITORS
from .message_rules import LARGEST_HEADER, RefusedMessage, checked_content

log = logging.getLogger("granchain.requests")

_UNGUARDED = "requests would be answered without checks"
_NO_CONNECTION = "no page would get a connection"
_NO_PAGE = "visitors could not be counted, and no page would open"
_STAYS = "computations of a visitor who has left would go on"
#: What is used of Bokeh and Tornado beyond their documentation (`app/needed.py`). The promises of docs/security.md rest
#: on these rows, so all are required.
NEEDED = (
    Needed("bokeh.server.server.BaseServer", ("_tornado",), _UNGUARDED, required=True),
    Needed("bokeh.server.tornado.BokehTornado", ("websocket_origins",), "pages at an IPv6 address get no connection",
           required=True),
    Needed("tornado.web.Application", ("wildcard_router",), _UNGUARDED, required=True),
    Needed("bokeh.server.views.session_handler", ("SessionHandler",), _NO_PAGE, required=True),
    Needed("bokeh.server.views.ws", ("WSHandler",), "messages would not be checked", required=True),
    Needed("bokeh.util.token", ("get_session_id", "check_token_signature"), _NO_CONNECTION, required=True),
    Needed("bokeh.server.tornado.BokehTornado", ("secret_key",), _NO_CONNECTION, required=True),
    Needed("bokeh.server.views.session_handler.SessionHandler", ("application_context",), _NO_PAGE, required=True),
    Needed("bokeh.server.contexts.ApplicationContext", ("sessions",), _NO_PAGE, required=True),
    Needed("bokeh.server.views.ws.WSHandler", ("connection",), _STAYS, required=True),
    Needed("bokeh.server.views.ws.WSHandler", ("send_message",), "tracebacks would reach the browser", required=True),
    Needed("bokeh.server.connection.ServerConnection", ("session",), _STAYS, required=True),
    Needed("bokeh.server.session.ServerSession", ("request_expiration",), _STAYS, required=True),
)

#: Websocket frames that a visitor may send, over a long time [1/s]: the rate at which the token bucket of a connection
#: is filled. A drag sends 60 messages a second, and a message is three frames.
FRAME_RATE = 600.0
#: Frames that a visitor may send at once: what the bucket holds.
FRAME_BURST = 3000.0
#: Time in which a session's id is remembered, longer than Bokeh's tokens live [s].
_SESSIONS_REMEMBERED = 600.0


@dataclass
class Rules:
    """What is allowed: hosts (all if empty), most visitors at once, and the origins whose pages may embed this one."""

    hosts: frozenset[str] = frozenset()
    most_visitors: int = USUAL_VISITORS
    embedding: tuple[str, ...] = ()
    #: Ids of sessions that had their connection, and when [s].
    connected: dict[str, float] = field(default_factory=dict)

    def headers(self) -> dict[str, str]:
        """The headers of every answer.

        BokehJS makes functions of text, Panel loads modules from blobs, and both write style into the page: scripts and
        styles cannot be forbidden there. Nothing may come from or go to another host; 'self' covers websockets of the
        page's own origin.
        """
        ancestors = " ".join(("'self'", *self.embedding))
        found = {
            "Content-Security-Policy":
                "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:; "
                "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; "
                "connect-src 'self' blob: data:; worker-src 'self' blob:; object-src 'none'; base-uri 'self'; "
                f"form-action 'self'; frame-ancestors {ancestors}",
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "same-origin",
            "Server": "granchain",
        }
        return found if self.embedding else {**found, "X-Frame-Options": "SAMEORIGIN"}

    def serves(self, host: str) -> bool:
        """Whether requests for this host are answered; the names may have Bokeh's wildcards, such as *.example.org."""
        plain = host.lower().strip("[]")  # Tornado leaves the brackets of IPv6, which are a set of letters in a pattern
        return not self.hosts or any(fnmatchcase(plain, name) for name in self.hosts)

    def claim_connection(self, session: str) -> bool:
        """Give the session its one connection; False if it had one before."""
        now = time.monotonic()
        for old in [session_id for session_id, at in self.connected.items() if at < now - _SESSIONS_REMEMBERED]:
            del self.connected[old]
        first = session not in self.connected
        self.connected[session] = now
        return first


class Guard(RequestHandler):
    """Checks a request before the handler that it is mixed into; `rules` is set by `guarded`."""

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
        """Refuse a request that is for another server or not allowed."""
        self.check_request()
        looked = super().prepare()
        if looked is not None:
            await looked

    def check_request(self) -> None:
        """Raise `HTTPError` if the request is refused."""
        if not self.rules.serves(self.request.host_name):
            raise HTTPError(421, "host %r is not served", self.request.host_name[:80])
        if any(name in self.request.arguments for name in ("bokeh-session-id", "bokeh-token")) \
                or "Bokeh-Session-Id" in self.request.headers:
            raise HTTPError(403, "a session id of the client's own")
        if isinstance(self, SessionHandler) \
                and len(list(self.application_context.sessions)) >= self.rules.most_visitors:
            METRICS.count("refused_visitors")
            raise HTTPError(503, "there are %d visitors", self.rules.most_visitors)

    def write_error(self, status_code: int, **_: Any) -> None:
        """Answer with a line for the visitor; the log has the details under the same id."""
        self.set_header("Content-Type", "text/plain; charset=UTF-8")
        sentences = {404: "There is no such page.", 403: "This is not allowed.", 421: "This host is not served here.",
                     503: "This server has as many visitors as it can serve; please try again in a minute.",
                     500: "Something went wrong inside granchain."}
        self.finish(f"{sentences.get(status_code, 'The request cannot be answered.')} (request {self.request_id})\n")

    def log_exception(self, typ: Any, value: Any, tb: Any) -> None:
        """Write the error to the log, with the request's id."""
        words = {"request": self.request_id, "path": self.request.path[:200], "remote": self.request.remote_ip}
        if isinstance(value, HTTPError):
            log.warning("refused: %s", value, extra=words)
        else:
            METRICS.count("errors")
            log.error("request failed", exc_info=(typ, value, tb), extra=words)


class GuardedSocket(Guard):
    """The guard of a websocket: one connection for a session, not too many messages, and only those that pages send.

    The rate of frames is limited by a token bucket.
    """

    _tokens = FRAME_BURST
    _refilled_at = 0.0
    #: Frames of a message that is not whole yet: header, metadata and content come one by one.
    _frames: tuple[str, ...] = ()
    _refused = False
    _left = False

    def check_request(self) -> None:
        """Also refuse a connection without a token of this server, or with one that was used before.

        Bokeh looks at the signature again, but only after the handshake.
        """
        super().check_request()
        offered = [word.strip() for word in self.request.headers.get("Sec-WebSocket-Protocol", "").split(",")]
        try:
            token, secret = offered[1], self.application.secret_key  # type: ignore[attr-defined]
            session = get_session_id(token) if check_token_signature(token, secret, signed=True) else None
        except Exception:  # a stranger may have written anything there
            session = None
        if session is None:
            raise HTTPError(403, "no token of ours")
        if not self.rules.claim_connection(session):
            raise HTTPError(403, "a second connection to one session")

    def on_message(self, fragment: str | bytes) -> Awaitable[None] | None:
        """Pass whole messages on, unless there are too many or one is not of a page; that closes the connection."""
        if self._refused:  # frames may still arrive after the connection was closed
            return None
        now = time.monotonic()
        self._tokens = min(FRAME_BURST, self._tokens + (now - self._refilled_at) * FRAME_RATE) - 1.0
        self._refilled_at = now
        try:
            if self._tokens < 0.0:
                raise RefusedMessage("too many messages")
            if not isinstance(fragment, str):
                raise RefusedMessage("binary data")
            self._frames = (*self._frames, fragment)
            if len(self._frames) < 3:
                if len(fragment) > LARGEST_HEADER:
                    raise RefusedMessage("too long a header")
                return None
            frames, self._frames = self._frames, ()
            content = checked_content(frames[0], frames[2])
        except RefusedMessage as reason:
            self._refuse(str(reason))
            return None
        return None if dispatch(getattr(self, "connection", None), content) else self._to_bokeh(frames)

    async def _to_bokeh(self, frames: tuple[str, ...]) -> None:
        for frame in frames:
            await super().on_message(frame)  # type: ignore[misc]

    def _refuse(self, reason: str) -> None:
        self._refused, self._frames = True, ()
        METRICS.count("refused_messages")
        log.warning("refused: %s", reason, extra={"request": self.request_id, "remote": self.request.remote_ip})
        self.close(1008, reason)  # type: ignore[attr-defined]

    def on_close(self) -> None:
        """The visitor left: Bokeh drops the session at its next check, which ends the page's computations.

        Tornado calls this twice if the closing frame of a refused page arrives before its stream ends.
        """
        if self._left:
            return
        self._left = True
        connection = self.connection  # type: ignore[attr-defined]
        session = None if connection is None else connection.session
        super().on_close()  # type: ignore[misc]
        if session is not None:
            session.request_expiration()

    async def send_message(self, message: Any) -> None:
        """Send errors with the request's id in place of a traceback."""
        if message.msgtype == "ERROR":
            METRICS.count("errors")
            log.error("message failed: %s", message.content["text"],
                      extra={"request": self.request_id, "remote": self.request.remote_ip})
            message.content = {"text": f"The message could not be handled (request {self.request_id}).",
                               "traceback": None}
        await super().send_message(message)  # type: ignore[misc]


def guarded(handler: type[RequestHandler], rules: Rules) -> type[RequestHandler]:
    """The handler class with a guard before it; a handler of files also sends them compressed."""
    guard = GuardedSocket if issubclass(handler, WSHandler) else Guard
    files = (CompressedFiles,) if issubclass(handler, StaticFileHandler) else ()
    return type(f"Guarded{handler.__name__}", (guard, *files, handler), {"rules": rules})


def guard_handlers(server: Server, rules: Rules, origins: Iterable[str] = ()) -> None:
    """Put a guard before every handler of the server, and allow `origins` that Bokeh's own option refuses: IPv6.

    Bokeh's handlers are not public. If a release keeps them elsewhere, this raises `AttributeError`, and the server
    does not start: it must not run without guards.
    """
    application = server._tornado
    application.websocket_origins.update(origins)
    for rule in application.wildcard_router.rules:
        if isinstance(rule.target, type) and issubclass(rule.target, RequestHandler):
            rule.target = guarded(rule.target, rules)
