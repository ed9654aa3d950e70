"""The guard of a websocket: its session, the rate of its frames, and the messages that reach Bokeh.

docs/libraries.md lists the behaviour of Tornado and Bokeh that the guard relies on. If a release behaves differently,
the first message closes the connection.
"""

from __future__ import annotations

import json
import logging
import time
from asyncio import Future
from collections.abc import Awaitable
from typing import Any
from urllib.parse import urlsplit

from bokeh.util.token import check_token_signature, get_session_id
from tornado.iostream import IOStream, StreamClosedError
from tornado.web import HTTPError

from ..connection.leaving import end_session
from ..document.part_messages import dispatch
from ..monitoring.faults import session_label
from ..monitoring.metrics import METRICS
from .frame_rate import FrameBucket
from .guard import Guard
from .message_rules import LARGEST_HEADER, RefusedMessage, checked_content

log = logging.getLogger("granchain.requests")

#: Status of a websocket closed because of the client's behaviour (RFC 6455, section 7.4.1).
_POLICY_VIOLATION = 1008
#: Largest number of unsent bytes when another message is written. Two pictures of the longest chain with the most rows,
#: in flight to a slow browser, have slightly fewer; other pictures have a hundredth of that.
MOST_UNSENT = 64_000_000
#: Largest number of unsent bytes of all pages together: several clients that read nothing must not fill the memory.
MOST_UNSENT_TOGETHER = 256_000_000


class GuardedSocket(Guard):
    """The guard of a websocket: one connection per session, a limited frame rate, and only messages that pages send."""

    #: Whether incoming frames are counted.
    _counted = False
    #: Fragments of an incomplete message: header, metadata and content, as Bokeh calls them.
    _fragments: tuple[str, ...] = ()
    _refused = False
    _left = False
    #: The stream, once frames are exchanged.
    _stream: IOStream | None = None
    #: The id of the session whose token was in the request, and the same id once the session has its connection.
    _offered_id = _session_id = ""
    _has_connection = False

    def check_request(self) -> None:
        """Also refuse a connection without a valid token of this server.

        Bokeh also checks the signature, but only after the handshake.
        """
        super().check_request()
        offered = [word.strip() for word in self.request.headers.get("Sec-WebSocket-Protocol", "").split(",")]
        try:
            token, secret = offered[1], self.rules.secret
            session_id = get_session_id(token) if check_token_signature(token, secret, signed=True) else None
        except Exception:  # a stranger may have sent anything
            session_id = None
        if session_id is None:
            raise HTTPError(403, "no token of this server")
        self._offered_id = session_id

    def admit(self) -> None:
        """Refuse a connection whose session was dropped if there is no place for a new one."""
        super().admit()
        if not self.rules.sessions.has_place(self._offered_id):
            self.refuse_session()

    def select_subprotocol(self, subprotocols: list[str]) -> str | None:
        """Give the session its only connection; raise `HTTPError` if the session has already had one.

        Tornado has checked the origin and headers of the handshake by now. If this came earlier, a failing request
        would use up the page's connection.
        """
        if not self.rules.sessions.claim_connection(self._offered_id):
            raise HTTPError(403, "a second connection to one session, or a page that has lost its place")
        self._session_id, self._has_connection = self._offered_id, True
        return super().select_subprotocol(subprotocols)  # type: ignore[misc]

    def check_origin(self, origin: str) -> bool:
        """Return whether pages of this origin may connect."""
        return urlsplit(origin).netloc.lower() in self.rules.origins \
            or bool(super().check_origin(origin))  # type: ignore[misc]

    @property
    def session(self) -> Any:
        """Bokeh's session of this connection; None before the handshake, and after Bokeh has dropped the session."""
        return self.rules.sessions.find(self._session_id) if self._session_id else None

    def detach(self) -> IOStream:
        """Return the websocket's stream, which is closed by too many frames or too many unsent bytes.

        Bytes count as unsent until the operating system has taken them, which it does as long as the client reads.
        Answers to pings also count. If all pages together have too many unsent bytes, the connection with the most is
        closed.
        """
        stream: IOStream = super().detach()
        self._stream, unsent = stream, self.rules.unsent
        read, write, bucket = stream.read_bytes, stream.write, FrameBucket(time.monotonic())

        async def read_and_count(*args: Any, **kwargs: Any) -> bytes:
            data = await read(*args, **kwargs)
            self._counted = True
            if not bucket.consume(data, time.monotonic()):
                self._refuse("too many frames")
                raise StreamClosedError
            return data

        def write_and_count(data: bytes | memoryview) -> Future[None]:
            if unsent.of(self) > MOST_UNSENT:
                self.drop("too many unsent bytes")
            elif unsent.total > MOST_UNSENT_TOGETHER:
                unsent.largest().drop("too many unsent bytes of all pages together")
            if stream.closed():
                unwritten: Future[None] = Future()
                unwritten.set_exception(StreamClosedError())
                unwritten.exception()  # mark it as retrieved: not every writer awaits the future
                return unwritten
            written = write(data)
            if not written.done():
                unsent.add(self, len(data))
                written.add_done_callback(lambda _: unsent.remove(self, len(data)))
            return written

        stream.read_bytes = read_and_count  # type: ignore[method-assign]
        stream.write = write_and_count  # type: ignore[method-assign]
        return stream

    def drop(self, reason: str) -> None:
        """Close the connection without waiting for a closing frame, which would be queued behind the unsent bytes."""
        self._refuse(reason)
        if self._stream is not None:
            self._stream.close()

    def on_message(self, fragment: str | bytes) -> Awaitable[None] | None:
        """Pass on whole messages, and close the connection after a message that no page sends."""
        if self._refused:  # fragments may still arrive after the closing frame
            return None
        try:
            if not self._counted:
                raise RefusedMessage("frames that were not counted")
            if not self._has_connection:
                raise RefusedMessage("a connection without a session")
            if not isinstance(fragment, str):
                raise RefusedMessage("binary data")
            self._fragments = (*self._fragments, fragment)
            if len(self._fragments) < 3:
                if len(fragment) > LARGEST_HEADER:
                    raise RefusedMessage("header too long")
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
        log.warning("refused: %s", reason, extra=self._log_fields())
        self.close(_POLICY_VIOLATION, reason)  # type: ignore[attr-defined]

    def _log_fields(self) -> dict[str, str]:
        """Return fields for a log line: the request's id, the visitor's address, and the session if there is one."""
        fields = {"request": self.request_id, "remote": str(self.request.remote_ip)}
        return {**fields, "session": session_label(self._session_id)} if self._session_id else fields

    def on_close(self) -> None:
        """End the page's computations because the visitor has left; Bokeh drops the session at its next check.

        Tornado calls this method twice if the closing frame of a refused page arrives before its stream ends.
        """
        if self._left:
            return
        self._left = True
        session = self.session
        try:
            super().on_close()  # type: ignore[misc]
        except AssertionError:  # Bokeh expects a session, but may have dropped it by now
            self.application.client_lost(self.connection)  # type: ignore[attr-defined]
        if session is not None:
            end_session(session)

    def write_message(self, message: Any, *args: Any, **kwargs: Any) -> Any:
        """Send a message; an error has the request's id instead of a traceback."""
        return super().write_message(self._without_traceback(message), *args, **kwargs)  # type: ignore[misc]

    def _without_traceback(self, frame: Any) -> Any:
        """Return the frame, without its traceback if it is the content of an error, which has the key `traceback`."""
        if not isinstance(frame, str) or '"traceback"' not in frame:  # inside a string, the quotes have backslashes
            return frame
        content = json.loads(frame)
        if not isinstance(content, dict) or "traceback" not in content:
            return frame
        METRICS.count("errors")
        log.error("message failed: %s", content.get("text"), extra=self._log_fields())
        return json.dumps({"text": f"The message could not be handled (request {self.request_id}).", "traceback": None})
