"""The ways a request can fail, each carrying one sentence a student understands."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any

#: Names of the outcomes of computations whose numbers failed.
FAILURES = ("not-finite", "step-too-small", "chatter", "no-convergence", "same-orbit", "another-orbit", "no-point",
            "contacts", "contradicted", "solver-gave-up", "too-slow", "worker-failed")


class BadInput(ValueError):
    """A value from outside that cannot be used; the message says what, where, allowed range, nearest valid."""


class NumbersFailed(ArithmeticError):
    """A computation that could not be finished; the message says which bead, when, why and what to do.

    `status` is the outcome's name as it appears in the JSON output: one of `FAILURES`. Where they are known, `bead` is
    the first bead that failed, `time` [s] when, and `step` the step of its drive period, counted from 0. `cost` counts
    steps, rhs, events and rejected steps of the computation until then.
    """

    def __init__(self, sentence: str, status: str, bead: int | None = None, time: float | None = None,
                 step: int | None = None, cost: dict[str, int] | None = None) -> None:
        super().__init__(sentence)
        self.sentence = sentence
        self.status = status
        self.bead = bead
        self.time = time
        self.step = step
        self.cost = cost


class OverBudget(BadInput):
    """A computation that is refused before it starts, because it would take `estimate` seconds of `budget`."""

    status = "over-budget"

    def __init__(self, sentence: str, estimate: float, budget: float) -> None:
        super().__init__(sentence)
        self.estimate = estimate
        self.budget = budget


class Cancelled(Exception):
    """The stop flag was raised while a computation was running."""


def outcome_of(problem: NumbersFailed | OverBudget) -> dict[str, Any]:
    """What a script is told of a computation that failed or was not begun: outcome, sentence, and what is known."""
    if isinstance(problem, OverBudget):
        return {"status": problem.status, "message": str(problem), "estimate_s": problem.estimate,
                "budget_s": problem.budget}
    return {"status": problem.status, "message": problem.sentence, "bead": problem.bead, "time": problem.time,
            "step": problem.step, "cost": problem.cost}


def unknown_name(kind: str, name: object, known: Iterable[str]) -> BadInput:
    """The error for a name that does not exist, naming the nearest one that does."""
    names = sorted(known)
    near = difflib.get_close_matches(str(name), names, n=1, cutoff=0.0)
    hint = f"; the nearest is {near[0]!r}" if near else ""
    return BadInput(f"Unknown {kind} {str(name)[:60]!r}{hint}; known: {', '.join(names)}.")
