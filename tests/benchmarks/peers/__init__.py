"""One file a peer. Each has `missing()`, a sentence if the peer cannot run here, and `cases()`, its rows."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

#: In the order of the tables; a peer is imported only when it is asked for.
PEERS = ("granchain", "c_program", "numbalsoda", "cyrk", "heyoka", "scipy", "diffrax")


def peer(name: str) -> ModuleType:
    """The module of a peer."""
    return import_module(f".{name}", __name__)
