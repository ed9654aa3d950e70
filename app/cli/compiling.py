"""A message on the terminal, shown once, that the first run waits for the compiler."""

from __future__ import annotations

import functools
import sys

WORDS = ("Compiling the kernels for this set of effects: 10 to 60 s, once per machine. "
         "`granchain warm` does it ahead of time.")


@functools.cache
def announce_compiling() -> None:
    """From now on, tell a person at a terminal when Numba begins to compile; a kernel read from disk is no news."""
    if not sys.stderr.isatty():
        return
    from numba.core import event  # with the compiler: a second that commands without kernels do not wait

    class Listener(event.Listener):
        announced = False

        def on_start(self, event: event.Event) -> None:
            if not Listener.announced:
                Listener.announced = True
                print(WORDS, file=sys.stderr, flush=True)

        def on_end(self, event: event.Event) -> None:
            pass

    event.register("numba:compile", Listener())
