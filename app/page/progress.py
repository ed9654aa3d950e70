"""How computations stand, in words: the one vocabulary of all pages and of the list of what is computed now."""

from __future__ import annotations

from typing import Any

from ..serve.compiler import compiling_words

#: In the list of what is computed now: nobody asks for it, nothing is left to do, it is under way.
OFF, READY, COMPUTING = "off", "ready", "computing"

#: What a page says of a computation that is under way or waits for its turn.
UNDER_WAY = {
    "waiting": "waiting for its turn …", "compiling": "compiling …", "settling": "looking for the first orbit …",
    "computing": "computing …", "measuring": "measuring …", "following": "following …", "searching": "searching …",
    "drawing": "drawing …",
}

#: What one page says instead.
_OWN = {
    "map": {"waiting": "waiting for the curve …"},
    "attractors": {"searching": "searching from rest, from both sweeps and from random states …"},
}

#: What a page keeps when the visitor stops its computation.
_KEPT = {"accuracy": "the measurements so far", "branches": "the orbits found so far",
         "map": "the cells computed so far"}


def progress(page: str, status: str) -> dict[str, Any]:
    """What a page's part in the browser shows of a computation.

    Parameters
    ----------
    page : str
        The page, or "attractors" for the search on the map's tab.
    status : str
        A state of `UNDER_WAY`, or "none", "done", "stopped" or "failed".

    Returns
    -------
    dict
        `status` itself, `progress` in words (empty where there is nothing to say), and whether it is `running`.
    """
    return {"status": status, "progress": progress_words(page, status), "running": status in UNDER_WAY}


def progress_words(page: str, status: str) -> str:
    """The words of `progress` alone."""
    if status == "compiling":
        return f"{compiling_words(page)} …"
    if status == "stopped":
        return f"stopped; {_KEPT[page]} are kept" if page in _KEPT else "stopped"
    return _OWN.get(page, {}).get(status, UNDER_WAY.get(status, ""))
