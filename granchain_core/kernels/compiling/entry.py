"""Calls of a kernel that bypass Numba's dispatcher.

At each call, the dispatcher reads the names of all fields of every named tuple to choose the specialization. This takes
20 to 40 µs for the tuples that kernels take here, with the GIL held. For a kernel that is called often, the
specialization is therefore chosen once.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable
from typing import Any

import numpy as np

#: Whether every call compares the types of its arguments with those of the specialization it uses.
CHECK_TYPES = os.environ.get("GRANCHAIN_CHECK_TYPES", "0") not in ("", "0")


def entry(kernel: Any, *arguments: Any) -> Callable[..., Any]:
    """Return the specialization of a kernel for these argument types, compiling it first if necessary.

    It does not check its arguments unless `CHECK_TYPES` is set: later arguments must have the same types, including
    array layouts.
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
    """Return a function that raises `TypeError` for arguments of other types; without `CHECK_TYPES` it does nothing.

    Used for a kernel that compiled code calls by address.
    """
    if not CHECK_TYPES:
        return lambda *later: None
    types = _types(kernel, arguments)
    return lambda *later: _check_types(kernel, types, later)


def _check_types(kernel: Any, types: tuple[Any, ...], arguments: tuple[Any, ...]) -> None:
    if (seen := _types(kernel, arguments)) != types:
        raise TypeError(f"{kernel.__name__} is called with {seen}, but this is its specialization for {types}.")


class Entries:
    """The specializations of one kernel, by keys that the caller chooses: equal keys must mean equal argument types.

    So the caller must not change the type or layout of anything outside its key, for example the arrays of a call;
    `CHECK_TYPES` compares them.
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
    """Return a key for a value's Numba type: classes of nested tuples, kind and layout of arrays, type of the rest."""
    if isinstance(value, tuple):
        return type(value), *map(types_of, value)
    if isinstance(value, np.ndarray):
        return value.dtype.char, value.ndim, value.flags.num  # reading each flag by name would take twice as long
    return type(value)


def specialization_for(kernel: Any, arguments: tuple[Any, ...]) -> tuple[tuple[Any, ...], Any]:
    """Return these arguments' types and a kernel's specialization for them, compiling it first if necessary."""
    types = _types(kernel, arguments)
    if types not in kernel.overloads:
        kernel.compile(types)
    return types, kernel.overloads[types]


def _types(kernel: Any, arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(kernel.typeof_pyval(argument) for argument in arguments)
