"""Sentences for the visitor, their lines in the log, and the button that computes a refused picture anyway."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable
from typing import Any

from granchain_core import BadInput, ComputationError, Scene

from ..parts.status.status_line import StatusLine
from ..serve.monitoring.faults import (
    log_failed_computation,
    log_fault,
    log_script_error,
    new_fault_id,
    with_fault_id,
)
from ..serve.monitoring.metrics import METRICS
from ..session.budget import RefusedPicture
from ..session.page import Actions
from ..session.session import Session

#: Messages that leave the sentence, because a browser also sends them when its visitor does nothing: `theme`, `playing`
#: and `branches-open` may follow from a link or from settings of the system.
SENT_UNASKED = frozenset({"ping", "ready", "window-shown", "compact", "visible", "painted", "script-error",
                          "reconnected", "theme", "playing", "branches-open"})
#: Largest number of script errors logged for one session: a script that fails may fail at every frame.
MOST_SCRIPT_ERRORS = 5
#: Length to which the text of such an error is cut [characters].
LONGEST_SCRIPT_ERROR = 400


class Sentences:
    """The sentence above the status line. `compute` requests a picture of the present knobs.

    A sentence stays until the browser sends a valid message outside `SENT_UNASKED`, until another sentence replaces it,
    or until the visitor closes it. That of a refused picture stays, with its button, until a picture is
    requested or another scene is opened: it says why the picture does not follow the knobs.
    """

    def __init__(self, session: Session, line: StatusLine, compute: Callable[[], None]) -> None:
        self._session = session
        self._line = line
        self._compute = compute
        self._refused: Scene | None = None
        self._script_errors = 0
        self.actions: Actions = {"dismiss-sentence": self._dismiss, "insist": self._insist,
                                 "script-error": self._script_error}

    def show_sentence(self, sentence: str, refused: Scene | None = None) -> None:
        """Show a sentence; an empty text removes it.

        A button next to it computes the scene that was `refused` because it takes too long.
        """
        self._session.sentence = sentence
        self._refused = refused
        self._show()

    def action_begins(self, name: str) -> None:
        """Remove the sentence because the visitor acts; if the action is refused, its own sentence follows.

        Both changes leave together (`Calls`).
        """
        if name not in SENT_UNASKED and self._refused is None and self._session.sentence:
            self.show_sentence("")

    def show_notice(self, notice: str) -> None:
        """Show a sentence until the next picture."""
        self._session.notice = notice
        self._show()

    def show_failure(self, error: Exception) -> None:
        """Show a failure as a sentence; the last good picture stays."""
        if isinstance(error, RefusedPicture):
            METRICS.count("refused_pictures")
            if error.scene == self._session.scene:  # otherwise a knob has moved since then
                self.show_sentence(str(error), error.scene)
        elif isinstance(error, BadInput):
            self.show_sentence(str(error))
        elif isinstance(error, ComputationError):
            fault = new_fault_id()
            self.log_failed_computation(error, fault)
            self.show_notice(with_fault_id(error.sentence, fault))
        else:
            self.report_fault(error, f"Something went wrong inside granchain ({type(error).__name__}); the last "
                                     "picture stays. Move the knob back or reset, and please report it.")

    def report_fault(self, error: Exception, sentence: str, fault: str = "") -> None:
        """Log and count an error of granchain itself, and show `sentence` with an id unless it is empty.

        `fault` is the id, if the visitor sees it elsewhere; otherwise a new one is made.
        """
        fault = fault or new_fault_id()
        log_fault(error, fault, where=self._where())
        if sentence:
            self.show_sentence(with_fault_id(sentence, fault))

    def log_failed_computation(self, error: Exception, fault: str) -> None:
        """Log a computation that could not be finished, under the id shown with its sentence."""
        log_failed_computation(error, fault, self._where())

    def _where(self) -> dict[str, str]:
        """Return fields for a log line: the session's label, and a link that restores the state.

        The link contains scene, knobs and view, but nothing of an uploaded file.
        """
        where = {"session": self._session.label} if self._session.label else {}
        with contextlib.suppress(Exception):  # even if the state itself is at fault, the fault must be logged
            where["link"] = self._session.link
        return where

    def _script_error(self, message: dict[str, Any]) -> None:
        """Log an error of a script in the browser as one line of JSON, because anyone could send any text."""
        words = message.get("what")
        if not isinstance(words, str) or self._script_errors >= MOST_SCRIPT_ERRORS:
            return
        self._script_errors += 1
        log_script_error(json.dumps(words[:LONGEST_SCRIPT_ERROR]), self._where())

    def _show(self) -> None:
        self._line.update_state(sentence=f"{self._session.sentence} {self._session.notice}".strip(),
                                insist=self._refused is not None)

    def _insist(self, _: dict[str, Any]) -> None:
        """Compute the refused scene although it takes too long; other sessions still get their turns."""
        if self._refused is not None and self._refused == self._session.scene:
            self._session.insisted = self._refused
            self.show_sentence("")
            self._compute()

    def _dismiss(self, _: dict[str, Any]) -> None:
        self._session.notice = ""
        self.show_sentence("")
