"""Addresses for operators: `/liveness`, `/readiness` and `/metrics`."""

from __future__ import annotations

import ipaddress
import random

from tornado.web import HTTPError, RequestHandler

from ..monitoring.metrics import METRICS
from .limits import RETRY_AFTER
from .proxy_headers import UNKNOWN
from .rules import Rules


class Liveness(RequestHandler):
    """`/liveness`: answers while the event loop is running. Panel's own handler would make a page for each request."""

    def get(self) -> None:
        """Answer `{"/liveness": true}`."""
        self.write({"/liveness": True})


class Readiness(RequestHandler):
    """`/readiness`: whether another page can be opened. A full server is not a fault, so nothing is logged."""

    rules: Rules

    def get(self) -> None:
        """Answer `{"/readiness": true}`, or false with status 503 and the reason."""
        sessions = self.rules.sessions
        if not sessions.full:
            self.write({"/readiness": True})
            return
        self.set_status(503)
        self.set_header("Retry-After", random.randint(*RETRY_AFTER))
        self.write({"/readiness": False, "reason": f"all {sessions.most} places for sessions are taken"})


class MetricsHandler(RequestHandler):
    """`/metrics`: the text for Prometheus."""

    def get(self) -> None:
        """Answer requests from this machine and private networks with the metrics."""
        asking = ipaddress.ip_address(self.request.remote_ip or UNKNOWN)
        # `ipaddress` counts the unknown address as private, so it is refused explicitly
        if asking.is_unspecified or not asking.is_private:
            raise HTTPError(403, "metrics are for private addresses")
        self.set_header("Content-Type", "text/plain; version=0.0.4; charset=utf-8")
        self.write(METRICS.text())


#: The handlers by address; to add a health check, add a row.
HANDLERS: dict[str, type[RequestHandler]] = {"/liveness": Liveness, "/readiness": Readiness, "/metrics": MetricsHandler}
