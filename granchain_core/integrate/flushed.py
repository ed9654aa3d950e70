"""Flushing subnormal numbers to zero while an engine runs, and restoring the thread's setting afterwards."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from ..kernels.simd.subnormals import begin_flushing, end_flushing

P = ParamSpec("P")
R = TypeVar("R")


def flushed(function: Callable[P, R]) -> Callable[P, R]:
    """Run a function with subnormal numbers treated as zero in this thread (decorator).

    Ahead of a wave, all numbers may be subnormal, and arithmetic with them is slow.
    """

    @functools.wraps(function)
    def inner(*words: P.args, **names: P.kwargs) -> R:
        before = begin_flushing()
        try:
            return function(*words, **names)
        finally:
            end_flushing(before)

    return inner
