"""Errors in the log, each with an id that is also in the message to the visitor."""

from __future__ import annotations

import hashlib
import logging
import secrets
from collections.abc import Mapping

from .metrics import METRICS

log = logging.getLogger("granchain")


def new_fault_id() -> str:
    """Return an id that a visitor can report, like that of a request."""
    return secrets.token_hex(6)


def session_label(session_id: str) -> str:
    """Return a name of a session for the log, which, unlike the session's id, cannot be used to connect."""
    return hashlib.sha256(session_id.encode()).hexdigest()[:12]


def log_fault(error: BaseException, fault: str, message: str = "unexpected failure",
              where: Mapping[str, str] | None = None) -> None:
    """Log an error of granchain itself with its traceback under the id `fault`, and count it.

    `where` has further fields of the log line: the session's label and its share link.
    """
    METRICS.count("errors")
    log.error(message, exc_info=error, extra={"fault": fault, **(where or {})})


def log_failed_computation(error: Exception, fault: str, where: Mapping[str, str]) -> None:
    """Log a computation that could not be finished, under the id `fault`, in one line without a traceback."""
    log.warning("computation failed: %s", error, extra={"fault": fault, **where})


def log_script_error(what: str, where: Mapping[str, str]) -> None:
    """Log an error of a script in a visitor's browser; its text may come from a stranger."""
    log.warning("script failed: %s", what, extra=dict(where))


def with_fault_id(sentence: str, fault: str) -> str:
    """Return the sentence with the id of the fault at its end."""
    return f"{sentence} (fault {fault})"
