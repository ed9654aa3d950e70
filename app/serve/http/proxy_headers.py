"""The visitor's address and protocol behind a proxy.

With Tornado's `xheaders`, `X-Real-IP` takes precedence over `X-Forwarded-For`, and `X-Scheme` over `X-Forwarded-Proto`.
Behind a proxy that sets only the second of a pair, a client could then choose the first, and with it the address that
`/metrics` and the log see. So the server reads these headers itself and trusts no value that a client may have sent.
"""

from __future__ import annotations

from tornado.httputil import HTTPServerRequest
from tornado.netutil import is_valid_ip

from .limits import ADDRESS_HEADERS

#: Tornado's address of an unknown client, which `/metrics` refuses.
UNKNOWN = "0.0.0.0"


def read_proxy_headers(request: HTTPServerRequest, header: str = "") -> None:
    """Set the visitor's address and protocol of a request from the proxy's headers.

    Only the last entry of a header counts, which the nearest proxy has written; a client may have written the entries
    before it. If `header` is given, no other is read for the address. Otherwise, both are read if present: one of them
    may come from the client, so the address is unknown if they differ. A request with neither comes from the proxy's
    machine itself, not through the proxy.
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
