"""A first run waits for the compiler: a message at the terminal says why, and a second core helps."""

from __future__ import annotations

import functools
import multiprocessing
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from granchain_core import Scene
from granchain_core.execution.child_processes import end_with_parent, starting
from granchain_core.execution.cores import usable_cores
from granchain_core.precompile.pieces import BRANCH_KERNELS, COMPILE_SECONDS, FIXED_STEP_KERNELS, MOTION_KERNELS

#: The two times are for the kernels of one method, and for those of a branch and the motions that it needs.
WORDS = (f"Compiling the kernels for this set of effects: {COMPILE_SECONDS[FIXED_STEP_KERNELS]} to "
         f"{sum(COMPILE_SECONDS[piece] for piece in (*MOTION_KERNELS, BRANCH_KERNELS))} s, once per machine. "
         "`granchain warm` does it ahead of time.")


@functools.cache
def announce_compiling() -> None:
    """From now on, report at a terminal when Numba starts to compile, but not when a kernel is read from disk."""
    if not sys.stderr.isatty():
        return
    from numba.core import event  # loads the compiler, which takes a second that commands without kernels save

    class Listener(event.Listener):
        announced = False

        def on_start(self, event: event.Event) -> None:
            if not Listener.announced:
                Listener.announced = True
                print(WORDS, file=sys.stderr, flush=True)

        def on_end(self, event: event.Event) -> None:
            pass

    event.register("numba:compile", Listener())


@contextmanager
def compiling_beside(chosen: Scene, *pieces: str) -> Iterator[None]:
    """When Numba starts to compile in this block, compile these pieces (precompile/warm.py) in another process.

    When the block needs the pieces later, it waits for them or loads them. With only one core, nothing is done.
    """
    if usable_cores() < 2:
        yield
        return
    from numba.core import event

    class Listener(event.Listener):
        process: multiprocessing.context.SpawnProcess | None = None

        def on_start(self, event: event.Event) -> None:
            if self.process is None:
                self.process = multiprocessing.get_context("spawn").Process(
                    target=_compile, args=(os.getpid(), chosen, pieces), daemon=True, name="compiler")
                with starting():
                    self.process.start()

        def on_end(self, event: event.Event) -> None:
            pass

    listener = Listener()
    event.register("numba:compile", listener)
    try:
        yield
    finally:
        event.unregister("numba:compile", listener)
        if listener.process is not None:
            listener.process.terminate()


def _compile(parent: int, chosen: Scene, pieces: tuple[str, ...]) -> None:
    end_with_parent(parent)
    from granchain_core.precompile.warm import compile_piece

    try:
        for piece in pieces:
            compile_piece(chosen, piece)
    except Exception:  # the command meets the same error and reports it
        sys.exit(1)
