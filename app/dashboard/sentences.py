"""Sentences to the visitor, and the button that computes a refused picture anyway."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from granchain_core import BadInput, ComputationError, Scene

from ..parts.status.status_line import StatusLine
from ..serve.monitoring.faults import log_fault, new_fault_id, with_fault_id
from ..serve.monitoring.metrics import METRICS
from ..session.budget import RefusedPicture
from ..session.page import Actions
from ..session.session import Session


class Sentences:
    """The sentence over the status line. `compute` requests a picture of the present knobs."""

    def __init__(self, session: Session, line: StatusLine, compute: Callable[[], None]) -> None:
        self._session = session
        self._line = line
        self._compute = compute
        self._refused: Scene | None = None
        self.actions: Actions = {"dismiss-sentence": self._dismiss, "insist": self._insist}

    def show_message(self, sentence: str, refused: Scene | None = None) -> None:
        """Show one sentence until the next valid action; an empty text removes the sentence.

        A button beside the sentence computes the scene that was `refused` because it takes long.
        """
        self._session.sentence = sentence
        self._refused = refused
        self._show()

    def show_notice(self, notice: str) -> None:
        """Show one sentence until the next picture."""
        self._session.notice = notice
        self._show()

    def show_failure(self, error: Exception) -> None:
        """Show a failure as one sentence; the last good picture stays."""
        if isinstance(error, RefusedPicture):
            METRICS.count("refused_pictures")
            if error.scene == self._session.scene:  # otherwise a knob has moved since
                self.show_message(str(error), error.scene)
        elif isinstance(error, BadInput):
            self.show_message(str(error))
        elif isinstance(error, ComputationError):
            self.show_notice(error.sentence)
        else:
            self.report_fault(error, f"Something went wrong inside granchain ({type(error).__name__}); the last "
                                     "picture stays. Move the knob back or reset, and please report it.")

    def report_fault(self, error: Exception, sentence: str, fault: str = "") -> None:
        """Log and count an error of granchain itself, and show `sentence` with an id unless the sentence is empty.

        `fault` is the id if the visitor sees it elsewhere; otherwise it is made here.
        """
        fault = fault or new_fault_id()
        log_fault(error, fault)
        if sentence:
            self.show_message(with_fault_id(sentence, fault))

    def _show(self) -> None:
        self._line.update_state(sentence=f"{self._session.sentence} {self._session.notice}".strip(),
                                insist=self._refused is not None)

    def _insist(self, _: dict[str, Any]) -> None:
        """Compute the refused scene although it takes long; other sessions still get their turns."""
        if self._refused is not None and self._refused == self._session.scene:
            self._session.insisted = self._refused
            self.show_message("")
            self._compute()

    def _dismiss(self, _: dict[str, Any]) -> None:
        self._session.notice = ""
        self.show_message("")
