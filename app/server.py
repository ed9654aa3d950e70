"""The dashboard's own server."""

from __future__ import annotations

from collections.abc import Sequence

import panel as pn
from bokeh.server.server import Server

from granchain_core.experiment.measured import MOST_BYTES

from .page.entry import page
from .serve.compiler import COMPILER
from .session.session import Session

#: The largest message a page sends is an uploaded file, in which JSON may write a character in six bytes.
LARGEST_MESSAGE = 6 * MOST_BYTES + 100_000


def serve(port: int = 5006, address: str = "127.0.0.1", origins: Sequence[str] | None = None) -> None:
    """Serve the page until interrupted; `/liveness` answers health checks. Raises `OSError` for a taken port."""
    server = server_at(port, address, origins)
    shown = "localhost" if address in ("0.0.0.0", "127.0.0.1", "") else address
    print(f"granchain is at http://{shown}:{port}/ (stop it with Ctrl+C)", flush=True)
    COMPILER.prepare(Session().scene)
    server.start()
    server.io_loop.start()  # until a signal ends the process (app/cli/ending.py); Bokeh's own waits for its threads


def server_at(port: int, address: str, origins: Sequence[str] | None = None) -> Server:
    """The server, which listens and does not run yet."""
    hosts = list(origins or ()) + [f"{host}:{port}" for host in ("localhost", "127.0.0.1", address)]
    return pn.serve(
        {"/": page}, port=port, address=address, start=False, show=False, title="granchain", liveness=True,
        location=False, verbose=False, websocket_origin=hosts, websocket_max_message_size=LARGEST_MESSAGE,
    )
