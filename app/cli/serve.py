"""`granchain serve`: the dashboard."""

from __future__ import annotations

import argparse

from app.cli.options import whole
from granchain_core import BadInput


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `serve`."""
    parser.add_argument("--port", type=whole, default=5006)
    parser.add_argument("--address", default="127.0.0.1")
    parser.add_argument("--allow-websocket-origin", action="append", metavar="HOST",
                        help="host name under which browsers may reach a dashboard behind a proxy")


def do(arguments: argparse.Namespace) -> None:
    """Open the dashboard."""
    from app.server import serve as serve_page

    if not 0 <= arguments.port <= 65535:
        raise BadInput(f"port {arguments.port} is outside 0 to 65535; the usual one is 5006.")
    try:
        serve_page(arguments.port, arguments.address, arguments.allow_websocket_origin)
    except OSError as problem:
        raise BadInput(f"Cannot listen on {arguments.address}:{arguments.port}: {problem.strerror or problem}; "
                       f"try --port {arguments.port + 1}.") from None
