"""`granchain serve`: the dashboard."""

from __future__ import annotations

import argparse
import contextlib
import gc
import hmac
import logging
import os
import secrets
import stat
from collections.abc import Callable
from pathlib import Path

from granchain_core import BadInput

from ..former_names import names_of_option
from ..serve.http.limits import ADDRESS_HEADERS, MOST_SESSIONS, USUAL_SESSIONS
from .options import whole
from .waiting import Waiting

log = logging.getLogger("granchain")

LEVELS = ("debug", "info", "warning", "error")
#: Shortest secret [bytes].
_SHORTEST = 16
#: Environment variables that Panel reads if a provider is named, by the keyword of `serve`.
_OAUTH = {"oauth_key": "PANEL_OAUTH_KEY", "oauth_secret": "PANEL_OAUTH_SECRET",
          "oauth_redirect_uri": "PANEL_OAUTH_REDIRECT_URI", "oauth_encryption_key": "PANEL_OAUTH_ENCRYPTION"}


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `serve`."""
    parser.add_argument("--port", type=whole, default=5006, help="port to listen on (5006)")
    parser.add_argument("--address", default="127.0.0.1", help="address to listen on (127.0.0.1: this machine only)")
    parser.add_argument("--allow-websocket-origin", action="append", metavar="HOST",
                        help="a host name, with its port unless that is 80 or 443, under which browsers reach the "
                             "dashboard; repeat it for others; *.example.org is allowed")
    parser.add_argument("--secret-file", metavar="FILE",
                        help="a file whose content signs sessions; BOKEH_SECRET_KEY in the environment does the same")
    parser.add_argument("--generate-secret", action="store_true",
                        help="if no other secret is given, sign sessions with a random secret of this process")
    parser.add_argument("--allow-embedding", action="append", metavar="ORIGIN",
                        help="an origin, for example https://courses.example.org, whose pages may show the dashboard "
                             "in a frame")
    parser.add_argument(*names_of_option("--max-sessions"), type=whole, default=USUAL_SESSIONS, metavar="N",
                        help="sessions (open web pages) at once")
    parser.add_argument("--behind-proxy", action="store_true",
                        help="take the visitor's address from X-Real-IP or X-Forwarded-For, which a proxy sets; if "
                             "both are present and differ, the address is unknown")
    parser.add_argument("--proxy-header", choices=ADDRESS_HEADERS,
                        help="with --behind-proxy: take the address from this header alone")
    parser.add_argument("--basic-auth", metavar="FILE",
                        help="a JSON file of user names and passwords (Panel's basic_auth)")
    parser.add_argument("--oauth-provider", metavar="NAME",
                        help="sign in with a provider that Panel knows; PANEL_OAUTH_KEY and PANEL_OAUTH_SECRET "
                             "are read from the environment")
    parser.add_argument("--log-level", choices=LEVELS, default="warning", help="level of the log on standard error")


def do(arguments: argparse.Namespace) -> None:
    """Open the dashboard."""
    if not 0 <= arguments.port <= 65535:
        raise BadInput(f"port {arguments.port} is outside 0 to 65535; the usual one is 5006.")
    if not 1 <= arguments.max_sessions <= MOST_SESSIONS:
        raise BadInput(f"--max-sessions {arguments.max_sessions} is outside 1 to {MOST_SESSIONS}; the usual number "
                       f"is {USUAL_SESSIONS}.")
    if arguments.proxy_header and not arguments.behind_proxy:
        raise BadInput("--proxy-header is read with --behind-proxy only; add --behind-proxy.")
    with contextlib.closing(Waiting(arguments.address, arguments.port)) as waiting:
        _serve(arguments, waiting.close)


def _serve(arguments: argparse.Namespace, on_ready_to_listen: Callable[[], None]) -> None:
    """Import the dashboard and serve it; call `on_ready_to_listen` just before the server binds the port."""
    gc.disable()  # imports leave no garbage, and looking for it took a tenth of their time (`serve` enables it)
    from ..library_internals import MissingPart, missing_in_import

    try:
        from ..server import Access, is_loopback
        from ..server import serve as serve_dashboard
    except ImportError as problem:
        if lack := missing_in_import(problem):
            raise BadInput(str(lack)) from None
        raise

    secret = _secret(arguments)
    sign_in = _sign_in(arguments, secret)
    exposed = arguments.behind_proxy or not is_loopback(arguments.address)
    if exposed and not (arguments.allow_websocket_origin and secret):
        reached = "A server behind a proxy" if arguments.behind_proxy else f"The address {arguments.address}"
        raise BadInput(
            f"{reached} can be reached from other machines, so the server needs the names under "
            "which browsers reach it, and a secret that signs sessions: add --allow-websocket-origin "
            "HOST:PORT, and --generate-secret or --secret-file FILE (docs/security.md).")
    access = Access(tuple(arguments.allow_websocket_origin or ()), secret, arguments.max_sessions,
                    tuple(arguments.allow_embedding or ()), arguments.behind_proxy, tuple(sign_in.items()),
                    arguments.proxy_header or "")

    def ready() -> None:  # by then, the log has been set up
        if arguments.secret_file is not None and Path(arguments.secret_file).stat().st_mode & stat.S_IROTH:
            log.warning("all users of this machine can read the secret in %s; chmod o= closes it",
                        arguments.secret_file)
        if any(_covers_all_names(name) for name in access.origins):
            log.warning("--allow-websocket-origin with * for all names switches off the checks of hosts and origins: a "
                        "stranger's page can use a visitor's browser to reach this server; give the server's own names")
        on_ready_to_listen()

    try:
        serve_dashboard(arguments.port, arguments.address, access=access, log_level=arguments.log_level,
                        on_ready_to_listen=ready)
    except MissingPart as lack:
        raise BadInput(str(lack)) from None
    except OSError as problem:
        raise BadInput(f"Cannot listen on {arguments.address}:{arguments.port}: {problem.strerror or problem}; "
                       f"try --port {arguments.port + 1}.") from None


def _covers_all_names(origin: str) -> bool:
    """Return whether an origin is a pattern that names no domain, such as *, *:5006 or *.*."""
    return not origin.rpartition("://")[2].partition(":")[0].strip("*.")


def _secret(arguments: argparse.Namespace) -> bytes | None:
    """Return the secret that signs sessions, if one is given."""
    if arguments.secret_file is not None:
        return _long_enough(_content(arguments.secret_file).strip(), f"the file {arguments.secret_file}")
    if given := os.environ.get("BOKEH_SECRET_KEY"):
        return _long_enough(given.strip().encode(), "BOKEH_SECRET_KEY")
    return secrets.token_bytes(32) if arguments.generate_secret else None


def _long_enough(secret: bytes, where: str) -> bytes:
    if len(secret) < _SHORTEST:
        raise BadInput(f"The secret in {where} has {len(secret)} bytes; at least {_SHORTEST} are needed: "
                       "head -c 32 /dev/urandom | base64 makes one.")
    return secret


def _content(name: str) -> bytes:
    try:
        with Path(name).open("rb") as file:
            return file.read(10_000)
    except OSError as problem:
        raise BadInput(f"The file {name} cannot be read: {problem.strerror or problem}.") from None


def _require_readable(name: str) -> None:
    """Refuse an unreadable file with a sentence; Panel, which reads it later, would show a traceback."""
    _content(name)


def _sign_in(arguments: argparse.Namespace, secret: bytes | None) -> dict[str, str]:
    """Return the keyword arguments of Panel's `serve` for signing in.

    Panel signs its cookies with a separate secret. By default it is derived from the secret of the sessions, so that
    all processes with the same secret accept each other's cookies, even after a restart.
    """
    if arguments.basic_auth is None and arguments.oauth_provider is None:
        return {}
    if arguments.basic_auth is not None and arguments.oauth_provider is not None:
        raise BadInput("--basic-auth and --oauth-provider are two ways to sign in; give one of them.")
    derived = hmac.new(secret or secrets.token_bytes(32), b"cookies of granchain", "sha256").hexdigest()
    keywords = {"cookie_secret": os.environ.get("PANEL_COOKIE_SECRET") or derived}
    if arguments.basic_auth is not None:
        _require_readable(arguments.basic_auth)
        return {**keywords, "basic_auth": arguments.basic_auth}
    missing = [name for name in ("PANEL_OAUTH_KEY", "PANEL_OAUTH_SECRET") if not os.environ.get(name)]
    if missing:
        raise BadInput(f"--oauth-provider needs {' and '.join(missing)} in the environment.")
    keywords["oauth_provider"] = arguments.oauth_provider
    keywords.update((name, os.environ[variable]) for name, variable in _OAUTH.items() if os.environ.get(variable))
    return keywords
