"""Failures of a request, each with one sentence for the user."""

from __future__ import annotations

import difflib
import math
import numbers
import operator
from collections.abc import Iterable
from typing import Any

#: Names of the outcomes of computations whose numbers failed.
FAILURES = ("not-finite", "step-too-small", "too-many-steps", "chatter", "no-convergence", "same-orbit",
            "another-orbit", "no-point", "contacts", "contradicted", "solver-gave-up", "too-slow", "worker-failed")


class BadInput(ValueError):
    """A value from outside that cannot be used: the message says what, where, the allowed range and the nearest valid
    one.

    Line breaks and control characters of the value are escaped, so that the message stays one line and does not control
    a terminal.

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


class NumbersFailed(ArithmeticError):
    """A computation that could not be finished; the message says which bead, when, why and what to do.

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
    >>> from granchain_core import NumbersFailed
    >>> problem = NumbersFailed("Bead 3 is no longer finite.", "not-finite", bead=3)
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
    """A computation that is refused before it starts, because it would take too long.

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


def outcome_of(problem: NumbersFailed | OverBudget) -> dict[str, Any]:
    """The JSON object of a computation that failed or was not begun: status, message, and where and when if known."""
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


def check_range(what: str, value: float, low: float, high: float) -> None:
    """Raise `BadInput` if `value` is outside the range; its sentence begins with `what` and names the nearest one."""
    if not low <= value <= high:
        raise BadInput(f"{what} {value} is outside {low} to {high}; the nearest valid value is "
                       f"{min(max(value, low), high)}.")


def whole_number(what: str, value: object, low: int, high: float) -> int:
    """`value` as an int, one of NumPy too; `BadInput` if it is no whole number or outside the range."""
    try:
        number = operator.index(value)  # type: ignore[arg-type]  # what has no index is refused
    except TypeError:
        number = None
    if number is None or isinstance(value, bool):
        near = isinstance(value, numbers.Real) and not isinstance(value, bool) and math.isfinite(value)
        nearest = min(max(round(value), low), high) if near else low  # type: ignore[call-overload]  # a real number
        raise BadInput(f"{what} {str(value)[:40]!r} must be a whole number from {low} to {high}; the nearest valid "
                       f"value is {nearest}.")
    check_range(what, number, low, high)
    return number


def seconds_allowed(budget: object) -> float:
    """A budget of computing time [s] as a float; `BadInput` if it is no number from 0. It may be infinite."""
    if not isinstance(budget, numbers.Real) or isinstance(budget, bool) or not float(budget) >= 0.0:
        raise BadInput(f"budget = {str(budget)[:40]} must be a number of seconds, 0 or more; 86400 is a day.")
    return float(budget)


def series_in(what: str, values: object) -> list[Any]:
    """A list, an array or any other series as a list; `BadInput` for a single number and for a text."""
    try:
        if isinstance(values, (str, bytes)):
            raise TypeError
        return list(values)  # type: ignore[call-overload]  # what is no series is refused
    except TypeError:
        raise BadInput(f"{what} must be a list or an array, not {str(values)[:40]!r}; "
                       f"[{str(values)[:40]}] is a list of one.") from None


def numbers_in(what: str, values: object) -> list[float]:
    """The same as floats; `BadInput` for words too."""
    try:
        return [float(value) for value in series_in(what, values)]
    except (TypeError, ValueError, OverflowError) as problem:
        if isinstance(problem, BadInput):
            raise
        raise BadInput(f"{what} must be numbers, not {str(values)[:40]!r}.") from None


def axis_in(what: str, given: object) -> tuple[str, Any]:
    """A pair of a name and its values; `BadInput` for anything else, as for a name alone."""
    if not isinstance(given, (tuple, list)) or len(given) != 2 or not isinstance(given[0], str):
        raise BadInput(f'{what} must be a name and its values, as in ("f", [300.0, 310.0]), not {str(given)[:40]!r}.')
    return given[0], given[1]
