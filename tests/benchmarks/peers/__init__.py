"""One file a peer. Each has `missing()`, a sentence if the peer cannot run here, and `cases()`, its rows."""

from __future__ import annotations

from types import ModuleType

from . import c_program, cyrk, diffrax, granchain, heyoka, numbalsoda, scipy

PEERS: dict[str, ModuleType] = {
    "granchain": granchain, "c": c_program, "numbalsoda": numbalsoda, "cyrk": cyrk, "heyoka": heyoka,
    "scipy": scipy, "diffrax": diffrax,
}
