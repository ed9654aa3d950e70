"""Flushing subnormal numbers to zero while an engine runs, and restoring the thread's setting afterwards."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from ..kernels.compiling.jit import brief_kernel
from ..kernels.simd.subnormals import flush_subnormals, restore_subnormals

P = ParamSpec("P")
R = TypeVar("R")


@brief_kernel
def _flush():  # type: ignore[no-untyped-def]
    return flush_subnormals()  # type: ignore[call-arg]


@brief_kernel
def _restore(before):  # type: ignore[no-untyped-def]
    restore_subnormals(before)  # type: ignore[call-arg]


def flushed(function: Callable[P, R]) -> Callable[P, R]:
    """The function, run with subnormal numbers taken for zero in this thread.

    Ahead of a wave all numbers may be subnormal, and arithmetic with them is slow.
    """

    @functools.wraps(function)
    def inner(*words: P.args, **names: P.kwargs) -> R:
        before = _flush()
        try:
            return function(*words, **names)
        finally:
            _restore(before)

    return inner
