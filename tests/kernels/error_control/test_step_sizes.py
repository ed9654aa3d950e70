"""Control of the step size by the error estimate, and the smallest step allowed."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest

from granchain_core.kernels.error_control import step
from granchain_core.kernels.status import DONE, EVALUATIONS, REJECTED, STEP_TOO_SMALL

pytestmark = pytest.mark.quick


class Scripted(NamedTuple):
    """A method of order 8 whose attempts have these errors, the last one repeated; `tried` lists the attempted sizes.
    """

    errors: list[float]
    tried: list[float]


class Workspace(NamedTuple):
    """The workspace of a method with 12 stages."""


@pytest.fixture(autouse=True)
def _known(monkeypatch: pytest.MonkeyPatch) -> None:
    def attempt(method: Scripted, one: step.Step) -> float:
        method.tried.append(one.h)
        return method.errors[min(len(method.tried), len(method.errors)) - 1]

    monkeypatch.setitem(step.attempt.implementations, Scripted, attempt)
    monkeypatch.setitem(step.error_order.implementations, Scripted, lambda method: 8.0)
    monkeypatch.setitem(step.stages.implementations, Workspace, lambda workspace: 12)


def accepted(errors: list[float], t: float = 0.0) -> tuple[tuple[int, float, float], list[float], Any]:
    """Return the result of a step of size 1 from t, the attempted sizes, and the counts."""
    method, counts = Scripted(errors, []), np.zeros(4, dtype=np.int64)
    trajectory = SimpleNamespace(workspace=Workspace(), drive=step.DriveCycle(1.0, 2.0 * np.pi))
    return step.accepted_in_t.py_func(method, trajectory, t, 1.0, counts), method.tried, counts


def test_a_step_grows_at_most_sixfold() -> None:
    assert accepted([1e-30])[0] == (DONE, 1.0, 6.0)
    assert accepted([0.5])[0] == (DONE, 1.0, pytest.approx(0.9 * 0.5**-0.125))


@pytest.mark.parametrize("error", [1e-30, 1e-3, 0.3])
def test_after_a_rejected_attempt_the_step_does_not_grow(error: float) -> None:
    """Otherwise the step would grow back to the size that was just rejected."""
    (status, h, factor), tried, counts = accepted([2.0, error])
    assert (status, factor, counts[REJECTED], counts[EVALUATIONS]) == (DONE, 1.0, 1, 24)
    assert tried == [1.0, h] and h == pytest.approx(0.9 * 2.0**-0.125)


def test_after_a_rejected_attempt_the_step_may_shrink() -> None:
    assert accepted([2.0, 0.9])[0][2] == pytest.approx(0.9 * 0.9**-0.125)


@pytest.mark.parametrize("t", [0.0, 1.0, 6.0])
def test_a_step_is_too_small_where_the_time_within_a_period_does_not_resolve_it(t: float) -> None:
    """This is true at t = 0 as well, where a step of any size changes the time."""
    (status, h, _), tried, _ = accepted([2.0], t)
    assert status == STEP_TOO_SMALL and len(tried) < 200
    assert 1.0 >= h / (2.2e-15 * (1.0 + t)) > 0.9 * 2.0**-0.125
