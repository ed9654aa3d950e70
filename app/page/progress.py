"""Words for the status of background computations. Curve and effects have their own; see also activities.py."""

from __future__ import annotations

from typing import Any

from ..serve.compiler import compiling_words

#: States in which a computation is under way or waits for its turn.
RUNNING = ("waiting", "compiling", "settling", "following", "measuring", "computing", "searching", "running", "drawing")

#: Words for every page; a status without an entry, such as "done", is not shown.
_WORDS = {"waiting": "waiting for its turn …", "settling": "looking for the first orbit …",
          "following": "following …", "measuring": "measuring …", "computing": "computing …",
          "searching": "searching …", "drawing": "drawing …", "cancelled": "cancelled"}

#: Words that one page uses instead.
_OWN = {
    "accuracy": {"cancelled": "cancelled; the measurements so far are kept"},
    "branches": {"cancelled": "stopped; the orbits found so far are kept"},
    "map": {"waiting": "waiting for the curve …", "computing": "",
            "cancelled": "stopped; the cells computed so far are kept"},
    "attractors": {"searching": "searching from rest, from both sweeps and from random states …"},
}


def progress(page: str, status: str) -> dict[str, Any]:
    """What a page's part in the browser shows of a computation.

    Parameters
    ----------
    page : str
        The page, or "attractors" for the search on the map's tab.
    status : str
        A state of `RUNNING`, or "none", "done", "cancelled" or "failed".

    Returns
    -------
    dict
        `status` itself, `progress` in words (empty where there is nothing to say), and whether it is `running`.
    """
    words = _OWN.get(page, {}).get(status, _WORDS.get(status, ""))
    if status == "compiling":
        words = f"{compiling_words(page)} …"
    return {"status": status, "progress": words, "running": status in RUNNING}
