"""The sessions of a server: how many there may be, and which of them have had their connection."""

from __future__ import annotations

import time
from typing import Any

from bokeh.protocol.exceptions import ProtocolError
from bokeh.server.server import Server

from ..document.leaving import leave

#: For how long a page may open its connection with the token that it was loaded with [s].
TOKEN_LIFETIME = 300
#: For how long a connected session is remembered, so that its token cannot be used again: longer than it is valid [s].
_SESSIONS_REMEMBERED = 2.0 * TOKEN_LIFETIME


class Sessions:
    """The sessions of one server.

    A session is *loading* from the request of its page until its websocket connects. A client that fetches pages and
    never connects would soon have all places, so only half of them are for loading pages: the oldest of these makes
    room for a newer one. With fewer places for them, many who open the page in the same seconds would lose theirs.
    """

    def __init__(self, most: int) -> None:
        self.most = most
        self.most_loading = max(1, most // 2)
        #: Set when the server is there; requests come later.
        self.server: Server | None = None
        #: Ids of the sessions that have connected or were evicted, and when [s].
        self._claimed: dict[str, float] = {}

    @property
    def full(self) -> bool:
        """Whether no more page can be opened."""
        loading = len(self._loading())
        return len(self._present()) - loading + min(loading, self.most_loading - 1) >= self.most

    def find(self, session_id: str) -> Any:
        """Bokeh's session with this id; None if there is none."""
        assert self.server is not None
        try:
            return self.server.get_session("/", session_id)
        except (ProtocolError, ValueError):
            return None

    def make_room(self) -> bool:
        """Make room for a page that is about to be loaded; False if there is none."""
        if self.full:
            return False
        loading = self._loading()
        for session in loading[:max(0, len(loading) + 1 - self.most_loading)]:
            self._claimed[session.id] = time.monotonic()
            leave(session)
        return True

    def claim_connection(self, session_id: str) -> bool:
        """Give the session its one connection; False if it had one before, or has lost its place."""
        now = time.monotonic()
        present = {session.id for session in self._present()}
        for old in [one for one, at in self._claimed.items() if at < now - _SESSIONS_REMEMBERED and one not in present]:
            del self._claimed[old]
        if session_id in self._claimed:
            return False
        self._claimed[session_id] = now
        return True

    def has_place(self, session_id: str) -> bool:
        """Whether a session may connect: Bokeh makes a dropped one anew from its token, which needs a free place."""
        return len(self._present()) < self.most or self.find(session_id) is not None

    def _loading(self) -> list[Any]:
        """The sessions whose websocket has not connected yet."""
        return [session for session in self._present() if session.id not in self._claimed]

    def _present(self) -> list[Any]:
        """The sessions that Bokeh has, the oldest first; one that was left is among them until Bokeh drops it."""
        assert self.server is not None
        return self.server.get_sessions()
