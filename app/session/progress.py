"""Words for the status of computations, the same on all pages.

A page shows the `Status` of its own computation, which says what is being done or how it ended. The list of
computations in the tab “effects” has only an `ActivityState` for each, which `activity_state` derives.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal

from granchain_core.precompile.pieces import FIXED_STEP_KERNELS

from ..serve.compiling.compiler import compiling_words

#: Nothing is being done, and there is no result: the computation is switched off, not possible, or not yet requested.
OFF: Final = "off"
#: Nothing is being done, and the results so far are there.
READY: Final = "ready"
#: The computation is under way or waiting for its turn.
COMPUTING: Final = "computing"
#: The state of an entry in the list of computations.
ActivityState = Literal["off", "ready", "computing"]

#: The status of a computation on its page.
Status = Literal["none", "waiting", "compiling", "settling", "computing", "measuring", "following", "searching",
                 "drawing", "done", "stopped", "failed"]

#: The words of a page for a computation that is under way or waiting for its turn.
UNDER_WAY: dict[Status, str] = {
    "waiting": "waiting for its turn …", "compiling": "compiling …", "settling": "looking for the first orbit …",
    "computing": "computing …", "measuring": "measuring …", "following": "following …", "searching": "searching …",
    "drawing": "drawing …",
}


def is_under_way(status: Status) -> bool:
    """Return whether a computation with this status is under way or waiting for its turn."""
    return status in UNDER_WAY


def activity_state(under_way: bool, results: bool = True) -> ActivityState:
    """Return the state of a computation in the list of computations.

    under_way : whether it is under way or waiting for its turn; see `is_under_way`.
    results : whether there are results, perhaps of a computation that was stopped.
    """
    if under_way:
        return COMPUTING
    return READY if results else OFF


@dataclass(frozen=True)
class StatusWords:
    """The words of one computation of a page.

    compiles, piece : words for its kernels, and the piece that takes longest to compile.
    remaining : words for the results that stay when the visitor stops it; empty if none stay.
    instead : words that replace those of `UNDER_WAY`.
    """

    compiles: str = "the kernels"
    piece: str = FIXED_STEP_KERNELS
    remaining: str = ""
    instead: Mapping[Status, str] = field(default_factory=dict)

    def of(self, status: Status, failure: str = "") -> dict[str, Any]:
        """Return the entries of `state`, or of a message, that the page shows in the browser.

        These are `status` itself, `progress` in words (may be empty), whether the computation is `running`, and
        `failure`, the sentence that says why it failed.
        """
        return {"status": status, "progress": self._words(status), "running": is_under_way(status), "failure": failure}

    def _words(self, status: Status) -> str:
        if status == "compiling":
            return f"{compiling_words(self.compiles, self.piece)} …"
        if status == "stopped":
            return f"stopped; {self.remaining} are kept" if self.remaining else "stopped"
        return self.instead.get(status, UNDER_WAY.get(status, ""))
