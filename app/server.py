"""The dashboard's own server."""

from __future__ import annotations

from collections.abc import Sequence

import panel as pn

from .compiling import COMPILER
from .page import page
from .session import Session


def serve(port: int = 5006, address: str = "127.0.0.1", origins: Sequence[str] | None = None) -> None:
    """Serve the page until interrupted; `/liveness` answers health checks."""
    COMPILER.prepare(Session().scene)
    pn.serve(
        {"/": page}, port=port, address=address, show=False, title="granchain", liveness=True, verbose=False,
        websocket_origin=list(origins) if origins else [f"localhost:{port}", f"127.0.0.1:{port}"],
    )
