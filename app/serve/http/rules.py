"""The rules of a server: hosts and origins, the number of sessions, and the headers of every answer."""

from __future__ import annotations

from dataclasses import dataclass, field
from fnmatch import fnmatchcase

from tornado.web import RequestHandler

from .limits import USUAL_SESSIONS
from .sessions import Sessions


@dataclass(frozen=True)
class Rules:
    """What is allowed: hosts (all if empty), sessions, and the origins whose pages may embed this one."""

    hosts: frozenset[str] = frozenset()
    sessions: Sessions = field(default_factory=lambda: Sessions(USUAL_SESSIONS))
    embedding: tuple[str, ...] = ()
    #: Signs sessions.
    secret: bytes = field(default=b"", repr=False)
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
