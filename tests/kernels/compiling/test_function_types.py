"""A function that kernels call is compiled once per set of argument types, whatever its callers and the numbers in the
calls.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba
import numpy as np

from granchain_core.kernels.compiling.dispatch import by_slot
from granchain_core.kernels.compiling.jit import Internal, inline_numba, internal


class Spring(NamedTuple):
    """A slot."""

    stiffness: float


def parts() -> tuple[Any, Any]:
    """Return a compiled function of an index, and one that is selected by a slot."""

    @Internal
    @numba.njit
    def entry(values, i):
        return values[i]

    @by_slot
    def force(spring, u):
        return 0.0

    @force.of(Spring)
    def _(spring, u):
        return spring.stiffness * u

    return entry, force


def test_numbers_written_out_in_calls_make_no_further_versions() -> None:
    entry, _ = parts()

    @numba.njit
    def total(values):
        whole = 0.0
        for i in range(values.size):
            whole += entry(values, i)
        return whole + entry(values, 0) + 10.0 * entry(values, 1)

    assert total(np.array([1.0, 2.0])) == 24.0
    assert len(entry.dispatcher.overloads) == 1


def test_callers_with_other_options_share_a_version() -> None:
    _, force = parts()
    compiled = []

    @internal
    def in_part(spring, u):
        return force(spring, u)

    @inline_numba
    def inlined(spring, u):
        return force(spring, u)

    @numba.njit
    def both(spring, u):
        return in_part(spring, u) + inlined(spring, u) + force(spring, u) + force(None, u)

    class Counted(numba.core.event.Listener):
        def on_start(self, event: numba.core.event.Event) -> None:
            compiled.append(event.data["dispatcher"].py_func)

        def on_end(self, event: numba.core.event.Event) -> None:
            pass

    listener = Counted()
    numba.core.event.register("numba:compile", listener)
    try:
        assert both(Spring(2.0), 3.0) == 18.0
    finally:
        numba.core.event.unregister("numba:compile", listener)
    assert [compiled.count(code) for code in force.implementations.values()] == [1, 1]
