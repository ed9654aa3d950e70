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
    """The rules of one server. They do not change; its `sessions` and its `unsent` bytes do."""

    #: Hosts that are served; all hosts if empty.
    hosts: frozenset[str] = frozenset()
    #: The sessions of the server, and their largest number.
    sessions: Sessions = field(default_factory=lambda: Sessions(USUAL_SESSIONS))
    #: Origins whose pages may embed the dashboard.
    embedding: tuple[str, ...] = ()
    #: The secret that signs sessions.
    secret: bytes = field(default=b"", repr=False)
    #: Origins at IPv6 addresses, which Bokeh's own option refuses, as browsers write them.
    origins: frozenset[str] = frozenset()
    #: Whether a proxy is in front of the server, and the header in which it names the visitor's address, if given.
    proxy: bool = False
    proxy_header: str = ""
    #: The bytes that wait to be sent, by websocket.
    unsent: UnsentBytes[Any] = field(default_factory=UnsentBytes)

    def headers(self) -> dict[str, str]:
        """The headers of every answer.

        BokehJS makes functions of text, Panel loads modules from blobs, and both write style into the page, so the
        policy has to allow these scripts and styles. No data may come from another host or go there; 'self' covers
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
        """Whether requests for this host are answered; the names may have Bokeh's wildcards, such as *.example.org."""
        plain = host.lower().strip("[]")  # in a pattern, the brackets of IPv6 would be a set of letters
        return not self.hosts or any(fnmatchcase(plain, name) for name in self.hosts)
