"""Errors of granchain itself: each is counted, and has an id in the log and in the sentence to the visitor."""

from __future__ import annotations

import logging
import secrets

from .metrics import METRICS

log = logging.getLogger("granchain")


def new_fault_id() -> str:
    """An id that a visitor can report, as that of a request."""
    return secrets.token_hex(6)


def log_fault(error: BaseException, fault: str, message: str = "unexpected failure") -> None:
    """Log an error with its traceback under the id `fault`, and count it."""
    METRICS.count("errors")
    log.error(message, exc_info=error, extra={"fault": fault})


def with_fault_id(sentence: str, fault: str) -> str:
    """The sentence, with the id of the fault at its end."""
    return f"{sentence} (fault {fault})"
