"""The sessions of a server: their number, and which of them have used their connection."""

from __future__ import annotations

import time
from typing import Any

from bokeh.protocol.exceptions import ProtocolError
from bokeh.server.server import Server

from ..connection.leaving import end_session

#: Time for which the token of a loaded web page is valid [s].
TOKEN_LIFETIME = 300
#: Time for which a connected session is remembered, so that its token cannot be used again [s]; longer than tokens are
#: valid.
_SESSIONS_REMEMBERED = 2.0 * TOKEN_LIFETIME


class Sessions:
    """The sessions of one server.

    A session is *loading* from the request for its web page until its websocket connects. A client that fetches web
    pages and never connects would soon take all places. Loading sessions therefore have at most half of the places, and
    the oldest of them makes room for a new one. A smaller share would evict visitors who arrive at the same moment.
    """

    def __init__(self, most: int) -> None:
        self.most = most
        self.most_loading = max(1, most // 2)
        #: The server; set before the first request.
        self.server: Server | None = None
        #: The time at which a session connected or was evicted [s], by id.
        self._claimed: dict[str, float] = {}

    @property
    def full(self) -> bool:
        """Whether no further session can be opened."""
        loading = len(self._loading())
        return len(self._present()) - loading + min(loading, self.most_loading - 1) >= self.most

    def find(self, session_id: str) -> Any:
        """Return Bokeh's session with this id, or None."""
        assert self.server is not None
        try:
            return self.server.get_session("/", session_id)
        except (ProtocolError, ValueError):
            return None

    def make_room(self) -> bool:
        """Make room for a page that is about to be loaded; return False if all places are taken."""
        if self.full:
            return False
        loading = self._loading()
        for session in loading[:max(0, len(loading) + 1 - self.most_loading)]:
            self._claimed[session.id] = time.monotonic()
            end_session(session)
        return True

    def claim_connection(self, session_id: str) -> bool:
        """Give the session its only connection; return False if it has had one before or has lost its place."""
        now = time.monotonic()
        present = {session.id for session in self._present()}
        oldest = now - _SESSIONS_REMEMBERED
        self._claimed = {known: claimed_at for known, claimed_at in self._claimed.items()
                         if claimed_at >= oldest or known in present}
        if session_id in self._claimed:
            return False
        self._claimed[session_id] = now
        return True

    def has_place(self, session_id: str) -> bool:
        """Return whether a session may connect. Bokeh remakes a dropped session from its token, which needs a place."""
        return len(self._present()) < self.most or self.find(session_id) is not None

    def _loading(self) -> list[Any]:
        """Return the sessions whose websocket has not connected yet."""
        return [session for session in self._present() if session.id not in self._claimed]

    def _present(self) -> list[Any]:
        """Return the sessions that Bokeh holds, oldest first, including closed sessions until Bokeh drops them."""
        assert self.server is not None
        return self.server.get_sessions()
