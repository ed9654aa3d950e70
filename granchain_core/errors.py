"""Exceptions of the public API, each with one sentence for the user."""

from __future__ import annotations

from typing import Any

#: Names of the outcomes of failed computations.
FAILURES = ("not-finite", "step-too-small", "too-many-steps", "chatter", "too-many-events", "no-convergence",
            "same-orbit", "another-orbit", "no-point", "contacts", "contradicted", "solver-gave-up", "too-slow",
            "worker-failed")


class BadInput(ValueError):
    """Invalid input. The message names the value, its place, the allowed range and the nearest valid value.

    Line breaks and control characters of the value are escaped, so that the message stays on one line and cannot
    control a terminal.

    Examples
    --------
    >>> from granchain_core import BadInput, scene
    >>> try:
    ...     scene("sec2").evolve(N=0)
    ... except BadInput as problem:
    ...     print(problem)
    number of beads N = 0 is outside 1 to 10000; the nearest valid value is 1.
    """

    def __init__(self, sentence: str) -> None:
        super().__init__("".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode()
                                 for letter in sentence))


class ComputationError(ArithmeticError):
    """A computation that could not be finished. The message says which bead failed, when and why, and what to do.

    Attributes
    ----------
    sentence : str
        The message.
    status : str
        The outcome's name in the JSON output, one of `FAILURES`.
    bead : int or None
        The first bead that failed.
    time : float or None
        Time of the failure since the start [s].
    step : int or None
        Number of the failed step within its drive period, from 0.
    cost : dict or None
        Counts up to the failure: steps, rhs (evaluations of the equations), events, rejected steps.

    Examples
    --------
    >>> from granchain_core import ComputationError
    >>> problem = ComputationError("Bead 3 is no longer finite.", "not-finite", bead=3)
    >>> problem.status, problem.bead, str(problem)
    ('not-finite', 3, 'Bead 3 is no longer finite.')
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
    """A computation refused before it starts because it would take too long.

    Attributes
    ----------
    estimate, budget : float
        Estimated and allowed computing time [s].

    Examples
    --------
    >>> from granchain_core import OverBudget, run, scene
    >>> try:
    ...     run(scene("sec2").evolve(N=2, f=2000.0), periods=10**6, budget=0.01)
    ... except OverBudget as problem:
    ...     print(problem.estimate > problem.budget)
    True
    """

    status = "over-budget"

    def __init__(self, sentence: str, estimate: float, budget: float) -> None:
        super().__init__(sentence)
        self.estimate = estimate
        self.budget = budget


class Cancelled(Exception):
    """`Stop.set` was called while a computation was running.

    Examples
    --------
    >>> from granchain_core import Cancelled, Stop, run, scene
    >>> stop = Stop()
    >>> stop.set()
    >>> try:
    ...     run(scene("sec2").evolve(N=2, f=2000.0), stop=stop)
    ... except Cancelled:
    ...     print("cancelled")
    cancelled
    """


def outcome_of(problem: ComputationError | OverBudget) -> dict[str, Any]:
    """Return the JSON object of a failed or refused computation: status, message and, if known, where and when it
    failed.
    """
    if isinstance(problem, OverBudget):
        return {"status": problem.status, "message": str(problem), "estimate_s": problem.estimate,
                "budget_s": problem.budget}
    return {"status": problem.status, "message": problem.sentence, "bead": problem.bead, "time": problem.time,
            "step": problem.step, "cost": problem.cost}
