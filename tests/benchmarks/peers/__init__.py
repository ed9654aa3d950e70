"""The peers, one per file: `missing()` gives the reason if a peer cannot run here, and `cases()` its rows."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

#: The peers in the order of the tables. Each is imported only when it is used.
PEERS = ("granchain", "c_program", "numbalsoda", "cyrk", "heyoka", "scipy", "diffrax")


def peer(name: str) -> ModuleType:
    """Import the module of a peer."""
    return import_module(f".{name}", __name__)
