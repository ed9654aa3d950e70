"""The dashboard's own server."""

from __future__ import annotations

from collections.abc import Sequence

import panel as pn

from .page import page


def serve(port: int = 5006, address: str = "127.0.0.1", origins: Sequence[str] | None = None) -> None:
    """Serve the page until interrupted; `/liveness` answers health checks."""
    pn.serve(
        {"/": page}, port=port, address=address, show=False, title="granchain", liveness=True, verbose=False,
        websocket_origin=list(origins) if origins else [f"localhost:{port}", f"127.0.0.1:{port}"],
    )
