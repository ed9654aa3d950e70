"""Runs a coroutine in a test, whatever ran in the same process before."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Result = TypeVar("Result")


def run_async(work: Coroutine[object, object, Result]) -> Result:
    """As `asyncio.run`, in a thread of its own: Playwright's event loop runs in the main thread as long as a browser is open."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(asyncio.run, work).result()
