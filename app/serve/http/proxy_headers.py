"""The visitor's address and protocol behind a proxy.

Tornado's `xheaders` lets `X-Real-IP` win over `X-Forwarded-For`, and `X-Scheme` over `X-Forwarded-Proto`. Behind a
proxy that sets only the second of two, a client could then choose the first, and with it the address that `/metrics`
and the log see. So the server reads these headers itself and believes no value that a client may have sent.
"""

from __future__ import annotations

from tornado.httputil import HTTPServerRequest
from tornado.netutil import is_valid_ip

from .limits import ADDRESS_HEADERS

#: Tornado's address of an unknown client, which `/metrics` refuses.
UNKNOWN = "0.0.0.0"


def read_proxy_headers(request: HTTPServerRequest, header: str = "") -> None:
    """Set the visitor's address and protocol of a request from the headers of the proxy.

    Only the last entry of a header counts, which the nearest proxy has written; a client may have written those before
    it. With a `header` no other is read. Without, both are read if they are there: one of them may be the client's own,
    so the address is unknown if they differ. A request without any comes from the proxy's own machine, not through it.
    """
    addresses = {_last(request, name) for name in ([header] if header else ADDRESS_HEADERS) if name in request.headers}
    if addresses:
        address = addresses.pop()
        request.remote_ip = address if not addresses and is_valid_ip(address) else UNKNOWN
    protocol = _last(request, "X-Forwarded-Proto")
    if protocol in ("http", "https"):
        request.protocol = protocol


def _last(request: HTTPServerRequest, name: str) -> str:
    return request.headers.get(name, "").rpartition(",")[2].strip()
