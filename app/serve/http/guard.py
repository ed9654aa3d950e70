"""Request guard: checks host, session and the number of visitors, and adds security headers.

docs/security.md says what is promised. Bokeh's, Panel's and Tornado's handlers are kept; `guarded` derives a class from
each that checks a request first. Tornado asks the application for the handler of every request (its documented
`get_handler_delegate`), and there the guarded class takes the place of the other.
"""

from __future__ import annotations

import json
import logging
import random
import re
import secrets
import time
from collections.abc import Awaitable
from contextvars import ContextVar
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any, NoReturn
from urllib.parse import urlsplit

from bokeh.server.tornado import BokehTornado
from bokeh.util.token import check_token_signature, get_session_id
from tornado.iostream import IOStream, StreamClosedError
from tornado.web import Application, HTTPError, RequestHandler, StaticFileHandler
from tornado.websocket import WebSocketHandler

from ...needed import MissingPart, Needed
from ..document.leaving import leave
from ..document.part_messages import dispatch
from ..monitoring.metrics import METRICS, Liveness, MetricsHandler
from .compressed import CompressedFiles
from .frames import FrameBucket
from .limits import USUAL_VISITORS
from .message_rules import LARGEST_HEADER, RefusedMessage, checked_content
from .sessions import Sessions

log = logging.getLogger("granchain.requests")

try:
    from bokeh.server.views.session_handler import SessionHandler
except ImportError:  # see `_opens_page`
    SessionHandler = None

#: What is used of Bokeh beyond its documentation (`app/needed.py`).
NEEDED = (
    Needed("bokeh.server.views.session_handler", ("SessionHandler",),
           "a server with as many visitors as it may have also refuses to sign visitors in or out"),
)

#: Addresses of Bokeh's that our page does not use; the first would make a session. The dot is any letter in Bokeh's
#: pattern, too.
_UNUSED_ADDRESSES = re.compile(r"/(autoload.js|metadata)/?")
#: The name of the setting that has an application's `Rules`.
_SETTING = "granchain_rules"
#: After how long a page that was refused because there are too many tries again, at least and at most [s].
_TRY_AGAIN = (20, 60)
#: Whether the request that is being answered has passed a guard. A page is made in the context of its request.
_IS_GUARDED: ContextVar[bool] = ContextVar("is_guarded", default=False)


@dataclass(frozen=True)
class Rules:
    """What is allowed: hosts (all if empty), sessions, and the origins whose pages may embed this one."""

    hosts: frozenset[str] = frozenset()
    sessions: Sessions = field(default_factory=lambda: Sessions(USUAL_VISITORS))
    embedding: tuple[str, ...] = ()
    #: Signs sessions.
    secret: bytes = b""
    #: Origins that Bokeh's own option refuses: those at addresses of IPv6.
    origins: frozenset[str] = frozenset()
    #: The class with a guard for each class of handlers.
    handlers: dict[type[RequestHandler], type[RequestHandler]] = field(default_factory=dict)

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
        _IS_GUARDED.set(True)
        looked = super().prepare()
        if looked is not None:
            await looked

    def check_request(self) -> None:
        """Raise `HTTPError` if the request is refused."""
        if not self.rules.serves(self.request.host_name):
            raise HTTPError(421, "host %r is not served", self.request.host_name[:80])
        if any(name in self.request.arguments for name in ("bokeh-session-id", "bokeh-token")) \
                or "Bokeh-Session-Id" in self.request.headers:
            raise HTTPError(403, "a client-supplied session id")
        if _UNUSED_ADDRESSES.fullmatch(self.request.path):
            raise HTTPError(404)
        if _opens_page(self) and not self.rules.sessions.make_room():
            self.refuse_visitor()

    def refuse_visitor(self) -> NoReturn:
        """Refuse a request for which there is no place."""
        METRICS.count("refused_visitors")
        raise HTTPError(503, "there are %d visitors", self.rules.sessions.most)

    def write_error(self, status_code: int, **_: Any) -> None:
        """Answer with a line for the visitor; the log has the details under the same id."""
        self.set_header("Content-Type", "text/plain; charset=UTF-8")
        sentences = {404: "There is no such page.", 403: "This is not allowed.", 421: "This host is not served here.",
                     503: "This server has as many visitors as it can serve; please try again in a minute.",
                     500: "Something went wrong inside granchain."}
        sentence = f"{sentences.get(status_code, 'The request cannot be answered.')} (request {self.request_id})\n"
        if status_code == 503:
            seconds = random.randint(*_TRY_AGAIN)  # pages that wait do not all come back at once
            self.set_header("Retry-After", seconds)
            if self.request.path == "/":
                self.set_header("Content-Type", "text/html; charset=UTF-8")
                sentence = (f'<!doctype html><html lang="en"><title>granchain</title><meta http-equiv="refresh" '
                            f'content="{seconds}"><p>{sentence}<p>This page tries again by itself.\n')
        self.finish(sentence)

    def log_exception(self, typ: Any, value: Any, tb: Any) -> None:
        """Write the error to the log, with the request's id."""
        words = {"request": self.request_id, "path": self.request.path[:200], "remote": self.request.remote_ip}
        if isinstance(value, HTTPError):
            log.warning("refused: %s", value, extra=words)
        else:
            METRICS.count("errors")
            log.error("request failed", exc_info=(typ, value, tb), extra=words)


class GuardedSocket(Guard):
    """The guard of a websocket: one connection for a session, not too many frames, only messages of pages."""

    #: Whether the frames that come are counted.
    _counted = False
    #: Fragments of a message that is not whole yet, as Bokeh calls them: header, metadata and content.
    _fragments: tuple[str, ...] = ()
    _refused = False
    _left = False
    #: The session whose token came with the request, and the same once it has its connection.
    _offered = _session_id = ""
    _has_connection = False

    def check_request(self) -> None:
        """Also refuse a connection without a token of this server, or with one that was used before.

        Bokeh looks at the signature again, but only after the handshake.
        """
        super().check_request()
        offered = [word.strip() for word in self.request.headers.get("Sec-WebSocket-Protocol", "").split(",")]
        try:
            token, secret = offered[1], self.rules.secret
            session = get_session_id(token) if check_token_signature(token, secret, signed=True) else None
        except Exception:  # a stranger may have written anything there
            session = None
        if session is None:
            raise HTTPError(403, "no token of ours")
        if not self.rules.sessions.has_place(session):
            self.refuse_visitor()
        self._offered = session

    def select_subprotocol(self, subprotocols: list[str]) -> str | None:
        """Give the session its one connection: origin and headers of the handshake have been checked by now.

        Given before, a request that becomes no connection would take it from the page. Raises `HTTPError`.
        """
        if not self.rules.sessions.claim_connection(self._offered):
            raise HTTPError(403, "a second connection to one session, or a page that has lost its place")
        self._session_id, self._has_connection = self._offered, True
        return super().select_subprotocol(subprotocols)  # type: ignore[misc]

    def check_origin(self, origin: str) -> bool:
        """Whether pages of this origin may connect."""
        return urlsplit(origin).netloc.lower() in self.rules.origins \
            or bool(super().check_origin(origin))  # type: ignore[misc]

    @property
    def session(self) -> Any:
        """Bokeh's session of this connection; None before the handshake, and when Bokeh has dropped it."""
        return self.rules.sessions.find(self._session_id) if self._session_id else None

    def detach(self) -> IOStream:
        """The stream from which Tornado reads frames; they are counted, and too many close the connection."""
        stream: IOStream = super().detach()
        read, bucket = stream.read_bytes, FrameBucket(time.monotonic())

        async def read_and_count(*words: Any, **named: Any) -> bytes:
            data = await read(*words, **named)
            self._counted = True
            if not bucket.pay(data, time.monotonic()):
                self._refuse("too many frames")
                raise StreamClosedError
            return data

        stream.read_bytes = read_and_count  # type: ignore[method-assign]
        return stream

    def on_message(self, fragment: str | bytes) -> Awaitable[None] | None:
        """Pass whole messages on, unless one is not of a page; that closes the connection."""
        if self._refused:  # fragments may still arrive after the connection was closed
            return None
        try:
            if not self._counted:
                raise RefusedMessage("frames that were not counted")
            if not self._has_connection:
                raise RefusedMessage("a connection that no session was given")
            if not isinstance(fragment, str):
                raise RefusedMessage("binary data")
            self._fragments = (*self._fragments, fragment)
            if len(self._fragments) < 3:
                if len(fragment) > LARGEST_HEADER:
                    raise RefusedMessage("too long a header")
                return None
            fragments, self._fragments = self._fragments, ()
            content = checked_content(fragments[0], fragments[2])
        except RefusedMessage as reason:
            self._refuse(str(reason))
            return None
        return None if dispatch(self.session, content) else self._to_bokeh(fragments)

    async def _to_bokeh(self, fragments: tuple[str, ...]) -> None:
        for fragment in fragments:
            await super().on_message(fragment)  # type: ignore[misc]

    def _refuse(self, reason: str) -> None:
        if self._refused:
            return
        self._refused, self._fragments = True, ()
        METRICS.count("refused_messages")
        log.warning("refused: %s", reason, extra={"request": self.request_id, "remote": self.request.remote_ip})
        self.close(1008, reason)  # type: ignore[attr-defined]

    def on_close(self) -> None:
        """The visitor left: the page's computations end, and Bokeh drops the session at its next check.

        Tornado calls this twice if the closing frame of a refused page arrives before its stream ends.
        """
        if self._left:
            return
        self._left = True
        session = self.session
        super().on_close()  # type: ignore[misc]
        if session is not None:
            leave(session)

    def write_message(self, message: Any, *words: Any, **named: Any) -> Any:
        """Send errors with the request's id in place of a traceback."""
        return super().write_message(self._without_traceback(message), *words, **named)  # type: ignore[misc]

    def _without_traceback(self, frame: Any) -> Any:
        """The frame; in place of the content of an error, the only one with the key `traceback`, another one."""
        if not isinstance(frame, str) or '"traceback"' not in frame:  # inside a text there are backslashes
            return frame
        content = json.loads(frame)
        if not isinstance(content, dict) or "traceback" not in content:
            return frame
        METRICS.count("errors")
        log.error("message failed: %s", content.get("text"),
                  extra={"request": self.request_id, "remote": self.request.remote_ip})
        return json.dumps({"text": f"The message could not be handled (request {self.request_id}).", "traceback": None})


class Readiness(RequestHandler):
    """`/readiness`: whether one more page can be opened."""

    rules: Rules

    def get(self) -> None:
        """Answer `{"/readiness": true}`, or status 503."""
        if self.rules.sessions.full:
            raise HTTPError(503, "there are %d visitors", self.rules.sessions.most)
        self.write({"/readiness": True})


def _opens_page(handler: RequestHandler) -> bool:
    """Whether a request may open a page; without Bokeh's class of such handlers, of all that are not known not to."""
    if SessionHandler is not None:
        return isinstance(handler, SessionHandler)
    return not isinstance(handler, (StaticFileHandler, WebSocketHandler, Liveness, MetricsHandler, Readiness))


def guarded(handler: type[RequestHandler], rules: Rules) -> type[RequestHandler]:
    """The handler class with a guard before it; a handler of files also sends them compressed."""
    if handler not in rules.handlers:
        guard = GuardedSocket if issubclass(handler, WebSocketHandler) else Guard
        files = (CompressedFiles,) if issubclass(handler, StaticFileHandler) else ()
        rules.handlers[handler] = type(f"Guarded{handler.__name__}", (guard, *files, handler), {"rules": rules})
    return rules.handlers[handler]


def is_guarded() -> bool:
    """Whether the request that is being answered has passed a guard."""
    return _IS_GUARDED.get()


def install_guards(rules: Rules) -> dict[str, Rules]:
    """Put a guard before every handler of Bokeh's servers in this process; returns the setting that turns it on.

    It replaces a method of `BokehTornado`, which does nothing for applications without the setting. Raises
    `MissingPart` where Tornado has no such method. Should a release have it and no longer use it, requests would have
    no guard, and `is_guarded` says so: a page of ours must not open then.
    """
    if not hasattr(Application, "get_handler_delegate"):
        raise MissingPart("tornado.web.Application.get_handler_delegate", "requests would be answered without checks")
    BokehTornado.get_handler_delegate = _guarded_delegate
    return {_SETTING: rules}


def _guarded_delegate(application: Application, request: Any, handler: type[RequestHandler], *words: Any,
                      **named: Any) -> Any:
    rules = application.settings.get(_SETTING)
    checked = handler if rules is None else guarded(handler, rules)
    return Application.get_handler_delegate(application, request, checked, *words, **named)
