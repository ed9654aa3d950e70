"""Run a coroutine, or a whole test, in a thread without an event loop."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from functools import wraps
from typing import ParamSpec, TypeVar

Result = TypeVar("Result")
Words = ParamSpec("Words")


def run_async(work: Coroutine[object, object, Result]) -> Result:
    """Call `asyncio.run` in a separate thread: while a browser is open, Playwright's event loop runs in the main
    thread.
    """
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(asyncio.run, work).result()


def in_a_thread(test: Callable[Words, Result]) -> Callable[Words, Result]:
    """Run a test in a separate thread, for the same reason: a decorator for tests in which Bokeh or Tornado runs an
    event loop.
    """
    @wraps(test)
    def threaded(*words: Words.args, **named: Words.kwargs) -> Result:
        with ThreadPoolExecutor(1) as pool:
            return pool.submit(test, *words, **named).result()

    return threaded
