"""Calls of a kernel without Numba's dispatcher.

At each call the dispatcher reads the names of all fields of every named tuple, to choose the compiled version: 20 to
40 µs for the tuples that kernels take here, with the interpreter's lock held. Where a kernel is called often, the
version is chosen once.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any

import numpy as np

#: Whether every call compares the types of its arguments with those of the version it uses: tests set it.
CHECKED = False


def entry(kernel: Any, *arguments: Any) -> Callable[..., Any]:
    """The compiled version of a kernel for arguments of these types, compiled first where it is not there yet.

    It does not check what it is given: later arguments must have the same types, layouts of arrays included.
    """
    types, version = version_for(kernel, arguments)
    compiled: Callable[..., Any] = version.entry_point
    if not CHECKED:
        return compiled

    def checked(*later: Any) -> Any:
        if (seen := _types(kernel, later)) != types:
            raise TypeError(f"{kernel.__name__} is called with {seen}, but this is its version for {types}.")
        return compiled(*later)

    return checked


class Entries:
    """The versions of one kernel, by keys of the caller's: arguments with equal keys must have equal types."""

    def __init__(self, kernel: Any) -> None:
        self._kernel = kernel
        self._known: dict[Hashable, Callable[..., Any]] = {}

    def __call__(self, key: Hashable, *arguments: Any) -> Any:
        """Call the kernel's version for `key`."""
        found = self._known.get((key, CHECKED))
        if found is None:
            found = self._known[key, CHECKED] = entry(self._kernel, *arguments)
        return found(*arguments)


def types_of(value: Any) -> Any:
    """A key for a value's Numba type: classes of nested tuples, kind and layout of arrays, type of the rest."""
    if isinstance(value, tuple):
        return type(value), *map(types_of, value)
    if isinstance(value, np.ndarray):
        return value.dtype.char, value.ndim, value.flags.num  # each flag by its name would take twice the time
    return type(value)


def version_for(kernel: Any, arguments: tuple[Any, ...]) -> tuple[tuple[Any, ...], Any]:
    """Types of these arguments and a kernel's version for them, compiled first where it is not there yet."""
    types = _types(kernel, arguments)
    if types not in kernel.overloads:
        kernel.compile(types)
    return types, kernel.overloads[types]


def _types(kernel: Any, arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(kernel.typeof_pyval(argument) for argument in arguments)
