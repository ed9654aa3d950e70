"""The two ways a request can fail, each carrying one sentence a student understands."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class BadInput(ValueError):
    """A value from outside that cannot be used; the message says what, where, allowed range, nearest valid."""


class NumbersFailed(ArithmeticError):
    """A computation that could not be finished; the message says which bead, when, why and what to do.

    `status` is the outcome's name as it appears in the JSON output, for example ``"not-finite"``.
    """

    def __init__(self, sentence: str, status: str) -> None:
        super().__init__(sentence)
        self.sentence = sentence
        self.status = status


class Cancelled(Exception):
    """The stop flag was raised while a computation was running."""


def unknown_name(kind: str, name: object, known: Iterable[str]) -> BadInput:
    """The error for a name that does not exist, naming the nearest one that does."""
    names = sorted(known)
    near = difflib.get_close_matches(str(name), names, n=1, cutoff=0.0)
    hint = f"; the nearest is {near[0]!r}" if near else ""
    return BadInput(f"Unknown {kind} {str(name)[:60]!r}{hint}; known: {', '.join(names)}.")
