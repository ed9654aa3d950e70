"""The decorators of kernels and the options they are compiled with; cache.py keeps what is compiled.

    `kernel`         called from Python; releases the GIL
    `brief_kernel`   called from Python; takes microseconds and keeps the GIL
    `internal`       a function of kernels, compiled by itself and linked into its callers
    `inline_llvm`    the same, inlined by LLVM, so that values stay in registers
    `inline_numba`   the same, inlined by Numba before types are inferred: for functions with one caller

Functions that choose their code by a type are in dispatch.py.

Options:

* `nogil`, so that threads really run kernels side by side; not for brief kernels (`brief_kernel`).
* No `nnan`/`ninf`: comparisons and selects see a NaN. With the flags of `FAST_MATH` sums are vectorised and `x + 0.0`
  folds away. `x * 0.0` does not, so the code for an absent effect must not multiply by zero. `reassoc` with `nsz` may
  still cancel a NaN, as in (x + y) − y; so what is checked for being finite is the state itself.
* Numba does not notice edits in *imported* kernels; the folder of compiled code is named so that it does (sources.py).
"""

from __future__ import annotations

import functools
import gc
from typing import Any

import numba
from numba.core import event

from .cache import keep_on_disk
from .function_types import FunctionType
from .link_only import compiler_options

#: What the compiler may do with floating-point numbers. It may not assume that none is NaN or infinite.
FAST_MATH = ("nsz", "arcp", "contract", "reassoc")
#: Kernels allocate nothing, so reference counting is off. Nothing calls them by C's convention, not even a kernel that
#: calls another by its address, so they need no C entry. Both leave less code to compile and to run.
_OPTIONS: Any = {"fastmath": set(FAST_MATH), "error_model": "numpy", "_nrt": False,
                 "no_cfunc_wrapper": True}
#: A function that only kernels call needs no entry for Python either, nor machine code of its own.
INTERNAL_OPTIONS = _OPTIONS | compiler_options()


class _CollectorPause(event.Listener):
    """Pauses garbage collection while Numba compiles: it makes millions of objects that live until it is done.

    Compilations are nested; one thread compiles at a time.
    """

    def __init__(self) -> None:
        self._depth = 0
        self._was_on = False

    def on_start(self, event: Any) -> None:
        """Pause at the outermost compilation."""
        if self._depth == 0:
            self._was_on = gc.isenabled()
            gc.disable()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """Resume after the outermost one."""
        self._depth -= 1
        if self._depth == 0 and self._was_on:
            gc.enable()


event.register("numba:compile", _CollectorPause())


class Internal:
    """A compiled function that only kernels call; called from Python it runs uncompiled.

    Numba finds the compiled code by the attribute `_numba_type_`, as it does for its own dispatchers. A dispatcher
    without an entry for Python must not be called from there, so this object takes the call instead.
    """

    def __init__(self, dispatcher: Any) -> None:
        functools.update_wrapper(self, dispatcher.py_func)
        self.py_func = dispatcher.py_func
        self.dispatcher = dispatcher
        self._numba_type_ = FunctionType(dispatcher)

    def __call__(self, *args: Any) -> Any:
        """The function itself."""
        return self.py_func(*args)


def kernel(function):
    """Decorator for compiled, cached kernels on floats and arrays that Python calls."""
    compiled = numba.njit(nogil=True, **_OPTIONS)(function)
    keep_on_disk(compiled)
    return compiled


def brief_kernel(function):
    """`kernel` for one that takes some microseconds: it keeps the GIL.

    To release the GIL and to wait for it again takes longer than such a kernel where another thread wants it too.
    """
    compiled = numba.njit(nogil=False, **_OPTIONS)(function)
    keep_on_disk(compiled)
    return compiled


def internal(function):
    """Decorator for parts of kernels, which are compiled separately and linked into the kernels that call them."""
    return Internal(numba.njit(nogil=True, **INTERNAL_OPTIONS)(function))


def inline_llvm(function):
    """Decorator for a function that LLVM inlines into its callers, so that values stay in registers."""
    return Internal(numba.njit(nogil=True, forceinline=True, **INTERNAL_OPTIONS)(function))


def inline_numba(function):
    """Decorator for a function with one caller, or one in each kind of step; its code is copied there before compiling.

    A function compiled by itself is linked and optimised again in every caller, up to the kernel that Python calls
    (docs/compiling.md).
    """
    return numba.njit(nogil=True, inline="always", **_OPTIONS)(function)
