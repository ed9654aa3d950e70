"""Runs a coroutine, or a whole test, whatever ran in the same process before."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from functools import wraps
from typing import ParamSpec, TypeVar

Result = TypeVar("Result")
Words = ParamSpec("Words")


def run_async(work: Coroutine[object, object, Result]) -> Result:
    """As `asyncio.run`, in a thread of its own: Playwright's event loop runs in the main thread as long as a browser is
    open.
    """
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(asyncio.run, work).result()


def in_a_thread(test: Callable[Words, Result]) -> Callable[Words, Result]:
    """The test in a thread of its own, for one that lets Bokeh or Tornado run an event loop; reason as above."""
    @wraps(test)
    def threaded(*words: Words.args, **named: Words.kwargs) -> Result:
        with ThreadPoolExecutor(1) as pool:
            return pool.submit(test, *words, **named).result()

    return threaded
