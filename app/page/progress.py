"""Where a computation in the background stands, in words: the one place for them, whatever page it belongs to."""

from __future__ import annotations

from typing import Any

from ..serve.compiler import compiling_words

#: States in which a computation is under way or waits for its turn.
RUNNING = ("waiting", "compiling", "settling", "following", "measuring", "computing", "searching", "running", "drawing")

#: What every page says; states that are missing here, such as "done", are not told.
_WORDS = {"waiting": "waiting for its turn …", "settling": "looking for the first orbit …",
          "following": "following …", "measuring": "measuring …", "computing": "computing …",
          "searching": "searching …", "drawing": "drawing …", "cancelled": "cancelled"}

#: What a page says instead.
_OWN = {
    "accuracy": {"cancelled": "cancelled; what was measured stays"},
    "branches": {"cancelled": "stopped; what was found stays"},
    "map": {"waiting": "waiting for the curve …", "computing": "", "cancelled": "stopped; what is there stays"},
    "attractors": {"searching": "from rest, both sweeps and random states …"},
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
