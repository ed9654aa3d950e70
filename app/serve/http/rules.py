"""The rules of a server: hosts and origins, sessions, and the headers of every answer."""

from __future__ import annotations

from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any

from .limits import USUAL_SESSIONS
from .sessions import Sessions
from .unsent import UnsentBytes


@dataclass(frozen=True)
class Rules:
    """The rules of one server, which do not change, with its `sessions` and `unsent` bytes, which do."""

    #: Hosts that are served; all hosts if empty.
    hosts: frozenset[str] = frozenset()
    #: The sessions of the server, which know their largest number.
    sessions: Sessions = field(default_factory=lambda: Sessions(USUAL_SESSIONS))
    #: Origins whose pages may embed the dashboard.
    embedding: tuple[str, ...] = ()
    #: The secret that signs sessions.
    secret: bytes = field(default=b"", repr=False)
    #: Origins at IPv6 addresses, as browsers write them; Bokeh's own option refuses them.
    origins: frozenset[str] = frozenset()
    #: Whether a proxy is in front of the server, and the header in which it passes the visitor's address, if given.
    proxy: bool = False
    proxy_header: str = ""
    #: The bytes waiting to be sent, by websocket.
    unsent: UnsentBytes[Any] = field(default_factory=UnsentBytes)

    def headers(self) -> dict[str, str]:
        """Return the headers of every answer.

        BokehJS makes functions from text, Panel loads modules from blobs, and both write styles into the page, so the
        policy must allow these scripts and styles. No data may come from or go to another host; 'self' covers
        websockets of the page's own origin.
        """
        ancestors = " ".join(("'self'", *self.embedding))
        sent = {
            "Content-Security-Policy":
                "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:; "
                "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; "
                "connect-src 'self' blob: data:; worker-src 'self' blob:; object-src 'none'; base-uri 'self'; "
                f"form-action 'self'; frame-ancestors {ancestors}",
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "same-origin",
            "Server": "granchain",
        }
        return sent if self.embedding else {**sent, "X-Frame-Options": "SAMEORIGIN"}

    def serves(self, host: str) -> bool:
        """Return whether requests for this host are answered; `hosts` may have Bokeh's wildcards (*.example.org)."""
        plain = host.lower().strip("[]")  # in a pattern, the brackets of IPv6 would be a character set
        return not self.hosts or any(fnmatchcase(plain, name) for name in self.hosts)
