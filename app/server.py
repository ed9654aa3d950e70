"""The dashboard's own server."""

from __future__ import annotations

import contextlib
import gc
import ipaddress
import secrets
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import panel as pn
from bokeh.server.server import Server
from bokeh.settings import settings

from .curve.computation import CURVES_SHARED
from .dashboard.entry import open_web_page
from .dashboard.picture_work import PICTURES_SHARED
from .library_internals import check_releases
from .serve.compiling.compiler import COMPILER
from .serve.computing.shared import Shared
from .serve.computing.turns import TURNS
from .serve.computing.worker_pools import COMPUTING, POOLS
from .serve.http.guard import is_guarded
from .serve.http.health import HANDLERS
from .serve.http.limits import LARGEST_UPLOAD, USUAL_SESSIONS
from .serve.http.rules import Rules
from .serve.http.sessions import TOKEN_LIFETIME, Sessions
from .serve.monitoring import logs
from .serve.monitoring.metrics import METRICS, Metric
from .serve.monkeypatches.bokeh_defaults import install_defaults_cache
from .serve.monkeypatches.panel_resources import install_resources_cache
from .serve.monkeypatches.request_handlers import install_guards
from .session.session import Session

#: Largest message from a page: an uploaded file in base64 [bytes].
LARGEST_MESSAGE = 4 * LARGEST_UPLOAD // 3 + 100_000
#: Time for which a thread may keep the GIL from the event loop [s]. Answering one knob move acquires the GIL about ten
#: times, so with Python's default, 5 ms, the answer could wait 50 ms for a busy thread. The shorter time helps with 60
#: visitors, and makes no difference with 24 (docs/reliability.md, "Many visitors").
SWITCH_INTERVAL = 5e-4
#: Time until a silent connection is closed [s]; the head of a request must arrive within this time.
IDLE_TIME = 60
#: Time within which the body of a request must arrive [s].
BODY_TIME = 30
#: Largest request body [bytes]: only sign-in forms have a body.
LARGEST_BODY = 100_000
#: Time between two websocket pings, and time within which each must be answered [s].
PING_INTERVAL = 20
#: Time within which a loaded page must open its websocket [ms].
UNCONNECTED_MS = 30_000
#: Time between two checks for sessions that have ended [ms].
SESSION_CHECK_MS = 1000


@dataclass(frozen=True)
class Access:
    """Who may use the server, by default only this machine; docs/security.md explains each field.

    `secret` signs sessions; without it a server makes a random one. `origins` are the names under which browsers reach
    the server (`HOST` or `HOST:PORT`), `sign_in` the keyword arguments of Panel's `serve` for basic authentication or
    OAuth. Behind a `proxy`, the visitor's address is in a header, which is `proxy_header` if that is not empty.
    """

    origins: tuple[str, ...] = ()
    secret: bytes | None = field(default=None, repr=False)
    max_sessions: int = USUAL_SESSIONS
    embedding: tuple[str, ...] = ()
    proxy: bool = False
    sign_in: tuple[tuple[str, str], ...] = field(default=(), repr=False)
    proxy_header: str = ""


def is_loopback(address: str) -> bool:
    """Return whether a server at this address can be reached only from this machine."""
    if address == "localhost":
        return True
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False


def serve(port: int = 5006, address: str = "127.0.0.1", access: Access | None = None, log_level: str = "warning",
          on_ready_to_listen: Callable[[], None] = lambda: None) -> None:
    """Serve the page until interrupted; `/liveness` answers health checks.

    Raises `OSError` if the port is taken, and `MissingPart` if an installed library lacks a part that is needed.
    `on_ready_to_listen` is called after all imports, just before the server takes the port.
    """
    logs.configure(log_level)
    check_releases()
    on_ready_to_listen()
    server = server_at(port, address, access)
    shown = "localhost" if address in ("0.0.0.0", "127.0.0.1", "") else _in_url(address)
    print(f"granchain is at http://{shown}:{port}/ (stop it with Ctrl+C)", flush=True)
    COMPILER.prepare(Session().scene)
    settings.perform_document_validation.set_value(False)  # 40 ms for each page; the tests find such errors
    if hasattr(settings, "perform_error_diagnostics"):  # since 3.9; Panel asks for a missing name at each change
        settings.perform_error_diagnostics.set_value(False)
    install_defaults_cache()
    install_resources_cache()
    sys.setswitchinterval(SWITCH_INTERVAL)
    gc.freeze()  # garbage collection then skips the objects that all pages share, and no longer takes 120 ms
    gc.enable()  # app/cli/serve.py has disabled it before its imports
    server.start()
    server.io_loop.spawn_callback(METRICS.watch)
    # Runs until a signal ends the process (app/cli/ending.py). Bokeh's `run_until_shutdown` would wait for its threads.
    server.io_loop.start()


def server_at(port: int, address: str, access: Access | None = None) -> Server:
    """Return a server that listens but does not run yet."""
    access = access or Access()
    names = [*map(_as_browsers_write, access.origins),
             *(f"{host}:{port}" for host in ("localhost", "127.0.0.1", _in_url(address)) if host)]
    hosts = frozenset(_name_of(origin) for origin in names)
    secret = access.secret or secrets.token_bytes(32)
    rules = Rules(hosts, Sessions(access.max_sessions), access.embedding, secret, frozenset(filter(_is_ipv6, names)),
                  access.proxy, access.proxy_header)
    server = rules.sessions.server = pn.serve(
        {"/": _guarded_web_page}, port=port, address=address, start=False, show=False, title="granchain",
        location=False, verbose=False, websocket_origin=[name for name in names if not _is_ipv6(name)],
        websocket_max_message_size=LARGEST_MESSAGE,
        extra_patterns=list(HANDLERS.items()),
        http_server_kwargs={"idle_connection_timeout": IDLE_TIME, "body_timeout": BODY_TIME,
                            "max_body_size": LARGEST_BODY},
        websocket_ping_interval=PING_INTERVAL, websocket_ping_timeout=PING_INTERVAL,
        unused_session_lifetime_milliseconds=UNCONNECTED_MS, check_unused_sessions_milliseconds=SESSION_CHECK_MS,
        session_token_expiration=TOKEN_LIFETIME,
        sign_sessions=True, secret_key=secret, log_function=logs.log_request, **install_guards(rules),
        **dict(access.sign_in))
    add_shared_metrics()
    return server


def _guarded_web_page() -> None:
    """Open the web page. Fail if its request had no guard: then the promises of docs/security.md do not hold."""
    if not is_guarded():
        raise RuntimeError("a request reached the page without a check")
    open_web_page()


def add_shared_metrics() -> None:
    """Add the turns, worker pools and caches of all sessions to `/metrics`."""
    METRICS.turn_wait = lambda: TURNS.wait
    shared: dict[str, Shared[Any]] = {"picture": PICTURES_SHARED, "curve": CURVES_SHARED}

    def queued() -> dict[str, float]:
        return {pool.name: pool.queued + pool.held for pool in POOLS}

    def busy() -> dict[str, float]:
        return {pool.name: pool.busy_threads for pool in POOLS}

    METRICS.added = (
        Metric("computing", "gauge", "Computations that have a turn, and work under way in the worker pools "
                                     f"{', '.join(pool.name for pool in COMPUTING)}.",
               lambda: TURNS.running + sum(pool.busy_threads for pool in COMPUTING)),
        Metric("turns_waiting", "gauge",
               "Computations waiting for a turn; each also keeps a thread of its pool busy.", lambda: TURNS.waiting),
        Metric("pool_queued", "gauge", "Work waiting for a thread of the worker pool or for its owner's share.",
               queued, "pool"),
        Metric("pool_busy_threads", "gauge", "Threads of the worker pool that have work, even if it waits for a turn "
                                             "or another pool.", busy, "pool"),
        Metric("queue", "gauge", "The sum of `granchain_pool_queued` and `granchain_turns_waiting`; kept for older "
                                 "Grafana panels.", lambda: TURNS.waiting + sum(queued().values())),
        *(metric for name, cache in shared.items() for metric in (
            Metric(f"{name}_cache_hits_total", "counter", f"Requests for a {name} that was cached or already "
                                                                  "being computed.",
                   partial(getattr, cache, "hits")),
            Metric(f"{name}_cache_misses_total", "counter", f"Requests for a {name} that had to be computed.",
                   partial(getattr, cache, "misses")),
            Metric(f"{name}_cache_bytes", "gauge", f"Memory of the {name}s that are kept.",
                   partial(getattr, cache, "used")))))


def _in_url(address: str) -> str:
    """Return an address as a URL has it: IPv6 in brackets."""
    return f"[{address}]" if ":" in address else address


def _is_ipv6(origin: str) -> bool:
    return origin.startswith("[")


def _as_browsers_write(origin: str) -> str:
    """Return the origin in lower case, an IPv6 address in its shortest form; no browser's origin matches others."""
    origin = origin.lower()
    address, bracket, port = origin[1:].partition("]")
    if not _is_ipv6(origin) or not bracket:
        return origin
    with contextlib.suppress(ValueError):  # a pattern is not an address
        address = ipaddress.ip_address(address).compressed
    return f"[{address}]{port}"


def _name_of(origin: str) -> str:
    """Return the host in HOST, HOST:PORT or [IPv6]:PORT, without brackets."""
    name = origin.lower().rpartition("://")[2]
    return name[1:].partition("]")[0] if name.startswith("[") else name.partition(":")[0]
