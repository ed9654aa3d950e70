"""The guard of a websocket: whose it is, how many frames come, and which messages reach Bokeh.

docs/libraries.md lists the behaviour of Tornado and Bokeh that it relies on; where a release behaves otherwise, the
first message closes the connection.
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

from ..document.leaving import leave
from ..document.part_messages import dispatch
from ..monitoring.metrics import METRICS
from .frames import FrameBucket
from .guard import Guard
from .message_rules import LARGEST_HEADER, RefusedMessage, checked_content

log = logging.getLogger("granchain.requests")

#: Status of a websocket that is closed because of what the client did (RFC 6455, section 7.4.1).
_POLICY_VIOLATION = 1008
#: Most that waits until the client reads it when another message is written [bytes]: two pictures of the longest chain,
#: with the most rows, are in transit to a slow browser and are just below it. Other chains need a hundredth.
MOST_UNREAD = 64_000_000


class GuardedSocket(Guard):
    """The guard of a websocket: one connection for a session, not too many frames, only messages of pages."""

    #: Whether the frames that come are counted.
    _counted = False
    #: Fragments of a message that is not whole yet, as Bokeh calls them: header, metadata and content.
    _fragments: tuple[str, ...] = ()
    _refused = False
    _left = False
    #: What was written and waits until the client reads it [bytes].
    _unread = 0
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
        self._offered = session

    def admit(self) -> None:
        """Refuse a connection whose session Bokeh would make anew where there is no place for it."""
        super().admit()
        if not self.rules.sessions.has_place(self._offered):
            self.refuse_session()

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
        """The stream of the websocket. Too many frames from the client close it, and too much that it does not read.

        Bytes count as unread until the system has taken them. Answers to pings count, too.
        """
        stream: IOStream = super().detach()
        read, write, bucket = stream.read_bytes, stream.write, FrameBucket(time.monotonic())

        async def read_and_count(*args: Any, **kwargs: Any) -> bytes:
            data = await read(*args, **kwargs)
            self._counted = True
            if not bucket.pay(data, time.monotonic()):
                self._refuse("too many frames")
                raise StreamClosedError
            return data

        def write_and_count(data: bytes | memoryview) -> Future[None]:
            if self._unread > MOST_UNREAD:
                self._refuse("too much that is not read")
                stream.close()  # a closing frame would wait behind all that
                unwritten: Future[None] = Future()
                unwritten.set_exception(StreamClosedError())
                unwritten.exception()  # retrieved: who writes need not wait for it
                return unwritten
            written = write(data)
            if not written.done():
                self._unread += len(data)
                written.add_done_callback(lambda _: self._was_read(len(data)))
            return written

        stream.read_bytes = read_and_count  # type: ignore[method-assign]
        stream.write = write_and_count  # type: ignore[method-assign]
        return stream

    def _was_read(self, length: int) -> None:
        self._unread -= length

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
        self.close(_POLICY_VIOLATION, reason)  # type: ignore[attr-defined]

    def on_close(self) -> None:
        """The visitor left: the page's computations end, and Bokeh drops the session at its next check.

        Tornado calls this twice if the closing frame of a refused page arrives before its stream ends.
        """
        if self._left:
            return
        self._left = True
        session = self.session
        try:
            super().on_close()  # type: ignore[misc]
        except AssertionError:  # Bokeh expects a session, which may have been discarded meanwhile
            self.application.client_lost(self.connection)  # type: ignore[attr-defined]
        if session is not None:
            leave(session)

    def write_message(self, message: Any, *args: Any, **kwargs: Any) -> Any:
        """Send errors with the request's id in place of a traceback."""
        return super().write_message(self._without_traceback(message), *args, **kwargs)  # type: ignore[misc]

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
