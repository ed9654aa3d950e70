"""Subnormal numbers are zero while an engine runs, whichever kernel it runs; afterwards they are what they were."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from ..kernels.jit import kernel
from ..kernels.simd.subnormals import flush_subnormals, restore_subnormals

P = ParamSpec("P")
R = TypeVar("R")


@kernel
def _flush():  # type: ignore[no-untyped-def]
    return flush_subnormals()  # type: ignore[call-arg]


@kernel
def _restore(before):  # type: ignore[no-untyped-def]
    restore_subnormals(before)  # type: ignore[call-arg]


def flushed(function: Callable[P, R]) -> Callable[P, R]:
    """The function with subnormal numbers taken for zero in this thread: ahead of a wave they may be all there is."""

    @functools.wraps(function)
    def inner(*words: P.args, **names: P.kwargs) -> R:
        before = _flush()
        try:
            return function(*words, **names)
        finally:
            _restore(before)

    return inner
