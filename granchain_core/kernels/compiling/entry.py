"""Calls of a kernel without Numba's dispatcher.

At each call the dispatcher reads the names of all fields of every named tuple, to choose the specialization: 20 to
40 µs for the tuples that kernels take here, with the GIL held. Where a kernel is called often, the specialization is
chosen once.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable
from typing import Any

import numpy as np

#: Whether every call compares the types of its arguments with those of the specialization it uses.
CHECK_TYPES = os.environ.get("GRANCHAIN_CHECK_TYPES", "0") not in ("", "0")


def entry(kernel: Any, *arguments: Any) -> Callable[..., Any]:
    """The specialization of a kernel for arguments of these types, compiled first where it is not there yet.

    It does not check what it is given unless `CHECK_TYPES`: later arguments must have the same types, layouts of arrays
    included.
    """
    types, specialization = specialization_for(kernel, arguments)
    compiled: Callable[..., Any] = specialization.entry_point
    if not CHECK_TYPES:
        return compiled

    def checked(*later: Any) -> Any:
        _check_types(kernel, types, later)
        return compiled(*later)

    return checked


def type_guard(kernel: Any, *arguments: Any) -> Callable[..., None]:
    """What raises `TypeError` for arguments of other types than these; it does nothing unless `CHECK_TYPES`.

    For a kernel that compiled code calls by its address.
    """
    if not CHECK_TYPES:
        return lambda *later: None
    types = _types(kernel, arguments)
    return lambda *later: _check_types(kernel, types, later)


def _check_types(kernel: Any, types: tuple[Any, ...], arguments: tuple[Any, ...]) -> None:
    if (seen := _types(kernel, arguments)) != types:
        raise TypeError(f"{kernel.__name__} is called with {seen}, but this is its specialization for {types}.")


class Entries:
    """The specializations of one kernel, by keys of the caller's: arguments with equal keys must have equal types.

    So the caller keeps the type and the layout of what is not in its key, such as the arrays of a call; `CHECK_TYPES`
    compares them.
    """

    def __init__(self, kernel: Any) -> None:
        self._kernel = kernel
        self._known: dict[Hashable, Callable[..., Any]] = {}

    def __call__(self, key: Hashable, *arguments: Any) -> Any:
        """Call the kernel's specialization for `key`."""
        specialization = self._known.get((key, CHECK_TYPES))
        if specialization is None:
            specialization = self._known[key, CHECK_TYPES] = entry(self._kernel, *arguments)
        return specialization(*arguments)


def types_of(value: Any) -> Any:
    """A key for a value's Numba type: classes of nested tuples, kind and layout of arrays, type of the rest."""
    if isinstance(value, tuple):
        return type(value), *map(types_of, value)
    if isinstance(value, np.ndarray):
        return value.dtype.char, value.ndim, value.flags.num  # each flag by its name would take twice the time
    return type(value)


def specialization_for(kernel: Any, arguments: tuple[Any, ...]) -> tuple[tuple[Any, ...], Any]:
    """Types of these arguments and a kernel's specialization for them, compiled first where it is not there yet."""
    types = _types(kernel, arguments)
    if types not in kernel.overloads:
        kernel.compile(types)
    return types, kernel.overloads[types]


def _types(kernel: Any, arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(kernel.typeof_pyval(argument) for argument in arguments)
