"""The dashboard's own server."""

from __future__ import annotations

from collections.abc import Sequence

import panel as pn

from ..page.entry import page
from ..page.session import Session
from .compiler import COMPILER


def serve(port: int = 5006, address: str = "127.0.0.1", origins: Sequence[str] | None = None) -> None:
    """Serve the page until interrupted; `/liveness` answers health checks. Raises `OSError` for a taken port."""
    hosts = list(origins or ()) + [f"{host}:{port}" for host in ("localhost", "127.0.0.1", address)]
    server = pn.serve(
        {"/": page}, port=port, address=address, start=False, show=False, title="granchain", liveness=True,
        verbose=False, websocket_origin=hosts,
    )
    shown = "localhost" if address in ("0.0.0.0", "127.0.0.1", "") else address
    print(f"granchain is at http://{shown}:{port}/ (stop it with Ctrl+C)", flush=True)
    COMPILER.prepare(Session().scene)
    server.run_until_shutdown()
